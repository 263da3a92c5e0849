//! Random bytes over whole files of a session's shared memory, as another program of the same user may write them.
//!
//! What our own records hold is checked when it is read. What iceoryx2 keeps for itself (free memory, places of samples, lists
//! of ports) it trusts: a process may die of that. Then it is started again, or the session ends with a reason; what was
//! recorded stays valid, and nothing is left behind.

use std::{
    fs::{self, File},
    os::unix::fs::FileExt as _,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use cohabit_record::Log;
use cohabit_tests::{Page, Play};
use rustix::process::Signal;

use super::{round::Dice, seed};
use crate::COHABIT;

/// How often all files of a kind are spoilt, and how far apart.
const ROUNDS: u64 = 10;
const EVERY: Duration = Duration::from_millis(50);

/// How much of a file is spoilt.
const MOST_BYTES: u64 = 256 << 10;

/// The files of a session whose names contain a part.
fn files(session: &str, part: &str) -> Vec<PathBuf> {
    let all = fs::read_dir("/dev/shm").unwrap().flatten();
    let session = format!("_{session}_");
    let is_one = |name: &str| name.contains(&session) && name.contains(part);
    all.filter(|file| is_one(&file.file_name().to_string_lossy())).map(|file| file.path()).collect()
}

/// Overwrites a file, which stays as long as it is; of a long one, most of which has no memory yet, the beginning.
fn spoil(path: &Path, dice: &mut Dice) {
    // Its process may be gone by now.
    let Ok(file) = File::options().write(true).open(path) else { return };
    let bytes: Vec<u8> = (0..file.metadata().unwrap().len().min(MOST_BYTES)).map(|_| dice.byte()).collect();
    let _ = file.write_all_at(&bytes, 0);
}

/// Spoils all files of that kind in a running session; whatever comes of it, it ends, leaves nothing, and its log is valid.
fn check(kind: &str) {
    let mut dice = Dice::new(seed(), kind.len());
    let mut play = Play::start(COHABIT, &["cold_soda", "--seed", "5"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    let spoilt = files(&play.session, kind);
    assert!(!spoilt.is_empty(), "there is no {kind}");
    for _ in 0..ROUNDS {
        spoilt.iter().for_each(|path| spoil(path, &mut dice));
        thread::park_timeout(EVERY);
    }
    drop(page);
    let ending = Instant::now();
    // It may have ended already.
    let _ = play.signal_supervisor(Signal::INT);
    let status = play.wait_for_end().unwrap();
    eprintln!("after garbage in {kind} it ended with {status} within {:?}", ending.elapsed());
    let said = play.said();
    assert!(status.code().is_some(), "{kind}: {status}: {said}");
    let left = play.left_behind();
    assert!(left.is_empty(), "{kind}: left behind: {left:?}");
    let log = Log::open(&play.log).unwrap();
    assert!(!log.ticks.is_empty(), "{kind}: {said}");
}

#[test]
fn garbage_in_samples_leaves_a_valid_log() {
    check(".data");
}

#[test]
fn garbage_in_connections_leaves_a_valid_log() {
    check(".connection");
}

#[test]
fn garbage_in_lists_of_ports_leaves_a_valid_log() {
    check(".dynamic");
}

#[test]
fn garbage_in_wake_ups_changes_nothing() {
    let mut dice = Dice::new(seed(), 0);
    let play = Play::start(COHABIT, &["cold_soda", "--seed", "5"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for _ in 0..ROUNDS {
        files(&play.session, "_wake.").iter().for_each(|path| spoil(path, &mut dice));
        thread::park_timeout(EVERY);
    }
    page.do_and_wait("turn left").unwrap();
    drop(page);
    play.end().unwrap();
}

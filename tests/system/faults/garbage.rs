//! Random bytes over whole files of a session's shared memory, as another program of the same user may write them.
//!
//! What our own records hold is checked when it is read. What iceoryx2 keeps for itself (places of samples, lists of ports)
//! it trusts: a process may die of that. Then it is started again, or the session ends; what was recorded stays valid.

use std::{
    fs::{self, File},
    os::unix::fs::FileExt as _,
    path::PathBuf,
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{Session, Shm, Topic, Transport as _, wall_nanos};
use cohabit_tests::{Page, Play};

use super::{
    round::{Dice, check_log},
    seed,
    witness::Witness,
};
use crate::COHABIT;

/// What the names of such files end with: samples, queues between two ports, lists of ports.
const KINDS: [&str; 3] = [".data", ".connection", ".dynamic"];
/// How much of the mission is played before.
const PLAYED: u64 = 60;

/// The files of a session whose names end so.
fn files(session: &str, ending: &str) -> Vec<PathBuf> {
    let all = fs::read_dir("/dev/shm").unwrap().flatten();
    let part = format!("_{session}_");
    let is_one = |name: &str| name.contains(&part) && name.contains(ending);
    all.filter(|file| is_one(&file.file_name().to_string_lossy())).map(|file| file.path()).collect()
}

/// Overwrites a file as it is.
fn spoil(path: &PathBuf, dice: &mut Dice) {
    let file = File::options().write(true).open(path).unwrap();
    let bytes: Vec<u8> = (0..file.metadata().unwrap().len()).map(|_| dice.byte()).collect();
    file.write_all_at(&bytes, 0).unwrap();
}

/// Spoils files of that kind in a running session; whatever comes of it, it ends, leaves nothing, and its log is valid.
fn check(kind: &str, rounds: u64) {
    let mut dice = Dice::new(seed(), kind.len());
    let mut play = Play::start(COHABIT, &["cold_soda", "--seed", "5"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    let witness = Witness::new(&play.session).unwrap();
    witness.wait_for(witness.newest() + PLAYED).unwrap();
    drop(witness.end());
    let began = Instant::now();
    for _ in 0..rounds {
        for path in files(&play.session, kind) {
            spoil(&path, &mut dice);
        }
        thread::park_timeout(Duration::from_millis(50));
    }
    eprintln!("{kind}: spoilt for {:?}", began.elapsed());
    drop(page);
    // It may have ended already.
    let _ = play.signal_supervisor(rustix::process::Signal::INT);
    let status = play.wait_for_end().unwrap();
    eprintln!("{kind}: ended with {status}: {}", play.said());
    let left = play.left_behind();
    assert!(left.is_empty(), "{kind}: left behind: {left:?}");
    cohabit_record::Log::open(&play.log).unwrap();
    let _ = check_log;
    let _ = (wall_nanos, Topic::State);
    let _: fn(&Shm) = |bus| drop(bus.publisher(Topic::State));
    let _ = Session::new;
}

#[test]
fn garbage_in_shared_memory_leaves_a_valid_log() {
    for kind in KINDS {
        check(kind, 20);
    }
}

//! A session under load for a while: four agents, a recorder, two pages that watch, one of which speaks.

use std::{
    collections::BTreeMap,
    fs,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, ensure};
use serde_json::json;

use crate::{Lateness, Page, Play, run};

/// The bodies beside the mission's robot, and who commands them all.
const ARGUMENTS: [&str; 14] = [
    "--body",
    "robot@Lab1",
    "--body",
    "person@MainOffice",
    "--body",
    "robot@BreakRoom",
    "--agent",
    "dialog",
    "--agent",
    "helper@1",
    "--agent",
    "random@2",
    "--agent",
    "random@3",
];
/// What is said, over and over, each as soon as the one before is done.
const SAYINGS: [&str; 6] = [
    "go to the break room",
    "turn left 90 degrees",
    "go to the robotics lab",
    "what is left?",
    "look around",
    "go to the main office",
];
const ROLES: [&str; 4] = ["sim", "agent", "dialog", "record"];
/// How often memory is looked at.
const LOOK_EVERY: Duration = Duration::from_secs(2);

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Soaked {
    /// How late ticks began.
    pub lateness: Lateness,
    /// Bytes that each role's processes hold, look by look.
    pub resident: BTreeMap<&'static str, Vec<Resident>>,
    /// Frames that came to each page.
    pub frames: [u64; 2],
    /// Turns that came to their end.
    pub turns: u64,
    /// What `replay` said of the log.
    pub replayed: String,
}

/// Bytes that processes hold.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resident {
    /// Of their own. What leaks is here.
    pub own: u64,
    /// Mapped from files, such as code.
    pub files: u64,
    /// Shared memory: grows until all of the topics' rings was once passed through.
    pub shared: u64,
}

impl Resident {
    /// What a process holds; nothing if it is gone.
    #[must_use]
    pub fn of(pid: i32) -> Self {
        let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
        let kib = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name));
            line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok()).unwrap_or(0)
        };
        Self { own: kib("RssAnon:") << 10, files: kib("RssFile:") << 10, shared: kib("RssShmem:") << 10 }
    }
}

/// Plays for so long with `binary`; then ends the session, and replays its log.
///
/// # Errors
/// When the session does not start, go on, or end as it should, or its log does not replay.
pub fn soak(binary: &str, lasting: Duration) -> anyhow::Result<Soaked> {
    let play = Play::start(binary, &ARGUMENTS)?;
    let over = AtomicBool::new(false);
    let mut soaked = Soaked::default();
    thread::scope(|scope| -> anyhow::Result<()> {
        let (over, authority) = (&over, play.authority());
        let session = play.session.as_str();
        let ticks = scope.spawn(move || Lateness::watch(session, over));
        let speaks = scope.spawn(move || speak(authority, over));
        let watches = scope.spawn(move || watch(authority, over));
        let until = Instant::now() + lasting;
        while Instant::now() < until {
            thread::sleep(LOOK_EVERY.min(lasting));
            for role in ROLES {
                let looks = play.processes(role).into_iter().map(Resident::of);
                let all = looks.fold(Resident::default(), |all, one| Resident {
                    own: all.own + one.own,
                    files: all.files + one.files,
                    shared: all.shared + one.shared,
                });
                soaked.resident.entry(role).or_default().push(all);
            }
        }
        over.store(true, Ordering::Relaxed);
        let fell = "a thread of the test fell over";
        soaked.lateness = ticks.join().ok().context(fell)??;
        (soaked.frames[0], soaked.turns) = speaks.join().ok().context(fell)??;
        soaked.frames[1] = watches.join().ok().context(fell)??;
        Ok(())
    })?;
    let ended = play.end()?;
    let replayed = run(binary, &["replay", ended.log.to_str().context("a path")?])?;
    soaked.replayed = String::from_utf8_lossy(&replayed.stdout).into_owned();
    ensure!(replayed.status.success(), "the log does not replay: {}", soaked.replayed);
    Ok(soaked)
}

/// A page at which somebody has the robot do one thing after the other; gives its frames, and the turns that ended.
fn speak(authority: &str, over: &AtomicBool) -> anyhow::Result<(u64, u64)> {
    let mut page = Page::open(authority)?;
    let mut turns = 0;
    for saying in SAYINGS.iter().cycle() {
        page.say(saying)?;
        let ended = |message: &serde_json::Value| message["type"] == "turn" && message["ended"] == true;
        page.wait(&format!("the end of `{saying}`"), |_, message| over.load(Ordering::Relaxed) || ended(message))?;
        if over.load(Ordering::Relaxed) {
            break;
        }
        turns += 1;
    }
    Ok((page.frames, turns))
}

/// A page that watches the second body.
fn watch(authority: &str, over: &AtomicBool) -> anyhow::Result<u64> {
    let mut page = Page::open(authority)?;
    page.send(&json!({ "type": "view", "camera": "spectator/1" }))?;
    while !over.load(Ordering::Relaxed) {
        page.next_message()?;
    }
    Ok(page.frames)
}

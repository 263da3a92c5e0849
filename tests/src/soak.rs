//! A session under load for a while: four agents, a recorder, two pages that watch, one of which speaks.

use std::{
    collections::BTreeMap,
    fs,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, ensure};
use cohabit_bus::{Inbox, Session, Shm, Topic, go_first, message::TickView, monotonic_nanos};
use serde_json::json;

use crate::{Page, Play, run};

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
/// A tick that begins later than the next one should is missed, ns.
const TICK_NANOS: u64 = 16_666_667;
/// How often memory is looked at.
const LOOK_EVERY: Duration = Duration::from_secs(2);

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Soaked {
    /// How late each tick began, ns, in rising order.
    pub late_nanos: Vec<u64>,
    /// How late a thread beside it woke that does nothing but wake as often as the world ticks, ns, in rising order:
    /// what the machine itself is good for.
    pub control_nanos: Vec<u64>,
    /// Ticks that began a whole tick too late.
    pub missed: usize,
    /// The share of the processors' time that the machine's host gave to others meanwhile.
    pub stolen: f64,
    /// Ticks that were sent and not seen.
    pub lost: u64,
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
    /// Mapped from files or shared memory: grows until all of the topics' rings was once passed through.
    pub shared: u64,
}

impl Soaked {
    /// How late the given share of all ticks began at most, ms.
    #[must_use]
    pub fn late_ms(&self, share: f64) -> f64 {
        at(&self.late_nanos, share)
    }

    /// How late the given share of all wake-ups of the thread beside it was at most, ms.
    #[must_use]
    pub fn control_ms(&self, share: f64) -> f64 {
        at(&self.control_nanos, share)
    }

    /// How often that thread woke a whole tick too late.
    #[must_use]
    pub fn control_missed(&self) -> usize {
        missed(&self.control_nanos)
    }
}

/// How many of these are a whole tick.
fn missed(late_nanos: &[u64]) -> usize {
    late_nanos.iter().filter(|late| **late >= TICK_NANOS).count()
}

/// What the processors' time went to since the machine began.
#[derive(Clone, Copy, Debug, Default)]
struct Processors {
    all: u64,
    stolen: u64,
}

impl Processors {
    /// Zeros where that is not told: see proc_stat(5).
    fn now() -> Self {
        let text = fs::read_to_string("/proc/stat").unwrap_or_default();
        let times = text.lines().next().unwrap_or_default().split_whitespace().skip(1);
        let times: Vec<u64> = times.map_while(|time| time.parse().ok()).take(8).collect();
        Self { all: times.iter().sum(), stolen: times.get(7).copied().unwrap_or(0) }
    }

    fn stolen_until(self, later: Self) -> f64 {
        (later.stolen - self.stolen) as f64 / (later.all - self.all).max(1) as f64
    }
}

/// What the given share of `nanos`, which rise, is at most, ms.
fn at(nanos: &[u64], share: f64) -> f64 {
    let last = nanos.len().saturating_sub(1);
    nanos.get((last as f64 * share).round() as usize).map_or(f64::NAN, |nanos| *nanos as f64 * 1e-6)
}

/// Plays for so long with `binary`; then ends the session, and replays its log.
///
/// # Errors
/// When the session does not start, go on, or end as it should, or its log does not replay.
pub fn soak(binary: &str, lasting: Duration) -> anyhow::Result<Soaked> {
    let play = Play::start(binary, &ARGUMENTS)?;
    let (over, before) = (AtomicBool::new(false), Processors::now());
    let mut soaked = Soaked::default();
    thread::scope(|scope| -> anyhow::Result<()> {
        let (over, authority) = (&over, play.authority());
        let session = play.session.as_str();
        let ticks = scope.spawn(move || watch_ticks(session, over));
        let speaks = scope.spawn(move || speak(authority, over));
        let watches = scope.spawn(move || watch(authority, over));
        let control = scope.spawn(move || wake_and_sleep(over));
        let until = Instant::now() + lasting;
        while Instant::now() < until {
            thread::sleep(LOOK_EVERY.min(lasting));
            for role in ROLES {
                let looks = play.processes(role).into_iter().map(resident);
                let all = looks.fold(Resident::default(), |all, one| Resident {
                    own: all.own + one.own,
                    shared: all.shared + one.shared,
                });
                soaked.resident.entry(role).or_default().push(all);
            }
        }
        over.store(true, Ordering::Relaxed);
        let fell = "a thread of the test fell over";
        (soaked.late_nanos, soaked.lost) = ticks.join().ok().context(fell)??;
        soaked.control_nanos = control.join().ok().context(fell)?;
        (soaked.frames[0], soaked.turns) = speaks.join().ok().context(fell)??;
        soaked.frames[1] = watches.join().ok().context(fell)??;
        Ok(())
    })?;
    soaked.late_nanos.sort_unstable();
    soaked.control_nanos.sort_unstable();
    soaked.missed = missed(&soaked.late_nanos);
    soaked.stolen = before.stolen_until(Processors::now());
    let ended = play.end()?;
    let replayed = run(binary, &["replay", ended.log.to_str().context("a path")?])?;
    soaked.replayed = String::from_utf8_lossy(&replayed.stdout).into_owned();
    ensure!(replayed.status.success(), "the log does not replay: {}", soaked.replayed);
    Ok(soaked)
}

/// How late each tick began, and how many were not seen.
fn watch_ticks(session: &str, over: &AtomicBool) -> anyhow::Result<(Vec<u64>, u64)> {
    let bus = Shm::join(&Session::new(session)?)?;
    let mut ticks = Inbox::new(&bus, Topic::Ticks)?;
    let mut late = Vec::new();
    while !over.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(100));
        while let Some((_, nanos)) = ticks.next(|sample| Ok(TickView::new(sample.payload())?.header.late_nanos))? {
            late.push(nanos);
        }
    }
    Ok((late, ticks.lost()))
}

/// Wakes as often as the world ticks; gives how late, ns.
fn wake_and_sleep(over: &AtomicBool) -> Vec<u64> {
    go_first();
    let mut late = Vec::new();
    let mut due_nanos = monotonic_nanos();
    while !over.load(Ordering::Relaxed) {
        due_nanos += TICK_NANOS;
        thread::sleep(Duration::from_nanos(due_nanos.saturating_sub(monotonic_nanos())));
        late.push(monotonic_nanos().saturating_sub(due_nanos));
    }
    late
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

/// Memory that a process holds; none if it is gone.
fn resident(pid: i32) -> Resident {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let kib = |name: &str| {
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok()).unwrap_or(0)
    };
    Resident { own: kib("RssAnon:") << 10, shared: (kib("RssFile:") + kib("RssShmem:")) << 10 }
}

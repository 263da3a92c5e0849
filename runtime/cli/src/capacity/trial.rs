//! Plays more and more sessions at a time, each with one page, and measures how they go.

use std::{
    ffi::OsString,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use cohabit_bus::monotonic_nanos;
use cohabit_host::{Capacity, Door, Guest, Look, Step};
use cohabit_world::DT_NANOS;

use super::{
    child::ChildSession,
    processes::{Used, cores, free_bytes, used_by},
};
use crate::{doctor::ensure_room, scratch::Scratch, terminal::shown};

/// How often sessions are looked at.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// A session has to have a page, and its page a picture, by then.
const LONGEST_START: Duration = Duration::from_secs(60);
/// So long after its first picture the newest one has built and shaded what it shows.
const SETTLES_IN: Duration = Duration::from_secs(3);
/// How long sessions may take to end.
const GRACE: Duration = Duration::from_secs(15);
/// So much memory stays free for others, bytes: where it is short, all programs of the machine suffer.
const KEPT_FREE_BYTES: u64 = 512 << 20;

/// What is played for a measure.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The most sessions that are played at a time; with 1, the rest is estimated.
    pub most: usize,
    /// How long each number of them is watched, s.
    pub seconds: f64,
    /// What is played in all of them.
    pub mission: String,
    /// Arguments of `play` besides.
    pub arguments: Vec<OsString>,
}

impl Default for Trial {
    fn default() -> Self {
        Self { most: 1, seconds: super::WHOLE_S, mission: "make_cereal".to_owned(), arguments: Vec::new() }
    }
}

/// Measures until one session too many is played, `stop`, or as many as are asked for; `told` hears of each number of them. The sessions
/// leave nothing behind.
pub fn measure(trial: &Trial, stop: &AtomicBool, told: &mut dyn FnMut(&Step)) -> anyhow::Result<Capacity> {
    ensure_room()?;
    let scratch = Scratch::new("capacity").context("a folder for what sessions write")?;
    let mut capacity =
        Capacity { cores: cores(), free_bytes: free_bytes(), is_estimate: trial.most == 1, steps: Vec::new() };
    let mut subjects = Subjects(Vec::new());
    while subjects.0.len() < trial.most && has_room(&capacity) {
        match Subject::start(trial, subjects.0.len() + 1, scratch.path(), stop) {
            Ok(subject) => subjects.0.push(subject),
            Err(error) if capacity.steps.is_empty() || stop.load(Ordering::Relaxed) => return Err(error),
            // It is one too many.
            Err(error) => {
                eprintln!("cohabit: {} sessions: {}", subjects.0.len() + 1, shown(error));
                break;
            }
        }
        subjects.watch(SETTLES_IN, stop)?;
        let step = subjects.measure(Duration::from_secs_f64(trial.seconds), stop)?;
        if stop.load(Ordering::Relaxed) {
            bail!("it was stopped");
        }
        told(&step);
        capacity.steps.push(step);
        if !capacity.is_well(&step) {
            break;
        }
    }
    Ok(capacity)
}

/// Whether there is memory for one session more, by what those took that were measured.
fn has_room(capacity: &Capacity) -> bool {
    let needed = capacity.steps.last().map_or(0, Step::memory_each);
    needed == 0 || ensure_room().is_ok() && free_bytes() > needed + KEPT_FREE_BYTES
}

/// A session that is measured, with its page.
struct Subject {
    session: ChildSession,
    guest: Guest,
}

/// What was known of a session before it was watched.
struct Before {
    used: Used,
    pictures: u64,
}

/// How a session went while it was watched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Course {
    ticks: u64,
    missed: u64,
    processor_s: f64,
    memory_bytes: u64,
    pictures: u64,
}

impl Subject {
    /// Starts the session of that number, and waits until its page has a picture.
    fn start(trial: &Trial, number: usize, folder: &Path, stop: &AtomicBool) -> anyhow::Result<Self> {
        let name = format!("m{}-{number}", std::process::id());
        let log = folder.join(format!("{number}.mcap")).into_os_string();
        let own = [OsString::from("--port"), OsString::from("0"), OsString::from("--log"), log];
        let arguments: Vec<OsString> =
            own.into_iter().chain(trial.arguments.iter().cloned()).chain([OsString::from(&trial.mission)]).collect();
        let mut session = ChildSession::start(&name, &arguments, None).map_err(anyhow::Error::msg)?;
        let door = wait_for_door(&mut session, stop)?;
        let guest = Guest::open(&door).map_err(anyhow::Error::msg)?;
        let deadline = Instant::now() + LONGEST_START;
        while guest.pictures() == 0 {
            check_patience(deadline, stop, "no picture came to the page of a session")?;
        }
        Ok(Self { session, guest })
    }

    fn before(&self) -> Before {
        Before { used: used_by(self.session.process(), false), pictures: self.guest.pictures() }
    }

    /// How it went since a moment, in which so many ticks were due.
    fn course(&self, before: &Before, since_nanos: u64, due: u64) -> Course {
        let (ticked, used) = (self.session.ticked_since(since_nanos), used_by(self.session.process(), true));
        // One at each edge of the time may be on its other side.
        let absent = due.saturating_sub(ticked.ticks + 1);
        Course {
            ticks: ticked.ticks + absent,
            missed: ticked.late + absent,
            processor_s: used.processor_s - before.used.processor_s,
            memory_bytes: used.memory_bytes,
            pictures: self.guest.pictures() - before.pictures,
        }
    }
}

/// Waits until a session has a page.
fn wait_for_door(session: &mut ChildSession, stop: &AtomicBool) -> anyhow::Result<Door> {
    let deadline = Instant::now() + LONGEST_START;
    loop {
        match session.look() {
            Look::Open(door) => return Ok(door),
            Look::Gone(reason) => bail!("a session ended: {reason}"),
            Look::Starting => check_patience(deadline, stop, "a session has no page")?,
        }
    }
}

/// Waits a moment; fails if it was waited long enough.
fn check_patience(deadline: Instant, stop: &AtomicBool, problem: &str) -> anyhow::Result<()> {
    if stop.load(Ordering::Relaxed) {
        bail!("it was stopped");
    }
    if Instant::now() > deadline {
        bail!("{problem} after {} s", LONGEST_START.as_secs());
    }
    thread::sleep(LOOK_EVERY);
    Ok(())
}

/// All sessions that are measured. Dropping them ends them in order.
struct Subjects(Vec<Subject>);

impl Subjects {
    /// Has them go on for so long.
    fn watch(&mut self, time: Duration, stop: &AtomicBool) -> anyhow::Result<()> {
        let until = Instant::now() + time;
        while Instant::now() < until && !stop.load(Ordering::Relaxed) {
            thread::sleep(LOOK_EVERY);
            for subject in &mut self.0 {
                subject.session.note_ticks();
                if let Look::Gone(reason) = subject.session.look() {
                    bail!("a session ended: {reason}");
                }
            }
        }
        Ok(())
    }

    /// Measures how they go for so long.
    fn measure(&mut self, time: Duration, stop: &AtomicBool) -> anyhow::Result<Step> {
        let (before, began_nanos): (Vec<Before>, u64) =
            (self.0.iter().map(Subject::before).collect(), monotonic_nanos());
        self.watch(time, stop)?;
        let nanos = monotonic_nanos().saturating_sub(began_nanos);
        let due = nanos / DT_NANOS;
        let courses = self.0.iter().zip(&before).map(|(subject, before)| subject.course(before, began_nanos, due));
        Ok(step(&courses.collect::<Vec<_>>(), nanos as f64 * 1e-9))
    }
}

impl Drop for Subjects {
    fn drop(&mut self) {
        let mut sessions: Vec<ChildSession> = self.0.drain(..).map(|subject| subject.session).collect();
        sessions.iter_mut().for_each(ChildSession::end);
        let deadline = Instant::now() + GRACE;
        while !sessions.is_empty() && Instant::now() < deadline {
            sessions.retain_mut(|session| !matches!(session.look(), Look::Gone(_)));
            thread::sleep(LOOK_EVERY);
        }
    }
}

/// What sessions took together in so many seconds.
fn step(courses: &[Course], seconds: f64) -> Step {
    let each = |course: &Course| course.missed as f64 / course.ticks.max(1) as f64;
    let seconds = seconds.max(f64::MIN_POSITIVE);
    Step {
        sessions: courses.len(),
        seconds,
        ticks: courses.iter().map(|course| course.ticks).sum(),
        missed: courses.iter().map(|course| course.missed).sum(),
        worst_missed: courses.iter().map(each).fold(0.0, f64::max),
        cores: courses.iter().map(|course| course.processor_s).sum::<f64>() / seconds,
        memory_bytes: courses.iter().map(|course| course.memory_bytes).sum(),
        pictures_per_s: courses.iter().map(|course| course.pictures).min().unwrap_or(0) as f64 / seconds,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sessions_are_summed_up_and_the_worst_is_kept() {
        let one = Course { ticks: 600, missed: 3, processor_s: 4.0, memory_bytes: 100, pictures: 300 };
        let other = Course { missed: 9, processor_s: 6.0, pictures: 200, ..one };
        let sum = step(&[one, other], 10.0);
        assert_eq!((sum.sessions, sum.ticks, sum.missed, sum.memory_bytes), (2, 1200, 12, 200));
        assert_eq!((sum.worst_missed, sum.cores, sum.pictures_per_s), (0.015, 1.0, 20.0));
        assert_eq!(step(&[], 10.0).sessions, 0);
    }
}

//! One session, in which one process is killed, and what is left of it.

use std::{
    collections::BTreeMap,
    collections::BTreeSet,
    fmt, fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, ensure};
use cohabit_bus::wall_nanos;
use cohabit_record::Log;
use cohabit_tests::{Play, run};
use rustix::process::{Pid, Signal, kill_process};

use super::{person::Person, witness::Witness};
use crate::COHABIT;

/// The longest that work is gone on with before somebody is killed.
const LONGEST_WORK_MS: u64 = 5000;
/// The longest that a session is given to start before somebody is killed.
const LONGEST_START_MS: u64 = 900;
/// How old the newest readable tick should be at most at the moment of a kill: more is counted.
const READABLE_WITHIN: Duration = Duration::from_millis(100);
/// More fails, however busy the machine is.
const READABLE_AT_LAST: Duration = Duration::from_secs(1);
/// The longest that anything is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// Random numbers (SplitMix64).
pub struct Dice(u64);

impl Dice {
    /// Those of one round.
    pub fn new(seed: u64, round: usize) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (round as u64) << 32)
    }

    /// A number below `bound`.
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % bound
    }

    /// Any byte; zeros more often.
    pub fn byte(&mut self) -> u8 {
        u8::try_from(self.below(512)).unwrap_or(0)
    }
}

/// The processes of a session; with the first two it ends.
const VICTIMS: [&str; 5] = ["sim", "play", "agent", "dialog", "record"];

/// When somebody is killed.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// So long after the session was started.
    Starting(Duration),
    /// So long after the robot was asked.
    Working(Duration),
}

/// What is to be done in a round.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    victim: &'static str,
    moment: Moment,
}

/// What came of a round that went well.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// How long before the kill the oldest tick was published that could not be read then, where the session ended or the
    /// recorder died.
    log_behind: Duration,
    /// How long the session took to end, where it did.
    ended_after: Duration,
    /// How long it took from the kill to the end of the work, where it went on.
    done_after: Duration,
}

impl Plan {
    /// One at random; rounds take turns with the victims.
    pub fn draw(number: usize, dice: &mut Dice) -> Self {
        let victim = VICTIMS[number % VICTIMS.len()];
        let moment = if dice.below(4) == 0 {
            Moment::Starting(Duration::from_millis(dice.below(LONGEST_START_MS)))
        } else {
            Moment::Working(Duration::from_millis(dice.below(LONGEST_WORK_MS)))
        };
        Self { victim, moment }
    }

    /// Plays it.
    pub fn play(&self) -> anyhow::Result<Measured> {
        let mut play = Play::spawn(COHABIT, &["cold_soda", "--seed", "5"])?;
        match self.moment {
            Moment::Starting(after) => {
                thread::sleep(after);
                let killed = self.kill(&play)?;
                match self.victim {
                    "sim" | "play" => self.check_ended(&mut play, None, killed),
                    _ => {
                        play.wait_until_ready()?;
                        let mut person = Person::at(play.authority())?;
                        person.ask_for_work()?;
                        let witness = Witness::new(&play.session)?;
                        self.check_carries_on(play, person, witness, killed)
                    }
                }
            }
            Moment::Working(after) => {
                play.wait_until_ready()?;
                // The page may be served before the recorder has begun.
                wait_until("the log has begun", || fs::metadata(&play.log).is_ok_and(|log| log.len() > 0))?;
                let witness = Witness::new(&play.session)?;
                let mut person = Person::at(play.authority())?;
                person.ask_for_work()?;
                thread::sleep(after);
                let killed = self.kill(&play)?;
                match self.victim {
                    "sim" | "play" => self.check_ended(&mut play, Some(witness), killed),
                    "record" => {
                        let copy = play.folder.join("at-the-kill.mcap");
                        fs::copy(&play.log, &copy)?;
                        let log_behind = behind(&copy, &witness, killed)?;
                        let measured = self.check_carries_on(play, person, witness, killed)?;
                        Ok(Measured { log_behind, ..measured })
                    }
                    _ => self.check_carries_on(play, person, witness, killed),
                }
            }
        }
    }

    /// Kills the victim as soon as it is there; when, in wall time.
    fn kill(&self, play: &Play) -> anyhow::Result<u64> {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            let pid = match self.victim {
                "play" => Some(i32::try_from(play.pid())?),
                role => play.processes(role).first().copied(),
            };
            if let Some(pid) = pid.and_then(Pid::from_raw) {
                kill_process(pid, Signal::KILL)?;
                return Ok(wall_nanos());
            }
            ensure!(Instant::now() < deadline, "there is no {} process", self.victim);
            thread::yield_now();
        }
    }

    /// The session has ended, is recorded, and nothing is left of it after the next one has started.
    fn check_ended(&self, play: &mut Play, witness: Option<Witness>, killed: u64) -> anyhow::Result<Measured> {
        let status = play.wait_for_end()?;
        ensure!(!status.success(), "it ended well without its {}", self.victim);
        if self.victim == "play" {
            wait_until("all processes are gone", || !play.left_behind().iter().any(|line| line.contains('\0')))?;
        }
        let ended_after = Duration::from_nanos(wall_nanos() - killed);
        let mut log_behind = Duration::ZERO;
        if let Some(witness) = &witness {
            log_behind = behind(&play.log, witness, killed)?;
            check_log(&play.log)?;
        }
        drop(witness);
        if self.victim == "play" {
            Play::start(COHABIT, &["cold_soda"])?.end()?;
        } else {
            play.wait_for_line("the sim process ended (signal 9)")?;
        }
        let left = play.left_behind();
        ensure!(left.is_empty(), "left behind: {left:?}");
        Ok(Measured { log_behind, ended_after, ..Measured::default() })
    }

    /// The session goes on: what was asked is done, the next thing is understood, and all is recorded.
    fn check_carries_on(
        &self,
        play: Play,
        mut person: Person,
        witness: Witness,
        killed: u64,
    ) -> anyhow::Result<Measured> {
        person.have_done()?;
        let done_after = Duration::from_nanos(wall_nanos() - killed);
        person.ask("what are you holding?", 1)?;
        drop(person);
        let seen = witness.end()?;
        let play = play.end()?;
        let log = check_log(&play.log)?;
        ensure!(log.ticks.last().is_some_and(|entry| entry.tick >= seen), "the log ends before tick {seen}");
        let said = log.dialog.iter().filter(|entry| entry.kind == "Utterance").map(|entry| entry.turn);
        let said: BTreeSet<u64> = said.collect();
        ensure!(said.len() == 2, "two things were said, of which the log has {}", said.len());
        Ok(Measured { done_after, ..Measured::default() })
    }
}

/// How long before the kill the oldest tick was published that cannot be read.
fn behind(path: &Path, witness: &Witness, killed: u64) -> anyhow::Result<Duration> {
    let log = Log::open(path)?;
    let last = log.ticks.last().context("no tick in the log")?;
    let published = witness.wall_of_first_after(last.tick);
    let behind = Duration::from_nanos(published.map_or(0, |wall| killed.saturating_sub(wall)));
    ensure!(behind < READABLE_AT_LAST, "the log ends with tick {}, {behind:?} before the kill", last.tick);
    Ok(behind)
}

/// Whether all is in a log, and comes out the same.
pub fn check_log(path: &Path) -> anyhow::Result<Log> {
    let log = Log::open(path)?;
    ensure!(log.cut.is_none(), "the log was cut: {:?}", log.cut);
    ensure!(log.missing() == 0, "{} messages are missing", log.missing());
    let replayed = run(COHABIT, &["replay", path.to_str().context("a path")?])?;
    ensure!(replayed.status.success(), "{replayed:?}");
    Ok(log)
}

fn wait_until(what: &str, mut holds: impl FnMut() -> bool) -> anyhow::Result<()> {
    let deadline = Instant::now() + WATCHDOG;
    while !holds() {
        ensure!(Instant::now() < deadline, "waited in vain until {what}");
        thread::park_timeout(Duration::from_millis(5));
    }
    Ok(())
}

/// What came of many rounds.
#[derive(Default)]
pub struct Counts {
    rounds: BTreeMap<&'static str, (usize, usize, Measured)>,
    /// Rounds in which the log was further behind than it should be.
    late: usize,
    /// What failed, and how.
    pub failures: Vec<String>,
}

impl Counts {
    /// Takes note of a round.
    pub fn note(&mut self, number: usize, plan: &Plan, came: anyhow::Result<Measured>) {
        let (well, all, worst) = self.rounds.entry(plan.victim).or_default();
        *all += 1;
        match came {
            Ok(measured) => {
                *well += 1;
                self.late += usize::from(measured.log_behind > READABLE_WITHIN);
                *worst = worst.most(measured);
                eprintln!("round {number}: {plan:?}: {measured:?}");
            }
            Err(error) => {
                let text = format!("round {number}: {plan:?}: {error:#}");
                eprintln!("FAILED {text}");
                self.failures.push(text);
            }
        }
    }

    /// With those of another.
    pub fn and(mut self, other: Self) -> Self {
        for (victim, (well, all, worst)) in other.rounds {
            let sum = self.rounds.entry(victim).or_default();
            *sum = (sum.0 + well, sum.1 + all, sum.2.most(worst));
        }
        self.late += other.late;
        self.failures.extend(other.failures);
        self
    }
}

impl Measured {
    fn most(self, other: Self) -> Self {
        Self {
            log_behind: self.log_behind.max(other.log_behind),
            ended_after: self.ended_after.max(other.ended_after),
            done_after: self.done_after.max(other.done_after),
        }
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "killed   well/all   at most: log behind, ended after, work done after")?;
        for (victim, (well, all, worst)) in &self.rounds {
            let ms = |duration: Duration| duration.as_millis();
            writeln!(
                f,
                "{victim:8} {well:4}/{all:<4} {:17} ms {:8} ms {:12} ms",
                ms(worst.log_behind),
                ms(worst.ended_after),
                ms(worst.done_after)
            )?;
        }
        writeln!(f, "log more than {} ms behind: {} times", READABLE_WITHIN.as_millis(), self.late)?;
        self.failures.iter().try_for_each(|failure| writeln!(f, "{failure}"))
    }
}

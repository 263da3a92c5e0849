//! `cohabit self-test`: plays a mission on this machine from end to end, and says what works and what is missing.

mod python;
mod trials;

use std::{
    net::{Ipv4Addr, SocketAddr},
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use cohabit_cdf::Catalog;

use crate::{
    doctor::{self, Finding, State},
    terminal::shown,
};
use trials::Passed;

/// What the trials take at most on a machine that is quick enough for sessions: a minute of the world, and its models.
const TRIALS_TAKE: Duration = Duration::from_secs(20);

/// What is done where a trial fails: the looks at the machine, which follow, say what it lacks.
const REMEDY: &str = "mend what is marked `broken` below; if nothing is, install the program again";

/// Plays a mission without a page, replays its log, renders a frame, sends it through shared memory, and says line by line
/// what works on this machine, what is missing, and how to get it; fails if a session needs what is missing
#[derive(clap::Args)]
pub struct SelfTest {
    /// The port of the page, which is looked at and not served; 0 is any that is free
    #[arg(long, default_value_t = 8765)]
    port: u16,
}

impl SelfTest {
    /// Tries all, and looks at the machine.
    pub fn run(&self) -> anyhow::Result<()> {
        let mut sheet = Sheet::default();
        let began = Instant::now();
        sheet.try_all(&Arc::new(Catalog::builtin()));
        sheet.note("speed", &judge_time(began.elapsed()));
        doctor::look(SocketAddr::from((Ipv4Addr::LOCALHOST, self.port)), &mut |name, found| sheet.note(name, &found))?;
        sheet.note("Python package", &python::package());
        println!("\n{}", verdict(sheet.count(State::Broken), sheet.count(State::Costs)));
        let broken = sheet.count(State::Broken);
        anyhow::ensure!(broken == 0, "{broken} of {} checks failed that sessions need", sheet.states.len());
        Ok(())
    }
}

/// What was found so far.
#[derive(Default)]
struct Sheet {
    states: Vec<State>,
}

impl Sheet {
    /// The trials, one after the other: some need what others leave.
    fn try_all(&mut self, catalog: &Arc<Catalog>) {
        let recorded = self.tried("mission", "no mission can be played", trials::play_mission(catalog));
        let replayed = recorded.context("no session was recorded").and_then(|log| trials::replay_log(&log, catalog));
        self.tried("replay", "recorded sessions cannot be replayed", replayed);
        let frame = self.tried("frame", "robots and people see nothing", trials::render_frame(catalog));
        let sent = frame.context("no frame was rendered").and_then(|frame| trials::send_frame(&frame));
        self.tried("frame sent", "the processes of a session cannot reach each other", sent);
    }

    /// Notes what a trial found; gives what it leaves to others.
    fn tried<T>(&mut self, name: &str, costs: &str, outcome: anyhow::Result<Passed<T>>) -> Option<T> {
        match outcome {
            Ok(Passed { found, left }) => {
                self.note(name, &Finding::good(found));
                Some(left)
            }
            Err(error) => {
                self.note(name, &Finding::broken(format!("{error:#}"), costs, REMEDY));
                None
            }
        }
    }

    fn note(&mut self, name: &str, finding: &Finding) {
        println!("{}", shown(finding.as_line(name)));
        self.states.push(finding.state);
    }

    fn count(&self, state: State) -> usize {
        self.states.iter().filter(|found| **found == state).count()
    }
}

fn judge_time(taken: Duration) -> Finding {
    let found = format!("{:.1} s for all of these", taken.as_secs_f64());
    if taken <= TRIALS_TAKE {
        return Finding::good(found);
    }
    let costs = format!("more than {} s: sessions may fall behind real time", TRIALS_TAKE.as_secs());
    Finding::costs(found, costs, "use a release build, end other programs, or play with `--understanding fast`")
}

fn verdict(broken: usize, costs: usize) -> String {
    match (broken, costs) {
        (0, 0) => "All works on this machine".to_owned(),
        (0, costs) => format!("Sessions run on this machine; lines marked `costs`: {costs}"),
        (broken, _) => format!("Sessions do not run on this machine; lines marked `broken`: {broken}"),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_fails_is_broken_and_leaves_nothing() {
        let mut sheet = Sheet::default();
        let left = sheet.tried("one", "", Ok(Passed { found: "it works".to_owned(), left: 7 }));
        assert_eq!(left, Some(7));
        let left: Option<u8> = sheet.tried("two", "nothing runs", Err(anyhow::anyhow!("it does not")));
        assert_eq!(left, None);
        assert_eq!(sheet.states, [State::Good, State::Broken]);
        assert_eq!((sheet.count(State::Broken), sheet.count(State::Costs)), (1, 0));
    }

    #[test]
    fn a_slow_machine_runs_sessions_at_a_cost() {
        for (times, state) in [(0, State::Good), (1, State::Good), (2, State::Costs)] {
            assert_eq!(judge_time(TRIALS_TAKE * times).state, state, "{times}");
        }
    }

    #[test]
    fn the_verdict_is_that_of_the_worst_line() {
        for (broken, costs, expected) in [
            (0, 0, "All works on this machine"),
            (0, 2, "Sessions run on this machine; lines marked `costs`: 2"),
            (1, 2, "Sessions do not run on this machine; lines marked `broken`: 1"),
        ] {
            assert_eq!(verdict(broken, costs), expected);
        }
    }
}

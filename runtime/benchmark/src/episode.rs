//! What came of one mission, and the commands that led there.

use cohabit_record::InputEntry;
use serde::{Deserialize, Serialize};

/// When a mission is given up.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Caps {
    /// It is over beyond so many commands.
    pub actions: u32,
    /// It is over at so many commands that failed.
    pub failed: u32,
}

/// A tick that took commands in.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TickInputs {
    /// Its number, from 1.
    pub tick: u64,
    /// The digest of the state after it, in hexadecimal.
    pub digest: String,
    /// The commands.
    pub inputs: Vec<InputEntry>,
}

/// All that an agent did in a mission.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Ticks until it stopped.
    pub ticks: u64,
    /// Its commands, in order.
    pub taken: Vec<TickInputs>,
}

/// Why an episode is over.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EpisodeEnd {
    /// All goals were met.
    AllGoalsMet,
    /// The agent did nothing more.
    Stopped,
    /// It took too many commands.
    TooManyActions,
    /// Too many of its commands failed.
    TooManyFailures,
    /// A hazard took the robot.
    RobotDestroyed,
    /// It took too long.
    OutOfTime,
}

/// What came of a mission: a line of a submission.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Episode {
    /// The mission.
    pub mission: String,
    /// Whether every goal was met within the caps.
    pub success: bool,
    /// Goals met.
    pub goals_met: usize,
    /// Goals in all.
    pub goals: usize,
    /// Commands that ended.
    pub actions: u32,
    /// Commands that failed.
    pub failed_actions: u32,
    /// Why it is over.
    pub end: EpisodeEnd,
    /// Its last tick.
    pub ticks: u64,
    /// The digest of the last state, in hexadecimal.
    pub digest: String,
    /// What the robot was told: all that is needed to play it again.
    pub taken: Vec<TickInputs>,
}

impl Episode {
    /// What was done in it.
    #[must_use]
    pub fn recording(&self) -> Recording {
        Recording { ticks: self.ticks, taken: self.taken.clone() }
    }
}

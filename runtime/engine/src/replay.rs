//! Re-simulates a recorded session and compares it tick by tick.

use std::sync::Arc;

use cohabit_cdf::{BodyId, Catalog};
use cohabit_record::{Log, entry::hex};
use cohabit_world::Input;

use crate::build::{BuildError, SessionPlan};

/// Simulated seconds a tick.
pub const TICK_S: f64 = cohabit_world::DT_NANOS as f64 * 1e-9;

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Ticks compared.
    pub ticks: u64,
    /// Inputs fed.
    pub inputs: u64,
    /// Goals met at the end, of how many.
    pub goals: (usize, usize),
    /// Where the two part, if they do.
    pub difference: Option<Difference>,
}

/// Where a replay parts from its log.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The log has no entry for this tick: it has a gap.
    Missing {
        /// The tick missing.
        tick: u64,
        /// The tick found in its place.
        found: u64,
    },
    /// The states differ after this tick.
    Digest {
        /// The first tick that differs.
        tick: u64,
        /// What the log has.
        recorded: String,
        /// What came of it now.
        replayed: String,
    },
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing { tick, found } => {
                write!(f, "the log has no tick {tick}: tick {found} follows the one before")
            }
            Self::Digest { tick, recorded, replayed } => {
                write!(f, "tick {tick} differs: recorded {recorded}, replayed {replayed}")
            }
        }
    }
}

/// Feeds the inputs of `log` to a new world, and compares digests up to the first that differs.
///
/// # Errors
/// [`BuildError`], when the log's mission cannot be built by this program.
pub fn replay(log: &Log, catalog: Arc<Catalog>) -> Result<Replay, BuildError> {
    let session = &log.session;
    let plan = SessionPlan::new(&session.mission_file, &session.mission_text, catalog, session.seed)?;
    let plan = plan.with_bodies(session.bodies.clone());
    let mut world = plan.build()?;
    let mut replay = Replay { ticks: 0, inputs: 0, goals: (0, 0), difference: None };
    for entry in &log.ticks {
        let inputs: Vec<Input> = entry
            .inputs
            .iter()
            .map(|input| Input { command: input.command, body: BodyId(input.body), action: input.action })
            .collect();
        if world.tick() + 1 != entry.tick {
            replay.difference = Some(Difference::Missing { tick: world.tick() + 1, found: entry.tick });
            break;
        }
        world.step(&inputs);
        replay.ticks += 1;
        replay.inputs += inputs.len() as u64;
        let replayed = hex(&world.digest());
        if replayed != entry.digest {
            replay.difference = Some(Difference::Digest { tick: entry.tick, recorded: entry.digest.clone(), replayed });
            break;
        }
    }
    let goals = world.goals();
    replay.goals = (goals.iter().filter(|goal| goal.met).count(), goals.len());
    Ok(replay)
}

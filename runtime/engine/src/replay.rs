//! Re-simulates a recorded session and compares it tick by tick.

mod difference;
mod movement;
mod replayer;

use std::{ops::ControlFlow, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_record::Log;

pub use difference::Difference;
pub use movement::movement;
pub use replayer::{ReplayError, Replayed, Replayer};

/// Simulated seconds a tick.
pub const TICK_S: f64 = cohabit_world::DT_NANOS as f64 * 1e-9;

/// What came of a replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// Ticks compared.
    pub ticks: u64,
    /// The first and the last of them, if there are any.
    pub span: Option<[u64; 2]>,
    /// Inputs fed.
    pub inputs: u64,
    /// Goals met at the end, of how many.
    pub goals: (usize, usize),
    /// Ticks that the log does not have: what follows them was replayed from the next snapshot.
    pub gaps: Vec<Difference>,
    /// Where the two part, if they do: the first tick that differs, or that is missing without a snapshot to go on from.
    pub difference: Option<Difference>,
}

/// Feeds the inputs of `log` to a new world, and compares digests up to the first that differs.
///
/// # Errors
/// [`ReplayError`], when the log's session cannot be played by this program.
pub fn replay(log: &Log, catalog: Arc<Catalog>) -> Result<Replay, ReplayError> {
    Ok(verify(&mut Replayer::new(log, catalog)?, &mut |_| ControlFlow::Continue(())))
}

/// The same from where `replayer` is; `each` sees it after every tick, and may end it.
pub fn verify(replayer: &mut Replayer<'_>, each: &mut dyn FnMut(&Replayer<'_>) -> ControlFlow<()>) -> Replay {
    let mut replay = Replay { ticks: 0, span: None, inputs: 0, goals: (0, 0), gaps: Vec::new(), difference: None };
    loop {
        if step_all(replayer, &mut replay, each).is_break() {
            break;
        }
        let Some(gap) = replayer.gap() else { break };
        if !replayer.skip_gap() {
            replay.difference = Some(gap);
            break;
        }
        replay.gaps.push(gap);
    }
    let goals = replayer.world().goals();
    replay.goals = (goals.iter().filter(|goal| goal.met).count(), goals.len());
    replay.difference = replay.difference.map(|difference| difference.explained_by(replayer));
    replay
}

/// Goes on as far as there are ticks one after the other.
fn step_all(
    replayer: &mut Replayer<'_>,
    replay: &mut Replay,
    each: &mut dyn FnMut(&Replayer<'_>) -> ControlFlow<()>,
) -> ControlFlow<()> {
    while let Some(replayed) = replayer.step() {
        replay.ticks += 1;
        replay.span = Some([replay.span.map_or(replayed.entry.tick, |[first, _]| first), replayed.entry.tick]);
        replay.inputs += replayed.inputs.len() as u64;
        replay.difference = replayed.difference;
        if replay.difference.is_some() {
            return ControlFlow::Break(());
        }
        each(replayer)?;
    }
    ControlFlow::Continue(())
}

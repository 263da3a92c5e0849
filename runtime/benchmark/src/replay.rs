//! Commands played again in a world of their own: where all figures come from.

use cohabit_generate::world_of;
use cohabit_record::{InputEntry, entry::hex};
use cohabit_world::{BodyId, Ending, Input, World};

use crate::{
    benchmark::Benchmark,
    episode::{Caps, Episode, EpisodeEnd, Recording, TickInputs},
    mission::Mission,
};

/// An episode is over after so long: two simulated hours.
const MOST_TICKS: u64 = 60 * 60 * 60 * 2;

/// Plays what an agent did in a mission again, up to where the mission is over; gives what came of it.
///
/// # Errors
/// Why the mission has no world here, in words.
pub fn play_again(benchmark: &Benchmark, mission: &Mission, recording: &Recording) -> Result<Episode, String> {
    let mut world = world_of(&mission.id, &mission.cdf.to_string(), &benchmark.catalog, benchmark.seed)?;
    let (mut actions, mut failed_actions, mut taken) = (0, 0, Vec::new());
    let mut left = recording.taken.iter().peekable();
    let end = loop {
        if let Some(end) = over(&world, benchmark.caps, [actions, failed_actions]) {
            break end;
        }
        if world.tick() >= recording.ticks {
            break EpisodeEnd::Stopped;
        }
        let tick = world.tick() + 1;
        let next = left.next_if(|next| next.tick == tick);
        let entries = next.map_or(&[][..], |next| next.inputs.as_slice());
        let report = world.step(&entries.iter().map(input).collect::<Vec<_>>());
        for outcome in &report.outcomes {
            actions += 1;
            failed_actions += u32::from(outcome.status.is_failure());
        }
        if !entries.is_empty() {
            taken.push(TickInputs { tick, digest: hex(&world.digest()), inputs: entries.to_vec() });
        }
    };
    let goals = world.goals();
    Ok(Episode {
        mission: mission.id.clone(),
        success: end == EpisodeEnd::AllGoalsMet,
        goals_met: goals.iter().filter(|goal| goal.met).count(),
        goals: goals.len(),
        actions,
        failed_actions,
        end,
        ticks: world.tick(),
        digest: hex(&world.digest()),
        taken,
    })
}

/// Why an episode is over, if it is, after so many actions and failures.
fn over(world: &World, caps: Caps, [actions, failed]: [u32; 2]) -> Option<EpisodeEnd> {
    if actions > caps.actions {
        return Some(EpisodeEnd::TooManyActions);
    }
    if failed >= caps.failed {
        return Some(EpisodeEnd::TooManyFailures);
    }
    match world.finished() {
        Some(Ending::AllGoalsMet) => Some(EpisodeEnd::AllGoalsMet),
        Some(Ending::KilledByHazard) => Some(EpisodeEnd::RobotDestroyed),
        None => (world.tick() >= MOST_TICKS).then_some(EpisodeEnd::OutOfTime),
    }
}

/// A command as the world takes it.
fn input(entry: &InputEntry) -> Input {
    Input { command: entry.command, body: BodyId(entry.body), action: entry.action }
}

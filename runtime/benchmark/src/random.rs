//! An agent that does anything that is allowed: the floor that others are compared with.

use std::convert::Infallible;

use cohabit_cdf::{Action, ActionKind, ObjectId};
use cohabit_generate::{Chance, Observer, carry_out, world_of};
use cohabit_record::{InputEntry, entry::hex};
use cohabit_world::{BodyId, Input, Report, World};

use crate::{
    benchmark::Benchmark,
    episode::{Recording, TickInputs},
    mission::Mission,
};

/// The body that acts.
const BODY: BodyId = BodyId(0);

/// Plays a mission by chance, up to the benchmark's cap of actions: of the actions that the table allows where the robot stands, a
/// kind is drawn, then a thing. It knows all things, and not what is wanted.
///
/// # Errors
/// Why the mission has no world here, in words.
pub fn random(benchmark: &Benchmark, mission: &Mission, seed: u64) -> Result<Recording, String> {
    let mut world = world_of(&mission.id, &mission.cdf.to_string(), &benchmark.catalog, benchmark.seed)?;
    let mut chance = Chance::new(seed, stream(&mission.id));
    let mut recording = Recording::default();
    world.step(&[]);
    while recording.taken.len() < benchmark.caps.actions as usize && world.finished().is_none() {
        let Some(action) = choose(&world, &mut chance) else { break };
        let command = Input { command: recording.taken.len() as u64 + 1, body: BODY, action };
        // What takes too long is left alone.
        let Ok(_) = carry_out(&mut world, &mut recording, command);
    }
    recording.ticks = world.tick();
    Ok(recording)
}

/// The draws of a mission: each has others.
fn stream(id: &str) -> u64 {
    blake3::hash(id.as_bytes()).as_bytes().iter().take(8).fold(0, |number, byte| (number << 8) | u64::from(*byte))
}

fn choose(world: &World, chance: &mut Chance) -> Option<Action> {
    let state = world.symbols(BODY);
    let table = world.catalog().table();
    let mut kinds = ActionKind::ALL.to_vec();
    while !kinds.is_empty() {
        let kind = kinds.swap_remove(chance.below(kinds.len()));
        let is_allowed = |id: &ObjectId| table.judge(&state, kind, *id).is_some_and(|judgement| judgement.is_allowed());
        let allowed: Vec<ObjectId> = state.existing().filter(is_allowed).collect();
        if let Some(object) = chance.pick(&allowed) {
            return Some(kind.on(*object));
        }
    }
    None
}

/// Notes the ticks that take commands in.
impl Observer for Recording {
    type Error = Infallible;

    fn note(&mut self, world: &World, inputs: &[Input], _: &Report) -> Result<(), Infallible> {
        if !inputs.is_empty() {
            let inputs = inputs.iter().map(|&Input { command, body, action }| InputEntry {
                command,
                turn: 0,
                body: body.0,
                action,
            });
            self.taken.push(TickInputs { tick: world.tick(), digest: hex(&world.digest()), inputs: inputs.collect() });
        }
        Ok(())
    }
}

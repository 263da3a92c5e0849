//! Long lives of worlds: random commands to several bodies, the same on every machine, for digests to be compared.

use std::sync::Arc;

use cohabit_cdf::{Catalog, RoomId};
use cohabit_world::{BodyKind, Input, World};

use super::{
    script::Line,
    stage::{kitchen, laboratory},
    world,
};

/// A world and all that will be told to it.
pub struct Life {
    pub name: String,
    pub world: World,
    random: Random,
    next: u64,
    wait: u32,
    until: Option<u64>,
    inputs: Vec<Input>,
    /// How many commands came to a good end.
    pub succeeded: u32,
}

/// The lives that digests are recorded of: every built-in mission, and every floor plan as a kitchen or a laboratory.
pub fn lives() -> impl Iterator<Item = Life> {
    let catalog = Arc::new(Catalog::builtin());
    (0..).map_while(move |number| life(&catalog, number))
}

/// One of [`lives`].
pub fn life(catalog: &Arc<Catalog>, number: usize) -> Option<Life> {
    let missions = cohabit_cdf::mission::builtin();
    if let Some((name, text)) = missions.get(number) {
        let mut world = world(name, text, 11);
        world.add_body(BodyKind::Robot, RoomId::MAIN_OFFICE).unwrap();
        return Some(Life::new(name.trim_end_matches(".json"), world, number as u64));
    }
    let layouts = cohabit_cdf::Layout::builtin_ids();
    let layout = layouts.get(number - missions.len())?;
    let world = if number.is_multiple_of(2) { kitchen(catalog, layout) } else { laboratory(catalog, layout) };
    Some(Life::new(layout, world, number as u64))
}

impl Life {
    pub fn new(name: &str, world: World, seed: u64) -> Self {
        let random = Random(seed);
        Self { name: name.to_owned(), world, random, next: 1, wait: 0, until: None, inputs: Vec::new(), succeeded: 0 }
    }

    /// Goes on by one tick, with a new command whenever the last one had its time; what was told is given back.
    pub fn step(&mut self) -> Vec<Input> {
        while self.wait == 0 {
            let line = Line::from_bytes(self.random.bytes());
            let input = line.input(&self.world, self.next);
            self.inputs.push(input);
            let (ticks, until_done) = line.wait();
            self.wait = ticks;
            self.until = until_done.then_some(self.next);
            self.next += 1;
        }
        let inputs = std::mem::take(&mut self.inputs);
        let report = self.world.step(&inputs);
        self.wait -= 1;
        self.succeeded += report.outcomes.iter().filter(|outcome| outcome.status.is_success()).count() as u32;
        if report.outcomes.iter().any(|outcome| Some(outcome.command) == self.until) {
            self.wait = 0;
        }
        inputs
    }
}

/// SplitMix64: numbers as good as random for choosing commands.
struct Random(u64);

impl Random {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^= mixed >> 31;
        std::array::from_fn(|index| mixed.to_le_bytes()[index])
    }
}

//! Plays a script in a world, and watches that nothing is lost, doubled, untold or left without an outcome.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::Color;
use cohabit_world::{Action, BodyId, Event, Input, ObjectId, Report, Status, World};

use super::{
    script::{Line, verb, write},
    sound::{check_bodies, check_objects, check_standing},
    walls::Walls,
};

/// Ticks that a world goes on after the last command, so that what flies may land.
const AFTER_TICKS: u32 = 10;

/// What was done so far, over all scripts.
#[derive(Debug, Default)]
pub struct Tally {
    /// How often a command was given, and how often it succeeded, by what it is called.
    pub verbs: BTreeMap<String, (u32, u32)>,
    pub statuses: BTreeMap<String, u32>,
    pub events: BTreeMap<String, u32>,
    pub ticks: u64,
}

/// One script played in one world.
pub struct Trial<'a> {
    world: &'a mut World,
    walls: &'a Walls,
    tally: &'a mut Tally,
    /// What was given and what came of it, to be printed when something is wrong.
    told: &'a mut Vec<String>,
    next: u64,
    open: BTreeMap<u64, Action>,
    count: i64,
    touched: BTreeSet<ObjectId>,
}

impl<'a> Trial<'a> {
    pub fn new(world: &'a mut World, walls: &'a Walls, tally: &'a mut Tally, told: &'a mut Vec<String>) -> Self {
        told.clear();
        let mut trial =
            Self { world, walls, tally, told, next: 1, open: BTreeMap::new(), count: 0, touched: BTreeSet::new() };
        trial.count = trial.existing();
        // What was in the making as the world was left off belongs to this trial.
        for body in trial.world.bodies() {
            trial.open.extend(body.command.map(|command| (command, Action::Stop)));
            trial.next = trial.next.max(body.command.map_or(0, |command| command + 1));
        }
        trial
    }

    /// Plays all lines, stops everybody, and looks whether all is well.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn play(mut self, lines: &[Line]) -> Result<(), String> {
        let before = signatures(self.world);
        let mut inputs = Vec::new();
        for line in lines {
            let input = line.input(self.world, self.next);
            self.give(input);
            inputs.push(input);
            let (ticks, until_done) = line.wait();
            for _ in 0..ticks {
                self.step(&inputs)?;
                inputs.clear();
                if until_done && !self.open.contains_key(&input.command) {
                    break;
                }
            }
            if ticks > 0 {
                check_objects(self.world)?;
            }
        }
        let bodies = self.world.bodies().len() as u32;
        for body in 0..bodies {
            let stop = Input { command: self.next, body: BodyId(body), action: Action::Stop };
            self.give(stop);
            inputs.push(stop);
        }
        self.step(&inputs)?;
        if !self.open.is_empty() {
            return Err(format!("stopped, but without an outcome: {:?}", self.open));
        }
        for _ in 0..AFTER_TICKS {
            self.step(&[])?;
        }
        check_objects(self.world)?;
        check_standing(self.world)?;
        self.check_told(&before)
    }

    fn give(&mut self, input: Input) {
        self.told.push(write(self.world, &input));
        self.open.insert(input.command, input.action);
        self.tally.verbs.entry(verb(&input.action)).or_default().0 += 1;
        self.next += 1;
    }

    fn step(&mut self, inputs: &[Input]) -> Result<(), String> {
        let report = self.world.step(inputs);
        self.tally.ticks += 1;
        self.outcomes(&report)?;
        for event in &report.events {
            *self.tally.events.entry(word(&format!("{event:?}"))).or_default() += 1;
            match event {
                Event::Spawned { object, .. } => {
                    self.count += 1;
                    self.touched.insert(*object);
                }
                Event::Removed { object } => {
                    self.count -= 1;
                    self.touched.insert(*object);
                }
                Event::ObjectChanged { object } => {
                    self.touched.insert(*object);
                }
                _ => {}
            }
        }
        if !report.events.is_empty() && self.existing() != self.count {
            return Err(format!("there are {} objects where events make it {}", self.existing(), self.count));
        }
        check_bodies(self.world, self.walls)
    }

    fn outcomes(&mut self, report: &Report) -> Result<(), String> {
        for outcome in &report.outcomes {
            self.told.push(format!("    {}: {:?}: {}", outcome.command, outcome.status, outcome.detail));
            let Some(action) = self.open.remove(&outcome.command) else {
                return Err(format!("an outcome for a command that has none open: {outcome:?}"));
            };
            if outcome.detail.is_empty() {
                return Err(format!("an outcome without a word: {outcome:?}"));
            }
            *self.tally.statuses.entry(format!("{:?}", outcome.status)).or_default() += 1;
            self.tally.verbs.entry(verb(&action)).or_default().1 += u32::from(outcome.status.is_success());
            let dead = self.world.body(outcome.body).is_some_and(|body| !body.alive);
            if dead && !matches!(outcome.status, Status::KilledByHazard | Status::Interrupted) {
                // Whoever dies in the tick in which a command ends may still have done it.
                self.told.push("    (by a body that is out of order)".to_owned());
            }
        }
        Ok(())
    }

    fn existing(&self) -> i64 {
        self.world.objects().filter(|view| self.world.exists(view.id)).count() as i64
    }

    /// Whoever listens to events alone must know of every change of state.
    fn check_told(&self, before: &[Signature]) -> Result<(), String> {
        let after = signatures(self.world);
        for (id, now) in (0..).map(ObjectId).zip(&after) {
            let same = before.get(id.0 as usize).is_some_and(|was| was == now);
            if !same && !self.touched.contains(&id) {
                let instance = self.world.object(id).map_or("?", |view| view.instance);
                let was = before.get(id.0 as usize);
                return Err(format!("{instance} changed from {was:?} to {now:?}, and no event said so"));
            }
        }
        Ok(())
    }
}

/// What of an object nobody can see from where bodies are and how time passes.
type Signature = (u32, u8, Color, Option<ObjectId>, Option<BodyId>, bool, [u32; 3]);

fn signatures(world: &World) -> Vec<Signature> {
    let of = |view: cohabit_world::ObjectView<'_>| {
        let scale = view.scale.map(f32::to_bits);
        (view.flags.0, view.fluid as u8, view.color, view.parent, view.held_by, world.exists(view.id), scale)
    };
    world.objects().map(of).collect()
}

/// The first word of what is printed of a value.
fn word(text: &str) -> String {
    text.split([' ', '{', '(']).next().unwrap_or_default().to_owned()
}

//! What follows in a recorded session, given once more to one that goes on otherwise.

use std::collections::{BTreeMap, VecDeque};

use cohabit_cdf::BodyId;
use cohabit_record::{InputEntry, Log, LogError};
use cohabit_world::Input;

use super::{point::Point, retold::Retold};
use crate::lock_step::{BODY, LockStep};

/// Nobody waits longer for the robot to be at rest, in ticks: five minutes.
const LONGEST_WAIT_TICKS: u64 = 60 * 300;

/// A command, and the tick that it is for.
type At = (u64, InputEntry);

/// What is still to be given.
pub(super) struct Rest {
    /// To the robot, in order.
    own: VecDeque<Next>,
    /// To other bodies, in order.
    others: VecDeque<At>,
    /// The last tick of the recorded session.
    last: u64,
}

/// Something that was said to the robot, or a command that none of its plans gave.
struct Next {
    /// The newest tick before it.
    tick: u64,
    given: Given,
    /// Whether the robot was at something else then.
    interrupts: bool,
}

enum Given {
    /// What is said, and of it what is said to the robot: all but its name.
    Words {
        text: String,
        plain: String,
    },
    Command(InputEntry),
}

impl Rest {
    /// What follows behind a point. The commands of a robot that does what people say are its own to give again.
    pub fn after(log: &Log, point: &Point, robot: &Retold<'_>) -> Self {
        let ticks = log.ticks.iter().filter(|entry| entry.tick > point.tick);
        let inputs = ticks.flat_map(|entry| entry.inputs.iter().map(|input| (entry.tick, input.clone())));
        let given = inputs.filter(|(_, input)| !point.replaces(input));
        let (own, others) = partition(given);
        let own = own.into_iter().filter(|(_, input)| input.turn == 0 || !robot.follows).collect();
        let mut all = said(log, point, robot);
        all.extend(commands(log, own));
        all.sort_by_key(|next| next.tick);
        let last = log.ticks.last().map_or(0, |entry| entry.tick);
        Self { own: all.into(), others, last }
    }

    /// Gives all of it, and goes on until the robot is at rest and as much time has passed as did.
    pub fn play(mut self, session: &mut LockStep) -> Result<(), LogError> {
        let (mut late, mut waited) = (0, 0);
        loop {
            let now = session.world().tick();
            while let Some((_, entry)) = self.others.pop_front_if(|(tick, _)| *tick <= now + 1) {
                session.give(input(&entry), entry.turn);
            }
            let is_free = session.is_at_rest() || waited >= LONGEST_WAIT_TICKS;
            let due = self.own.front().map_or(self.last, |next| next.tick) + late;
            waited = if now < due || session.is_at_rest() { 0 } else { waited + 1 };
            match self.own.pop_front_if(|next| now >= due && (is_free || next.interrupts)) {
                Some(next) => {
                    late = now.saturating_sub(next.tick);
                    waited = 0;
                    next.give(session)?;
                }
                None if self.own.is_empty() && self.others.is_empty() && now >= due && is_free => return Ok(()),
                None => {}
            }
            session.tick()?;
        }
    }
}

impl Next {
    fn give(self, session: &mut LockStep) -> Result<(), LogError> {
        match self.given {
            Given::Words { text, plain } => session.say_called(&text, &plain).map(drop),
            Given::Command(entry) => {
                session.give(input(&entry), entry.turn);
                Ok(())
            }
        }
    }
}

/// Those of the robot's body, and those of others.
fn partition(given: impl Iterator<Item = At>) -> (Vec<At>, VecDeque<At>) {
    let (mut own, mut others) = (Vec::new(), VecDeque::new());
    for (tick, input) in given {
        if input.body == BODY.0 { own.push((tick, input)) } else { others.push_back((tick, input)) }
    }
    (own, others)
}

/// What was said to the robot behind a point, but for what other words take the place of.
fn said(log: &Log, point: &Point, robot: &Retold<'_>) -> Vec<Next> {
    let (mut all, mut has_plan) = (Vec::new(), false);
    // The entry at the point of something that was said is that itself.
    let first = point.dialog + usize::from(point.input.is_none());
    for (at, entry) in log.dialog.iter().enumerate().filter(|(_, entry)| entry.body == BODY.0) {
        match entry.kind.as_str() {
            "Plan" => has_plan = true,
            "PlanEnded" => has_plan = false,
            "Utterance" if at >= first => {
                let (text, plain) = (entry.text.clone(), robot.without_name(&entry.text));
                all.push(Next { tick: entry.tick, given: Given::Words { text, plain }, interrupts: has_plan });
            }
            _ => {}
        }
    }
    all
}

/// Commands as they are given again: each at once, if the one before it had not ended.
fn commands(log: &Log, inputs: Vec<At>) -> Vec<Next> {
    let outcomes = log.events.iter().filter(|event| event.kind == "Outcome");
    let ended: BTreeMap<u64, u64> = outcomes.filter_map(|event| Some((event.command?, event.tick))).collect();
    let mut newest = None;
    let next = |(tick, entry): At| {
        let before = newest.replace(entry.command);
        let interrupts = before.is_some_and(|before| ended.get(&before).is_none_or(|ended| *ended >= tick));
        Next { tick: tick.saturating_sub(1), given: Given::Command(entry), interrupts }
    };
    inputs.into_iter().map(next).collect()
}

fn input(entry: &InputEntry) -> Input {
    Input { command: entry.command, body: BodyId(entry.body), action: entry.action }
}

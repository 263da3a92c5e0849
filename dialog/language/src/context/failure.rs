//! A step that failed, what was to follow it, and what the plan had opened and turned on by then.

use std::iter;

use cohabit_cdf::{Action, ObjectId, StateFlag, Status, Verb};
use serde::{Deserialize, Serialize};

use crate::{known::Known, understanding::Step};

/// How a step begins that turns something off: to switch is one action, whichever way.
const TURNS_OFF: &str = "turning off";

/// A step that failed.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Failure {
    pub(crate) step: Step,
    pub(crate) status: Status,
    pub(crate) rest: Vec<Step>,
    /// What was to follow and has nothing to do with it: that is done all the same.
    #[serde(default)]
    apart: Vec<Step>,
    /// The steps before it that opened and turned on what the rest was to close and turn off.
    #[serde(default)]
    begun: Vec<Step>,
}

impl Failure {
    /// A step that failed once others were `done`, with those that were to follow.
    pub(crate) fn new(step: Step, status: Status, done: &[Step], rest: Vec<Step>) -> Self {
        let (rest, apart) = parted(&step, status, done, rest);
        let begun = done.iter().filter(|step| taken_back(step, &rest).is_some()).cloned().collect();
        Self { step, status, rest, apart, begun }
    }

    /// Whether there is more to do that has nothing to do with it.
    pub(crate) const fn has_apart(&self) -> bool {
        !self.apart.is_empty()
    }

    /// That, which then is no longer left to do, once what the plan left open and on is closed and off.
    pub(crate) fn take_apart(&mut self, scene: &Known) -> Option<Vec<Step>> {
        let apart = std::mem::take(&mut self.apart);
        (!apart.is_empty()).then(|| self.put_right(scene).into_iter().chain(apart).collect())
    }

    /// The steps that close and turn off what the plan left open and on, and would have closed and turned off itself: what was asked for
    /// stays. The last that was begun comes first.
    pub(crate) fn put_right(&self, scene: &Known) -> Vec<Step> {
        let left = self.begun.iter().rev().filter(|step| is_so(scene, step));
        let mut steps: Vec<Step> = left.filter_map(|step| taken_back(step, &self.rest)).cloned().collect();
        steps.dedup_by(|one, other| one.action == other.action);
        steps
    }

    /// The failed step again, and the rest; first what was put right since is opened and turned on again.
    pub(crate) fn again(&self, scene: &Known) -> Vec<Step> {
        let begun = self.begun.iter().filter(|step| !is_so(scene, step));
        begun.chain(iter::once(&self.step)).chain(&self.rest).cloned().collect()
    }
}

/// The steps that were to follow a failed one: those that build on it, and those that have nothing to do with it. Where nobody can tell,
/// all build on it: behind a door that did not open, and where the robot did not get to.
fn parted(failed: &Step, status: Status, done: &[Step], rest: Vec<Step>) -> (Vec<Step>, Vec<Step>) {
    let is_over = matches!(status, Status::Interrupted | Status::KilledByHazard | Status::ArenaUnavailable);
    let mut hand = match failed.action {
        _ if is_over => return (rest, Vec::new()),
        Action::PickUp { .. } if status == Status::AlreadyHoldingObject => Hand { lacks: true, is_full: true },
        Action::PickUp { .. } => Hand { lacks: true, is_full: false },
        Action::Place { .. } | Action::PlaceBeside { .. } | Action::Interact { verb: Verb::Throw, .. } => {
            Hand { lacks: false, is_full: true }
        }
        Action::Interact { verb, .. } if verb != Verb::Open => Hand { lacks: false, is_full: false },
        _ => return (rest, Vec::new()),
    };
    let is_handled = |step: &&Step| matches!(step.action, Action::PickUp { .. } | Action::Interact { .. });
    let handled = done.iter().filter(is_handled).chain(iter::once(failed));
    let mut tied: Vec<ObjectId> = handled.filter_map(Step::object).collect();
    let (mut built_on_it, mut apart) = (Vec::new(), Vec::new());
    for (at, step) in rest.iter().enumerate() {
        let part = if hand.builds_on_failure(&rest[at..], &mut tied) { &mut built_on_it } else { &mut apart };
        part.push(step.clone());
    }
    (built_on_it, apart)
}

/// The hand after a failure, where it is otherwise than the plan would have it.
struct Hand {
    /// Whether it does not hold what the plan would have it hold.
    lacks: bool,
    /// Whether it still holds what it was to put down.
    is_full: bool,
}

impl Hand {
    /// Whether the first of the steps that are left builds on what failed: it is about what that handled, or needs another thing in hand.
    fn builds_on_failure(&mut self, left: &[Step], tied: &mut Vec<ObjectId>) -> bool {
        let Some(step) = left.first() else { return false };
        let is_tied = step.object().is_some_and(|object| tied.contains(&object));
        match step.action {
            Action::PickUp { .. } => self.lacks = is_tied || self.is_full,
            Action::Place { .. } | Action::PlaceBeside { .. } | Action::Interact { verb: Verb::Throw, .. } => {
                return std::mem::take(&mut self.lacks) || is_tied;
            }
            _ if self.lacks && uses_hand(left) => {}
            _ => return is_tied,
        }
        if self.lacks {
            tied.extend(step.object());
        }
        self.lacks
    }
}

/// Whether any of these steps needs what is in the hand before another thing is taken.
fn uses_hand(steps: &[Step]) -> bool {
    let uses = |step: &Step| match step.action {
        Action::PickUp { .. } => Some(false),
        Action::Place { .. } | Action::PlaceBeside { .. } => Some(true),
        Action::Interact { verb, .. } => {
            matches!(verb, Verb::Throw | Verb::Pour | Verb::Fill | Verb::Clean | Verb::Break).then_some(true)
        }
        _ => None,
    };
    steps.iter().find_map(uses).unwrap_or(false)
}

/// The step that closes what a step opened, or turns off what it turned on.
fn taken_back<'s>(step: &Step, steps: &'s [Step]) -> Option<&'s Step> {
    let Action::Interact { verb: done, object } = step.action else { return None };
    steps.iter().find(|other| {
        let Action::Interact { verb, object: same } = other.action else { return false };
        let is_pair = match (done, verb) {
            (Verb::Open, Verb::Close) => true,
            (Verb::Toggle, Verb::Toggle) => other.says.starts_with(TURNS_OFF) && !step.says.starts_with(TURNS_OFF),
            _ => false,
        };
        is_pair && same == object
    })
}

/// Whether what a step opened or turned on is so now.
fn is_so(scene: &Known, step: &Step) -> bool {
    let Action::Interact { verb, object } = step.action else { return false };
    let flag = if verb == Verb::Open { StateFlag::Opened } else { StateFlag::Toggled };
    scene.object(object).is_some_and(|object| object.has(flag))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_taken_back_by_what_closes_or_turns_off_the_same() {
        let step = |verb, object, says: &str| Step {
            action: Action::Interact { verb, object: ObjectId(object) },
            says: says.to_owned(),
        };
        let rest = [
            step(Verb::Close, 1, "closing the fridge"),
            step(Verb::Toggle, 2, "turning off the sink"),
            step(Verb::Toggle, 3, "pressing the red button"),
        ];
        let found = |step: &Step| taken_back(step, &rest).map(|step| step.says.as_str());
        assert_eq!(found(&step(Verb::Open, 1, "opening the fridge")), Some("closing the fridge"));
        assert_eq!(found(&step(Verb::Toggle, 2, "turning on the sink")), Some("turning off the sink"));
        assert_eq!(found(&step(Verb::Open, 4, "opening the freezer")), None);
        assert_eq!(found(&step(Verb::Toggle, 3, "pressing the red button")), None, "each press does something");
    }

    #[test]
    fn what_has_nothing_to_do_with_a_failure_stands_apart() {
        let step = |action| Step { action, says: String::new() };
        let take = |object| step(Action::PickUp { object: ObjectId(object) });
        let put = |object| step(Action::Place { receptacle: ObjectId(object) });
        let act = |verb, object| step(Action::Interact { verb, object: ObjectId(object) });
        let count = |failed: &Step, status, done: &[Step], rest: &[Step]| {
            let (tied, apart) = parted(failed, status, done, rest.to_vec());
            (tied.len(), apart.len())
        };
        let status = Status::ActionExecutionError;
        let (mug, plate, table, oven, lamp) = (1, 2, 3, 4, 5);
        let heated = [act(Verb::Open, oven), put(oven), act(Verb::Close, oven), take(mug), act(Verb::Toggle, lamp)];
        assert_eq!(count(&take(mug), status, &[], &heated), (4, 1), "only the lamp has nothing to do with the mug");
        let tidied = [take(plate), put(table), act(Verb::Toggle, lamp)];
        assert_eq!(count(&act(Verb::Toggle, oven), status, &[], &tidied), (0, 3));
        assert_eq!(count(&act(Verb::Toggle, oven), status, &[take(plate), put(oven)], &tidied), (2, 1));
        assert_eq!(count(&put(table), status, &[take(mug)], &tidied), (2, 1), "the hand is full");
        assert_eq!(count(&act(Verb::Open, oven), status, &[], &tidied), (3, 0), "the plate may be in there");
        assert_eq!(count(&act(Verb::Toggle, oven), Status::KilledByHazard, &[], &tidied), (3, 0));
    }
}

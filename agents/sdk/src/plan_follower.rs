//! The dialog-driven agent: does the steps of a plan one after the other, and walks to what each one needs.

use std::collections::VecDeque;

use cohabit_bus::message::{DialogKind, DialogMessage};
use cohabit_cdf::{Action, Status};

use crate::{
    agent::{Agent, Deed, Heard},
    errand::{Errand, Progress},
};

/// In lock-step a plan waits for its turn, for so many ticks at most: a tenth of a second.
const LISTENS_EVERY: u64 = 6;

/// Follows plans. A step on an object that the body does not stand at is preceded by walking there.
#[derive(Debug, Default)]
pub struct PlanFollower {
    body: u32,
    plan: Option<Plan>,
    errand: Errand,
}

#[derive(Debug)]
struct Plan {
    turn: u64,
    rest: VecDeque<Option<Action>>,
    step: u32,
}

impl PlanFollower {
    /// A follower that commands that body.
    #[must_use]
    pub fn new(body: u32) -> Self {
        Self { body, ..Self::default() }
    }

    fn begin_step(&mut self, deeds: &mut Vec<Deed>) {
        let Some(plan) = &mut self.plan else { return };
        let turn = plan.turn;
        let Some(next) = plan.rest.pop_front() else {
            self.end_plan(Status::ActionSuccessful, "", deeds);
            return;
        };
        deeds.push(tell(DialogKind::StepStarted, self.body, plan, Status::ActionSuccessful, ""));
        match next {
            Some(action) => deeds.push(Deed::Act { turn, action: self.errand.begin(action) }),
            None => self.end_step(Status::IncorrectActionFormat, "that step is not well formed", deeds),
        }
    }

    fn end_step(&mut self, status: Status, detail: &str, deeds: &mut Vec<Deed>) {
        let Some(plan) = &mut self.plan else { return };
        deeds.push(tell(DialogKind::StepEnded, self.body, plan, status, detail));
        if status.is_success() {
            plan.step += 1;
            self.begin_step(deeds);
        } else {
            self.end_plan(status, detail, deeds);
        }
    }

    fn end_plan(&mut self, status: Status, detail: &str, deeds: &mut Vec<Deed>) {
        if let Some(plan) = self.plan.take() {
            deeds.push(tell(DialogKind::PlanEnded, self.body, &plan, status, detail));
        }
    }
}

impl Agent for PlanFollower {
    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        match *heard {
            Heard::Plan { turn, steps } => {
                self.end_plan(Status::Interrupted, "", deeds);
                let rest = steps.iter().map(|step| Action::try_from(step.action).ok()).collect();
                self.plan = Some(Plan { turn, rest, step: 0 });
                self.begin_step(deeds);
            }
            Heard::Outcome { status, detail } => match (self.errand.hear(status), &self.plan) {
                (Some(Progress::Then(action)), Some(plan)) => deeds.push(Deed::Act { turn: plan.turn, action }),
                (Some(Progress::Over), _) => self.end_step(status, detail, deeds),
                _ => {}
            },
            // Others may have moved the body meanwhile, and what it holds.
            Heard::Commands(_) => self.errand.forget(),
            Heard::Now(_) => deeds.push(Deed::Rest(LISTENS_EVERY)),
        }
    }
}

/// What is told about the step that a plan is at.
fn tell(kind: DialogKind, body: u32, plan: &Plan, status: Status, detail: &str) -> Deed {
    Deed::Tell(Box::new(DialogMessage::new(kind, body, plan.turn, detail).at_step(plan.step, status)))
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::PlanStep;
    use cohabit_cdf::{GoToTarget, ObjectId, Verb};

    use super::*;

    const MUG: ObjectId = ObjectId(1);
    const DESK: ObjectId = ObjectId(2);

    fn steps(actions: &[Action]) -> Vec<PlanStep> {
        actions.iter().map(|action| PlanStep { action: (*action).into(), ..PlanStep::default() }).collect()
    }

    /// Feeds a plan and then outcomes; gives the actions taken and how the plan ended.
    fn follow(plan: &[Action], outcomes: &[Status]) -> (Vec<Action>, Option<Status>) {
        let mut follower = PlanFollower::new(0);
        let mut deeds = Vec::new();
        follower.hear(&Heard::Plan { turn: 1, steps: &steps(plan) }, &mut deeds);
        for status in outcomes {
            follower.hear(&Heard::Outcome { status: *status, detail: "" }, &mut deeds);
        }
        let ended = deeds.iter().find_map(|deed| match deed {
            Deed::Tell(message) if message.header.kind() == Some(DialogKind::PlanEnded) => message.header.status(),
            _ => None,
        });
        let acts = deeds.iter().filter_map(|deed| match deed {
            Deed::Act { action, .. } => Some(*action),
            Deed::Tell(_) | Deed::Rest(_) => None,
        });
        (acts.collect(), ended)
    }

    const fn go(object: ObjectId) -> Action {
        Action::GoTo { target: GoToTarget::Object(object) }
    }

    #[test]
    fn it_walks_to_what_it_acts_on_once() {
        let ok = Status::ActionSuccessful;
        let pick = Action::PickUp { object: MUG };
        let place = Action::Place { receptacle: DESK };
        let scan = Action::Interact { verb: Verb::Scan, object: MUG };
        let (acts, ended) = follow(&[pick, scan, place], &[ok; 6]);
        assert_eq!(acts, [go(MUG), pick, scan, go(DESK), place]);
        assert_eq!(ended, Some(ok));
    }

    #[test]
    fn a_failed_step_ends_the_plan() {
        let pick = Action::PickUp { object: MUG };
        let (acts, ended) = follow(&[pick, Action::LookAround], &[Status::UnsupportedNavigation]);
        assert_eq!((acts, ended), (vec![go(MUG)], Some(Status::UnsupportedNavigation)));
    }

    #[test]
    fn a_new_plan_ends_the_one_before() {
        let mut follower = PlanFollower::new(0);
        let mut deeds = Vec::new();
        follower.hear(&Heard::Plan { turn: 1, steps: &steps(&[Action::LookAround]) }, &mut deeds);
        follower.hear(&Heard::Plan { turn: 2, steps: &steps(&[Action::Stop]) }, &mut deeds);
        let ended: Vec<_> = deeds
            .iter()
            .filter_map(|deed| match deed {
                Deed::Tell(message) if message.header.kind() == Some(DialogKind::PlanEnded) => {
                    Some((message.header.turn, message.header.status()))
                }
                _ => None,
            })
            .collect();
        assert_eq!(ended, [(1, Some(Status::Interrupted))]);
        assert!(matches!(deeds.last(), Some(Deed::Act { turn: 2, action: Action::Stop })));
    }

    #[test]
    fn an_empty_plan_ends_at_once() {
        assert_eq!(follow(&[], &[]), (vec![], Some(Status::ActionSuccessful)));
    }
}

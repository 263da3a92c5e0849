//! What was said and done before an agent joined, so that one that takes a dead one's place carries on where that was.
//!
//! An agent decides by what it hears alone. Who hears the newest plan, and what came of it so far, knows what is left.

use cohabit_bus::message::PlanStep;
use cohabit_cdf::Status;

use crate::agent::{Agent, Deed, Heard};

/// The newest plan of a body, and the outcomes of its commands, in order.
#[derive(Debug, Default)]
pub(crate) struct Past {
    plan: Option<(u64, Vec<PlanStep>)>,
    outcomes: Vec<(u64, Status, String)>,
}

impl Past {
    /// A plan was asked for.
    pub(crate) fn note_plan(&mut self, turn: u64, steps: &[PlanStep]) {
        if self.plan.as_ref().is_none_or(|(newest, _)| *newest <= turn) {
            self.plan = Some((turn, steps.to_vec()));
        }
    }

    /// A command of some turn came to an end.
    pub(crate) fn note_outcome(&mut self, turn: u64, status: Status, detail: &str) {
        self.outcomes.push((turn, status, detail.to_owned()));
    }

    /// Whether something was done about that turn.
    pub(crate) fn knows(&self, turn: u64) -> bool {
        turn != 0 && self.outcomes.iter().any(|(of, ..)| *of == turn)
    }

    /// Has the agent hear it all again. Gives what it would do now; at the end of a plan it tells that once more, since the
    /// one before may have died before it had.
    pub(crate) fn relive(&self, agent: &mut dyn Agent) -> Vec<Deed> {
        let mut deeds = Vec::new();
        let Some((turn, steps)) = &self.plan else { return deeds };
        agent.hear(&Heard::Plan { turn: *turn, steps }, &mut deeds);
        for (_, status, detail) in self.outcomes.iter().filter(|(of, ..)| of == turn) {
            deeds.clear();
            agent.hear(&Heard::Outcome { status: *status, detail }, &mut deeds);
        }
        deeds
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId};

    use super::*;
    use crate::PlanFollower;

    const MUG: ObjectId = ObjectId(1);
    const OK: Status = Status::ActionSuccessful;

    fn steps() -> Vec<PlanStep> {
        let room = Action::GoTo { target: GoToTarget::Room(RoomId::LAB1) };
        let actions = [room, Action::PickUp { object: MUG }];
        actions.map(|action| PlanStep { action: action.into(), ..PlanStep::default() }).to_vec()
    }

    /// What a follower does that joins after a plan of turn 2 and these outcomes.
    fn after(outcomes: &[(u64, Status)]) -> Option<Action> {
        let mut past = Past::default();
        past.note_plan(1, &[]);
        past.note_plan(2, &steps());
        outcomes.iter().for_each(|(turn, status)| past.note_outcome(*turn, *status, ""));
        past.relive(&mut PlanFollower::new(0)).into_iter().find_map(|deed| match deed {
            Deed::Act { turn, action } => Some((turn == 2).then_some(action)?),
            Deed::Tell(_) | Deed::Rest(_) => None,
        })
    }

    #[test]
    fn what_is_left_of_a_plan_is_done() {
        let go_to_mug = Action::GoTo { target: GoToTarget::Object(MUG) };
        assert_eq!(after(&[]), Some(Action::GoTo { target: GoToTarget::Room(RoomId::LAB1) }));
        assert_eq!(after(&[(1, OK), (2, OK)]), Some(go_to_mug));
        assert_eq!(after(&[(2, OK), (2, OK)]), Some(Action::PickUp { object: MUG }));
        assert_eq!(after(&[(2, OK), (2, OK), (2, OK)]), None);
        assert_eq!(after(&[(2, Status::UnsupportedNavigation)]), None);
    }

    #[test]
    fn who_joins_at_the_start_has_nothing_to_do() {
        assert!(Past::default().relive(&mut PlanFollower::new(0)).is_empty());
    }
}

//! One action, and the walk to what it acts on.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Status, Verb};

/// Does one action at a time. One on an object that the body does not stand at is preceded by walking there.
#[derive(Debug, Default)]
pub struct Errand {
    doing: Option<Doing>,
    stands_at: Option<ObjectId>,
    holds: Option<ObjectId>,
}

/// What the body is at.
#[derive(Clone, Copy, Debug)]
enum Doing {
    /// Walking to the object that the action acts on.
    Approach { target: ObjectId, then: Action },
    /// The action itself.
    Act(Action),
}

/// What follows from an outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// The body is to do this now.
    Then(Action),
    /// The errand is over, done or not.
    Over,
}

impl Errand {
    /// Takes an action up, in place of the one before; gives what the body is to do first.
    pub fn begin(&mut self, action: Action) -> Action {
        if self.doing.is_some() {
            self.leave_place();
        }
        let target = acts_on(action).filter(|target| ![self.stands_at, self.holds].contains(&Some(*target)));
        let (doing, first) = match target {
            Some(target) => {
                (Doing::Approach { target, then: action }, Action::GoTo { target: GoToTarget::Object(target) })
            }
            None => (Doing::Act(action), action),
        };
        self.doing = Some(doing);
        first
    }

    /// Takes in what came of what the body did; `None` if there is no errand.
    pub fn hear(&mut self, status: Status) -> Option<Progress> {
        match self.doing.take()? {
            Doing::Approach { target, then } if status.is_success() => {
                self.doing = Some(Doing::Act(then));
                self.stands_at = Some(target);
                return Some(Progress::Then(then));
            }
            // Nobody walks to what is in a hand. It may be in this very one, if others put it there.
            Doing::Approach { then, .. } if status == Status::InvalidCommand && self.holds.is_none() => {
                self.leave_place();
                self.doing = Some(Doing::Act(then));
                return Some(Progress::Then(then));
            }
            Doing::Approach { .. } => self.leave_place(),
            Doing::Act(action) => self.learn(action, status.is_success()),
        }
        Some(Progress::Over)
    }

    /// Whether there is one under way.
    #[must_use]
    pub const fn is_under_way(&self) -> bool {
        self.doing.is_some()
    }

    /// What the body holds, as far as it was picked up by an errand.
    #[must_use]
    pub const fn holds(&self) -> Option<ObjectId> {
        self.holds
    }

    /// The body may stand elsewhere than its last errand left it.
    pub const fn leave_place(&mut self) {
        self.stands_at = None;
    }

    /// Others command the body, or have commanded it: where it stands and what its hand holds is theirs to say.
    pub const fn forget(&mut self) {
        self.stands_at = None;
        self.holds = None;
    }

    /// There is no errand any more: others command the body.
    pub const fn give_up(&mut self) {
        self.doing = None;
        self.forget();
    }

    fn learn(&mut self, action: Action, success: bool) {
        match action {
            Action::GoTo { target: GoToTarget::Object(object) } if success => self.stands_at = Some(object),
            Action::GoTo { .. } | Action::Move { .. } | Action::Rotate { .. } => self.leave_place(),
            Action::PickUp { object } if success => self.holds = Some(object),
            Action::Place { .. } | Action::PlaceBeside { .. } | Action::Interact { verb: Verb::Throw, .. }
                if success =>
            {
                self.holds = None;
            }
            _ => {}
        }
    }
}

/// The object that the body must stand at to do this.
const fn acts_on(action: Action) -> Option<ObjectId> {
    match action {
        Action::PickUp { object } | Action::Interact { object, .. } => Some(object),
        Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => Some(receptacle),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUG: ObjectId = ObjectId(1);
    const DESK: ObjectId = ObjectId(2);
    const OK: Status = Status::ActionSuccessful;
    const PICK: Action = Action::PickUp { object: MUG };

    const fn go(object: ObjectId) -> Action {
        Action::GoTo { target: GoToTarget::Object(object) }
    }

    #[test]
    fn it_walks_there_once() {
        let mut errand = Errand::default();
        assert_eq!(errand.begin(PICK), go(MUG));
        assert_eq!(errand.hear(OK), Some(Progress::Then(PICK)));
        assert_eq!(errand.hear(OK), Some(Progress::Over));
        // What is in the hand is wherever the body is.
        assert_eq!(errand.begin(Action::Interact { verb: Verb::Examine, object: MUG }).clone(), {
            Action::Interact { verb: Verb::Examine, object: MUG }
        });
        errand.hear(OK);
        assert_eq!(errand.begin(Action::Place { receptacle: DESK }), go(DESK));
    }

    #[test]
    fn who_did_not_arrive_does_not_act() {
        let mut errand = Errand::default();
        errand.begin(PICK);
        assert_eq!(errand.hear(Status::UnsupportedNavigation), Some(Progress::Over));
        assert!(!errand.is_under_way());
        assert_eq!(errand.hear(OK), None);
    }

    #[test]
    fn what_others_took_into_the_hand_or_out_of_it_is_not_known() {
        let examine = Action::Interact { verb: Verb::Examine, object: MUG };
        let mut errand = Errand::default();
        errand.begin(PICK);
        errand.hear(OK);
        errand.hear(OK);
        // Others put it down somewhere: it has to be walked to.
        errand.forget();
        assert_eq!((errand.holds(), errand.begin(PICK)), (None, go(MUG)));
        // Or they did not, and it is in the hand: there is nowhere to walk to.
        errand.give_up();
        assert_eq!(errand.begin(examine), go(MUG));
        assert_eq!(errand.hear(Status::InvalidCommand), Some(Progress::Then(examine)));
        assert_eq!(errand.hear(OK), Some(Progress::Over));
    }

    #[test]
    fn who_is_sent_elsewhere_does_not_know_where_it_stands() {
        let mut errand = Errand::default();
        errand.begin(PICK);
        errand.hear(OK);
        errand.begin(Action::LookAround);
        errand.hear(OK);
        assert_eq!(errand.begin(PICK), go(MUG));
    }
}

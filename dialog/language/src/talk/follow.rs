//! Going where a person goes, until they ask for something else; and getting out of their way.

use cohabit_cdf::Action;

use crate::{
    context::Context,
    say::reply,
    talk::conversation::Conversation,
    understanding::{Step, Understanding},
};

/// How far somebody who is followed may be before the robot goes after them, m.
const BEHIND_M: f32 = 2.0;
/// Who has moved less than this stands still, m.
const STILL_M: f32 = 0.1;
/// How far it backs up to let somebody pass, m.
const ASIDE_M: f32 = 1.0;
const FOLLOWS: &str = "I follow you. Say \"stop\" when I need not any longer.";
const NOBODY: &str = "I cannot see where you are. Name me a room or a thing, and I will go there.";

impl Conversation<'_> {
    /// `follow me`: goes to the person, and goes on doing so.
    pub(crate) fn follow(&self, context: &mut Context) -> Understanding {
        if self.scene.person.is_none() {
            return Understanding::answer(NOBODY);
        }
        (context.follows, context.gone_after) = (true, None);
        match self.catch_up(context) {
            Some(Understanding::Plan { steps, .. }) => Understanding::Plan { steps, reply: FOLLOWS.to_owned() },
            _ => Understanding::answer(FOLLOWS),
        }
    }

    /// Goes after the person who is followed, if they have gone on.
    pub(crate) fn catch_up(&self, context: &mut Context) -> Option<Understanding> {
        let person = self.scene.person.filter(|_| context.follows)?;
        let robot = &self.scene.robot;
        let [there, here] = [person.position_m, robot.position_m].map(|[x, y, _]| [x, y]);
        // Beyond a doorway it may be as near as it gets, and in another room.
        let has_tried = context
            .gone_after
            .is_some_and(|[they, it]| distance_m(they, there) < STILL_M && distance_m(it, here) < STILL_M);
        if has_tried || person.room == robot.room && distance_m(there, here) < BEHIND_M {
            return None;
        }
        let mut planner = self.planner(context.focus.clone());
        planner.go_to_person("following you");
        context.reason = format!("{}follow you", reply::ASKED_TO);
        let Understanding::Plan { steps, .. } = self.go(planner.steps, context) else { return None };
        context.gone_after = Some([there, here]);
        // It is said once, not each time that they have gone on.
        Some(Understanding::Plan { steps, reply: String::new() })
    }

    /// `you are in the way`.
    pub(crate) fn step_aside(&self, context: &mut Context) -> Understanding {
        let says = "moving out of the way".to_owned();
        let step = Step { action: Action::Move { distance_m: -ASIDE_M }, says };
        self.go(vec![step], context)
    }
}

fn distance_m([x, y]: [f32; 2], [to_x, to_y]: [f32; 2]) -> f32 {
    (to_x - x).hypot(to_y - y)
}

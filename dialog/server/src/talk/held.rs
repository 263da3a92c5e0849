//! What robots hold back: what wizards decide of it, and what follows when its time has come.

use std::time::Duration;

use cohabit_bus::monotonic_nanos;
use cohabit_cdf::BodyId;
use serde_json::Value;

use super::{Heard, Talk, world::pass_over};
use crate::{DialogError, page, robots::Robot, wizard::Decision};

/// How often the thread that answers what is held back sees whether it is to end.
const LOOKS_EVERY: Duration = Duration::from_millis(100);

impl Talk {
    /// A wizard decides what is answered: the robot of a body, or else the one that holds something back. Gives why it cannot be.
    pub fn decide(&self, body: Option<BodyId>, decision: Decision) -> Result<Result<(), String>, DialogError> {
        let now_nanos = monotonic_nanos();
        let mut inner = self.lock();
        inner.look()?;
        let holds = |robot: &&Robot| robot.conversation.proposal(now_nanos).is_some();
        let meant = inner.robots.iter().find(holds).or_else(|| inner.robots.iter().next()).map(|robot| robot.body);
        let Some(body) = body.or(meant) else { return Ok(Err("There is no robot.".to_owned())) };
        let Some(robot) = inner.robots.of_body(body) else { return Ok(Err("There is no such robot.".to_owned())) };
        match robot.conversation.decide(decision, now_nanos, &robot.knowledge) {
            Ok(reactions) => self.carry_out(&mut inner, body, Heard::Nothing, reactions).map(Ok),
            Err(problem) => Ok(Err(problem)),
        }
    }

    /// What the robots hold back, for a wizard's page.
    pub fn proposals(&self) -> Vec<Value> {
        let now_nanos = monotonic_nanos();
        let inner = self.lock();
        inner.robots.iter().map(|robot| proposed(robot, now_nanos)).collect()
    }

    /// The session is over: notes what was held back and never answered.
    pub fn close(&self) -> Result<(), DialogError> {
        let mut inner = self.lock();
        let left: Vec<_> = inner.robots.iter().flat_map(|robot| robot.conversation.left_undecided()).collect();
        left.iter().try_for_each(|message| inner.publish(message))
    }

    /// Answers what is held back when its time has come, until `over`.
    pub fn keep_time(&self, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        while !over() {
            if self.alarm.wait(LOOKS_EVERY) {
                pass_over(self.elapse())?;
            }
        }
        Ok(())
    }

    fn elapse(&self) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.look()?;
        let now_nanos = monotonic_nanos();
        for body in inner.robots.iter().map(|robot| robot.body).collect::<Vec<_>>() {
            let Some(robot) = inner.robots.of_body(body) else { continue };
            let reactions = robot.conversation.elapse(now_nanos, &robot.knowledge);
            if !reactions.is_empty() {
                self.carry_out(&mut inner, body, Heard::Nothing, reactions)?;
            }
        }
        self.alarm.set(inner.due());
        Ok(())
    }
}

/// What a robot holds back, for wizards.
pub(super) fn proposed(robot: &Robot, now_nanos: u64) -> Value {
    page::proposal(robot.body.0, robot.conversation.proposal(now_nanos).as_ref())
}

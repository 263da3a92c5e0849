//! All that a conversation knows, behind its lock.

use std::collections::BTreeMap;

use cohabit_bus::{
    Inbox, Publisher, Sample,
    message::{DialogKind, DialogMessage, StateView},
    monotonic_nanos,
};
use cohabit_cdf::BodyId;

use crate::{
    DialogError, conversation,
    drafts::Thought,
    journal::Journal,
    latency::{Latency, Moments},
    page::Line,
    robots::{Robot, Robots, Visitor},
};

pub(super) struct Inner {
    pub(super) robots: Robots,
    pub(super) journal: Journal,
    pub(super) latency: Latency,
    pub(super) dialog: Box<dyn Publisher>,
    pub(super) states: Inbox,
    pub(super) newest: Option<Sample>,
    /// The body that was spoken to last.
    pub(super) spoken_to: BodyId,
    /// The tick at which those who wait for something looked last.
    pub(super) woke_at: u64,
    /// The visitors who are there, and how many pages each has open.
    pub(super) present: BTreeMap<u32, usize>,
    /// How many wizards' pages are open.
    pub(super) wizards: usize,
}

impl Inner {
    /// Whom a visitor speaks to, and what is said to them.
    pub(super) fn addressed(
        &mut self,
        said: &str,
        visitor: Visitor,
        nanos: u64,
    ) -> Result<(Vec<BodyId>, String), DialogError> {
        self.look()?;
        let state = self.newest.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?;
        Ok(self.robots.addressed(said, visitor, state, nanos))
    }

    /// What would be understood of what a visitor says.
    pub(super) fn thoughts(&mut self, said: &str, visitor: Visitor) -> Result<Vec<Thought>, DialogError> {
        self.look()?;
        let state = self.newest.as_ref().map(|sample| StateView::new(sample.payload())).transpose()?;
        Ok(self.robots.thoughts(said, visitor, state, monotonic_nanos()))
    }

    /// Has the robot of a body know who speaks to it.
    pub(super) fn listen_to(&mut self, visitor: Visitor, body: BodyId) -> Result<(), DialogError> {
        self.spoken_to = body;
        let Some(sample) = &self.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        if let Some(robot) = self.robots.of_body(body) {
            robot.knowledge.note_speaker(visitor.body, state);
        }
        Ok(())
    }

    /// What is asked of which the answers are numbered.
    pub(super) fn numbered(&self) -> Option<&conversation::Asked> {
        self.robots.asking()?.conversation.asked().filter(|asked| asked.candidates.len() > 1)
    }

    /// When something that is held back is answered without anybody's doing.
    pub(super) fn due(&self) -> Option<u64> {
        let now_nanos = monotonic_nanos();
        self.robots.iter().filter_map(|robot| robot.conversation.due(now_nanos)).min()
    }

    pub(super) fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, ())) = self.states.next(|sample| StateView::new(sample.payload()).map(drop))? {
            self.newest = Some(sample);
        }
        Ok(())
    }

    /// Has the robot look at the world as it is now.
    pub(super) fn look(&mut self) -> Result<(), DialogError> {
        self.refresh()?;
        let Self { newest, robots, journal, .. } = self;
        for robot in robots.iter_mut() {
            if let Some(sample) = newest {
                robot.knowledge.look(StateView::new(sample.payload())?, sample.envelope().tick);
            }
            if let Some(lessons) = robot.knowledge.take_lessons() {
                journal.note_lessons(robot.body.0, lessons);
            }
        }
        Ok(())
    }

    /// The same, if it is time.
    pub(super) fn look_by_and_by(&mut self) -> Result<(), DialogError> {
        let Some(sample) = &self.newest else { return Ok(()) };
        let state = StateView::new(sample.payload())?;
        let tick = sample.envelope().tick;
        let is_due = |robot: &Robot| {
            let body = state.bodies.iter().find(|record| record.body == robot.body.0);
            body.is_some_and(|body| robot.knowledge.is_due(tick, body.position_m, body.yaw_rad))
        };
        if self.robots.iter().any(is_due) {
            self.look()?;
        }
        Ok(())
    }

    /// Tells the bus what a service that was killed may not have told, and the plan under way: an agent that joins later
    /// would not know of it.
    pub(super) fn tell_again(&mut self) -> Result<(), DialogError> {
        let untold = &self.journal.past().untold;
        let is_its = |robot: &Robot, line: &Line| line.body.is_none_or(|body| body == robot.body.0);
        let mut messages = Vec::new();
        for robot in self.robots.iter() {
            let lines = untold.iter().filter(|line| is_its(robot, line));
            messages.extend(lines.filter_map(|line| robot.conversation.message(line)));
            messages.extend(robot.conversation.plan_under_way());
        }
        messages.iter().try_for_each(|message| self.publish(message))?;
        self.journal.told();
        Ok(())
    }

    pub(super) fn publish_latency(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let mut message = DialogMessage::new(DialogKind::Latency, self.spoken_to.0, moments.turn, "");
        message.header.stamps = moments.stamps();
        self.publish(&message)
    }

    pub(super) fn publish_spoken(&mut self, moments: &Moments) -> Result<(), DialogError> {
        let heard = self.latency.heard.clone();
        let mut message = DialogMessage::new(DialogKind::Spoken, self.spoken_to.0, moments.turn, &heard);
        message.header.stamps = moments.spoken_stamps();
        self.publish(&message)
    }

    pub(super) fn publish_pointed(&mut self, name: &str, visitor: u32) -> Result<(), DialogError> {
        let mut message = DialogMessage::new(DialogKind::Pointed, self.spoken_to.0, 0, name);
        message.header.person = visitor;
        self.publish(&message)
    }

    pub(super) fn publish(&mut self, message: &DialogMessage) -> Result<(), DialogError> {
        self.dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
        Ok(())
    }
}

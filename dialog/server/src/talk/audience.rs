//! What questionnaires and ears ask of a conversation.

use cohabit_bus::message::StateView;
use cohabit_speech::Scene;

use super::Talk;
use crate::{robots::Visitor, survey::Register, voice::Audience};

/// What is said for whoever says stop aloud, in whatever words.
const STOP: &str = "stop";

impl Register for Talk {
    fn has_answered(&self, visitor: u32, questionnaire: &str) -> bool {
        let inner = self.lock();
        inner.journal.past().answered.get(&visitor).is_some_and(|answered| answered.contains(questionnaire))
    }

    fn note_answered(&self, visitor: u32, questionnaire: &str) {
        self.lock().journal.note_answered(visitor, questionnaire);
    }

    fn is_mission_running(&self) -> bool {
        let inner = self.lock();
        let state = inner.newest.as_ref().and_then(|sample| StateView::new(sample.payload()).ok());
        // What has no goals does not end.
        state.is_none_or(|state| state.header.ending == 0 && state.header.goals > 0)
    }
}

impl Audience for Talk {
    fn is_whole(&self, text: &str) -> bool {
        let inner = self.lock();
        let text = inner.robots.called(text);
        let robot = inner.robots.look_at(inner.spoken_to).or_else(|| inner.robots.iter().next());
        let is_whole = robot.is_some_and(|robot| robot.conversation.is_whole(&text, &robot.knowledge));
        if is_whole {
            self.drafts.leave(Visitor::default(), &text);
        }
        is_whole
    }

    fn is_at_work(&self) -> bool {
        let inner = self.lock();
        let Some(state) = inner.newest.as_ref().and_then(|sample| StateView::new(sample.payload()).ok()) else {
            return false;
        };
        inner.robots.iter().any(|robot| state.bodies.iter().any(|body| body.body == robot.body.0 && body.busy == 1))
    }

    fn likely(&self, before: u64) -> Option<(u64, Scene)> {
        let inner = self.lock();
        let robot = inner.robots.iter().next()?;
        let number = robot.knowledge.number();
        if number == before {
            return None;
        }
        let names = robot.conversation.language().spoken_names(robot.knowledge.world()?);
        drop(inner);
        let [things, places, rooms] =
            [names.things, names.places, names.rooms].map(|names| names.into_iter().collect());
        Some((number, Scene { things, places, rooms, words: self.names.clone(), known: names.words }))
    }

    fn stop(&self, visitor: u32, heard_nanos: u64) {
        if let Err(error) = self.hear(STOP, Visitor { number: visitor, body: None }, heard_nanos) {
            tracing::error!("{error}");
        }
    }
}

//! What questionnaires and ears ask of a conversation.

use cohabit_speech::Scene;

use super::{Said, Talk, Utterance, mailbox::Message};
use crate::{robots::Visitor, survey::Register, voice::Audience};

/// What is said for whoever says stop aloud, in whatever words.
const STOP: &str = "stop";

impl Register for Talk {
    fn has_answered(&self, visitor: u32, questionnaire: &str) -> bool {
        let delivery = self.delivery();
        delivery.journal.past().answered.get(&visitor).is_some_and(|answered| answered.contains(questionnaire))
    }

    fn note_answered(&self, visitor: u32, questionnaire: &str) {
        self.delivery().journal.note_answered(visitor, questionnaire);
    }

    fn is_mission_running(&self) -> bool {
        let newest = self.state();
        let state = newest.view().ok().flatten();
        // What has no goals does not end.
        state.is_none_or(|state| state.header.ending == 0 && state.header.goals > 0)
    }
}

impl Audience for Talk {
    fn is_whole(&self, text: &str) -> bool {
        self.mailbox.ask(|to| Message::IsWhole(text.to_owned(), to)).unwrap_or(false)
    }

    fn is_at_work(&self) -> bool {
        let newest = self.state();
        let Some(state) = newest.view().ok().flatten() else { return false };
        self.robots.iter().any(|robot| state.bodies.iter().any(|body| body.body == robot.0 && body.busy == 1))
    }

    fn likely(&self, before: u64) -> Option<(u64, Scene)> {
        self.mailbox.ask(|to| Message::Likely(before, to)).flatten()
    }

    fn stop(&self, visitor: u32, heard_nanos: u64) {
        let said = Said::Text { text: STOP.to_owned(), received_nanos: heard_nanos };
        let visitor = Visitor { number: visitor, body: None };
        self.voice.hush();
        self.mailbox.leave_in_time(Message::Utterance(Utterance { visitor, said, page: None }));
    }
}

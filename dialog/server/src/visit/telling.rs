//! What a page tells the robots, and for whom.

use cohabit_cdf::{BodyId, ObjectId};

use super::Visit;
use crate::{
    robots::Visitor,
    talk::{Said, Utterance},
    text,
};

impl Visit {
    pub(super) fn say(&self, text: &str, received_nanos: u64) -> Result<(), String> {
        let text = text::in_one_line(text.trim());
        if text.is_empty() {
            return Ok(());
        }
        if !text::is_within_limit(&text) {
            return Err(format!("That is too long for me. {}", text::too_long(&text)));
        }
        self.tell_robot(Said::Text { text, received_nanos })
    }

    /// Chooses an object; `is_answer`, if that counts only where a robot asks something that it answers.
    pub(super) fn choose(&self, object: ObjectId, received_nanos: u64, is_answer: bool) -> Result<(), String> {
        self.tell_robot(Said::Choice { object, received_nanos, is_answer })
    }

    pub(super) fn visitor(&self) -> Visitor {
        let driven = self.driver.as_ref().filter(|driver| driver.is_driving());
        Visitor { number: self.visitor.number, body: driven.map(|driver| BodyId(driver.body())) }
    }

    /// What comes of it comes by the page's ear, or by the hub.
    pub(super) fn tell_robot(&self, said: Said) -> Result<(), String> {
        let page = Some(self.ear.0.clone());
        self.live.talk.hear(Utterance { visitor: self.visitor(), said, page })
    }
}

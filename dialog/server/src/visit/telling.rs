//! What a page tells the robots, and for whom.

use std::sync::Arc;

use cohabit_cdf::{BodyId, ObjectId};

use super::Visit;
use crate::{DialogError, robots::Visitor, talk::Talk, text};

impl Visit {
    pub(super) async fn say(&mut self, text: &str, received_nanos: u64) -> Result<(), String> {
        let text = text::in_one_line(text.trim());
        if text.is_empty() {
            return Ok(());
        }
        if !text::is_within_limit(&text) {
            return Err(format!("That is too long for me. {}", text::too_long(&text)));
        }
        let visitor = self.visitor();
        self.tell_robot(move |talk| talk.hear(&text, visitor, received_nanos)).await
    }

    pub(super) async fn choose(&mut self, object: ObjectId, received_nanos: u64) -> Result<(), String> {
        let visitor = self.visitor();
        self.tell_robot(move |talk| talk.choose(object, visitor, received_nanos)).await
    }

    pub(super) fn visitor(&self) -> Visitor {
        let driven = self.driver.as_ref().filter(|driver| driver.is_driving());
        Visitor { number: self.visitor.number, body: driven.map(|driver| BodyId(driver.body())) }
    }

    async fn tell_robot(
        &mut self,
        tell: impl FnOnce(&Talk) -> Result<(), DialogError> + Send + 'static,
    ) -> Result<(), String> {
        let talk = Arc::clone(&self.live.talk);
        if let Ok(Err(error)) = tokio::task::spawn_blocking(move || tell(&talk)).await {
            tracing::error!("{error}");
            return Err("The robot cannot be reached.".to_owned());
        }
        Ok(())
    }
}

//! Whether a page is still there: it is pinged, and is gone when it answers nothing for long.

use std::time::Instant;

use axum::extract::ws::Message;
use tokio::time::{Interval, MissedTickBehavior, interval};

use crate::limits::ServerLimits;

/// What is known of a page's presence.
pub struct Presence {
    pings: Interval,
    limits: ServerLimits,
    /// Since when it has been asked without a word from it.
    asked_at: Option<Instant>,
}

impl Presence {
    /// Of a page that has just come.
    pub fn new(limits: ServerLimits) -> Self {
        let mut pings = interval(limits.ping_every);
        pings.set_missed_tick_behavior(MissedTickBehavior::Delay);
        Self { pings, limits, asked_at: None }
    }

    /// Waits until it is to be asked again.
    pub async fn wait(&mut self) {
        self.pings.tick().await;
    }

    /// Something came from the page.
    pub const fn note_word(&mut self) {
        self.asked_at = None;
    }

    /// What to ask it with; `None`, if it is gone.
    pub fn ask(&mut self) -> Option<Message> {
        let asked_at = self.asked_at.get_or_insert_with(Instant::now);
        (asked_at.elapsed() <= self.limits.silence).then(|| Message::Ping(Vec::new().into()))
    }
}

//! What a log lacks.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Entry, is_zero};

/// What nobody took down in time: the recorder was away, or its disk slow, for longer than the bus keeps messages.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub struct GapEntry {
    /// The newest tick when that was noticed.
    pub tick: u64,
    /// Ticks that are missing before it.
    pub ticks: u64,
    /// Events that are missing.
    pub events: u64,
    /// Dialog messages that are missing.
    pub dialog: u64,
    /// Answers to questionnaires that are missing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub answers: u64,
}

impl GapEntry {
    /// Messages missing in all.
    #[must_use]
    pub const fn messages(&self) -> u64 {
        self.ticks.saturating_add(self.events).saturating_add(self.dialog).saturating_add(self.answers)
    }
}

impl fmt::Display for GapEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, ticks, events, dialog, answers } = self;
        write!(
            f,
            "{ticks} ticks, {events} events, {dialog} dialog messages and {answers} answers before tick {tick} "
        )?;
        f.write_str("are missing: its recorder was away, or its disk slow, for too long")
    }
}

impl Entry for GapEntry {
    const TOPIC: &'static str = "/gaps";
    const SCHEMA: &'static str = r#"{"title":"Gap","type":"object","properties":{"tick":{"type":"integer"},"ticks":{"type":"integer"},"events":{"type":"integer"},"dialog":{"type":"integer"},"answers":{"type":"integer"}}}"#;
}

//! What happened in the world.

use cohabit_bus::{
    Envelope,
    message::{EventKind, EventMessage, NONE},
};
use cohabit_cdf::Status;
use serde::{Deserialize, Serialize};

use super::{Entry, is_zero, run};

/// Something that happened.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct EventEntry {
    /// When.
    pub tick: u64,
    /// What kind of event.
    pub kind: String,
    /// The body concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<u32>,
    /// The command concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<u64>,
    /// The dialog turn concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<u64>,
    /// The goal concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<i64>,
    /// The object concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// An outcome's status.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// A sentence for people.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of events, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

impl EventEntry {
    /// The entry of an event as published; `None` if it is of no known kind.
    #[must_use]
    pub fn new(envelope: &Envelope, message: &EventMessage) -> Option<Self> {
        let kind = message.kind()?;
        let goal = matches!(kind, EventKind::GoalMet | EventKind::GoalReset).then_some(message.number);
        let status = if kind == EventKind::Outcome { message.status() } else { None };
        let present = |value: u32| (value != NONE).then_some(value);
        Some(Self {
            tick: envelope.tick,
            kind: format!("{kind:?}"),
            body: present(message.body),
            command: (message.command != 0).then_some(message.command),
            turn: (message.turn != 0).then_some(message.turn),
            goal,
            object: present(message.object),
            status,
            text: message.text.as_str().to_owned(),
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for EventEntry {
    const TOPIC: &'static str = "/events";
    const SCHEMA: &'static str = r#"{"title":"Event","type":"object","properties":{"tick":{"type":"integer"},"kind":{"type":"string"},"body":{"type":"integer"},"command":{"type":"integer"},"turn":{"type":"integer"},"goal":{"type":"integer"},"object":{"type":"integer"},"status":{"type":"string"},"text":{"type":"string"},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

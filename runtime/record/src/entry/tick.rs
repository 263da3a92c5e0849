//! What a tick took in, and what came of it.

use cohabit_bus::message::{CommandMessage, TickView};
use cohabit_cdf::Action;
use serde::{Deserialize, Serialize};

use super::{Entry, hex};

/// One tick: what went in, and the digest of what came out.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TickEntry {
    /// Its number.
    pub tick: u64,
    /// The digest of the simulated state after it, in hexadecimal: 16 digits for each part of the state.
    pub digest: String,
    /// Wall time of its start, ns since 1970: the time of the message that holds the entry.
    #[serde(default, skip_serializing)]
    pub wall_nanos: u64,
    /// What it took in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputEntry>,
}

/// One input.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct InputEntry {
    /// The command's number.
    pub command: u64,
    /// The dialog turn it belongs to; 0 is none.
    pub turn: u64,
    /// Which body.
    pub body: u32,
    /// What to do.
    pub action: Action,
}

impl TickEntry {
    /// The entry of a tick as published.
    #[must_use]
    pub fn new(tick: u64, view: TickView<'_>) -> Self {
        let inputs = view.inputs.iter().filter_map(InputEntry::new).collect();
        Self { tick, digest: hex(&view.header.digest), wall_nanos: view.header.wall_nanos, inputs }
    }
}

impl InputEntry {
    /// The entry of a command; `None` if its action is malformed (no world took it then).
    #[must_use]
    pub fn new(message: &CommandMessage) -> Option<Self> {
        let action = Action::try_from(message.action).ok()?;
        Some(Self { command: message.command, turn: message.turn, body: message.body, action })
    }
}

impl Entry for TickEntry {
    const TOPIC: &'static str = "/ticks";
    const SCHEMA: &'static str = r#"{"title":"Tick","type":"object","properties":{"tick":{"type":"integer"},"digest":{"type":"string"},"inputs":{"type":"array","items":{"type":"object"}}}}"#;
}

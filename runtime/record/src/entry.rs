//! What a log holds, as JSON messages of MCAP channels.

use cohabit_bus::{
    Envelope,
    message::{CommandMessage, DialogView, EventMessage, MissionMessage, TickView},
};
use cohabit_cdf::{Action, BodyRequest, Status};
use serde::{Deserialize, Serialize};

/// The kinds of entries, each on its own channel.
pub(crate) trait Entry: Serialize + for<'de> Deserialize<'de> {
    /// The channel's topic.
    const TOPIC: &'static str;
    /// The JSON Schema of the entries, for other tools.
    const SCHEMA: &'static str;
}

/// What was played, once at the beginning.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SessionEntry {
    /// Counts changes of this format.
    pub format: u32,
    /// The version of the program that wrote it.
    pub program: String,
    /// The session's name.
    pub session: String,
    /// The mission file's name.
    pub mission_file: String,
    /// The mission file's text.
    pub mission_text: String,
    /// The seed of all that was random.
    pub seed: u64,
    /// Bodies beside those of the mission.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyRequest>,
    /// The simulator's run, unlike that of any other; 0 where there was none.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
}

impl SessionEntry {
    /// The format this build writes.
    pub const FORMAT: u32 = 1;

    /// The entry of a mission as a simulator published it.
    #[must_use]
    pub fn new(session: &str, mission: &MissionMessage) -> Self {
        Self {
            format: Self::FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            session: session.to_owned(),
            mission_file: mission.header.file.as_str().to_owned(),
            mission_text: mission.text.clone(),
            seed: mission.header.seed,
            bodies: mission.bodies.clone(),
            run: 0,
        }
    }
}

impl Entry for SessionEntry {
    const TOPIC: &'static str = "/session";
    const SCHEMA: &'static str = r#"{"title":"Session","type":"object","properties":{"format":{"type":"integer"},"program":{"type":"string"},"session":{"type":"string"},"mission_file":{"type":"string"},"mission_text":{"type":"string"},"seed":{"type":"integer"},"bodies":{"type":"array","items":{"type":"object"}},"run":{"type":"string"}}}"#;
}

/// One tick: what went in, and the digest of what came out.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TickEntry {
    /// Its number.
    pub tick: u64,
    /// BLAKE3 of the simulated state after it, in hexadecimal.
    pub digest: String,
    /// Wall time of its start, ns since 1970.
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

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
const fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// A run's number, in hexadecimal: it has more bits than numbers of JSON hold exactly.
mod run {
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
    pub fn serialize<S: Serializer>(run: &u64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{run:x}"))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
        let text = std::borrow::Cow::<str>::deserialize(deserializer)?;
        u64::from_str_radix(&text, 16).map_err(D::Error::custom)
    }
}

/// A digest as a log writes it.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

impl Entry for TickEntry {
    const TOPIC: &'static str = "/ticks";
    const SCHEMA: &'static str = r#"{"title":"Tick","type":"object","properties":{"tick":{"type":"integer"},"digest":{"type":"string"},"wall_nanos":{"type":"integer"},"inputs":{"type":"array","items":{"type":"object"}}}}"#;
}

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
        use cohabit_bus::message::{EventKind, NONE};
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

/// Something that was said, planned or done about a turn.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct DialogEntry {
    /// What kind of dialog message.
    pub kind: String,
    /// The turn; 0 is none.
    pub turn: u64,
    /// The body spoken to, or speaking.
    pub body: u32,
    /// Which step of the turn's plan.
    pub step: u32,
    /// How the step went.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// When it was sent, ns of the machine's monotonic clock.
    pub sent_nanos: u64,
    /// Received, understood, first motion, first changed frame: ns of the same clock, 0 where it did not happen.
    pub stamps: [u64; 4],
    /// What was said.
    pub text: String,
    /// A plan's steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Action>,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of dialog messages, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

impl DialogEntry {
    /// The entry of a dialog message as published; `None` if it is of no known kind.
    #[must_use]
    pub fn new(envelope: &Envelope, view: DialogView<'_>) -> Option<Self> {
        let kind = view.header.kind()?;
        Some(Self {
            kind: format!("{kind:?}"),
            turn: view.header.turn,
            body: view.header.body,
            step: view.header.step,
            status: view.header.status(),
            sent_nanos: envelope.sent_nanos,
            stamps: view.header.stamps,
            text: view.header.text.as_str().to_owned(),
            steps: view.steps.iter().filter_map(|step| Action::try_from(step.action).ok()).collect(),
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for DialogEntry {
    const TOPIC: &'static str = "/dialog";
    const SCHEMA: &'static str = r#"{"title":"Dialog","type":"object","properties":{"kind":{"type":"string"},"turn":{"type":"integer"},"body":{"type":"integer"},"step":{"type":"integer"},"status":{"type":"string"},"sent_nanos":{"type":"integer"},"stamps":{"type":"array","items":{"type":"integer"}},"text":{"type":"string"},"steps":{"type":"array","items":{"type":"object"}},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

//! What was said, planned and done about a turn.

use cohabit_bus::{
    Envelope,
    message::{DialogKind, DialogView, PlanStep},
};
use cohabit_cdf::{Action, Status};
use serde::{Deserialize, Deserializer, Serialize};

use super::{Entry, is_zero, run};

/// Something that was said, planned or done about a turn.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct DialogEntry {
    /// The newest tick that was recorded before it.
    #[serde(default)]
    pub tick: u64,
    /// What kind of dialog message.
    pub kind: String,
    /// The turn; 0 is none.
    pub turn: u64,
    /// The body spoken to, or speaking.
    pub body: u32,
    /// The number of the page at which a person said it; 0 where none did.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub person: u32,
    /// Which step of the turn's plan.
    pub step: u32,
    /// How the step went.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// When it was sent, ns of the machine's monotonic clock.
    pub sent_nanos: u64,
    /// Received, understood, first motion, first changed frame, that frame shown by a page: ns of the same clock, 0
    /// where it did not happen (yet). A turn's last entry knows most.
    #[serde(deserialize_with = "stamps")]
    pub stamps: [u64; 5],
    /// What was said.
    pub text: String,
    /// A plan's steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Action>,
    /// The answers that a question offers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub offers: Vec<OfferEntry>,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of dialog messages, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

/// An answer that a question offers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct OfferEntry {
    /// What it says.
    pub text: String,
    /// The object that it means, if it means one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
}

impl OfferEntry {
    fn new(offer: &PlanStep) -> Self {
        let object = match Action::try_from(offer.action) {
            Ok(Action::Highlight { object }) => Some(object.0),
            _ => None,
        };
        Self { text: offer.says.as_str().to_owned(), object }
    }
}

impl DialogEntry {
    /// The entry of a dialog message as published when `tick` was the newest; `None` if it is of no known kind.
    #[must_use]
    pub fn new(tick: u64, envelope: &Envelope, view: DialogView<'_>) -> Option<Self> {
        let kind = view.header.kind()?;
        let asks = kind == DialogKind::Question;
        let action = |step: &PlanStep| Action::try_from(step.action).ok();
        Some(Self {
            tick,
            kind: format!("{kind:?}"),
            turn: view.header.turn,
            body: view.header.body,
            person: view.header.person,
            step: view.header.step,
            status: view.header.status(),
            sent_nanos: envelope.sent_nanos,
            stamps: view.header.stamps,
            text: view.header.text.as_str().to_owned(),
            steps: if asks { Vec::new() } else { view.steps.iter().filter_map(action).collect() },
            offers: if asks { view.steps.iter().map(OfferEntry::new).collect() } else { Vec::new() },
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for DialogEntry {
    const TOPIC: &'static str = "/dialog";
    const SCHEMA: &'static str = r#"{"title":"Dialog","type":"object","properties":{"tick":{"type":"integer"},"kind":{"type":"string"},"turn":{"type":"integer"},"body":{"type":"integer"},"person":{"type":"integer"},"step":{"type":"integer"},"status":{"type":"string"},"sent_nanos":{"type":"integer"},"stamps":{"type":"array","items":{"type":"integer"}},"text":{"type":"string"},"steps":{"type":"array","items":{"type":["object","string"]}},"offers":{"type":"array","items":{"type":"object"}},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

/// Format 1 had four, and not when the frame was shown.
fn stamps<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[u64; 5], D::Error> {
    let found = Vec::<u64>::deserialize(deserializer)?;
    Ok(std::array::from_fn(|index| found.get(index).copied().unwrap_or(0)))
}

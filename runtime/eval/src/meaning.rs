//! What a person wants done, one thing at a time: the expert's plan of a mission.

use cohabit_cdf::{Color, RoomId};
use serde::{Deserialize, Serialize};

/// One thing that is wanted. Objects are instance ids.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "want", rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names of the fields say all")]
pub enum Meaning {
    /// Be in a room.
    GoTo { room: RoomId },
    /// Hold something.
    PickUp { object: String },
    /// Have something on or in something else.
    Place { object: String, receptacle: String },
    /// Have a part in the machine that needs it.
    Insert { object: String, device: String },
    /// Have a machine on.
    TurnOn { device: String },
    /// Have something scanned.
    Scan { object: String },
    /// Have something broken.
    Break { object: String },
    /// Have something clean.
    Clean { object: String },
    /// Have something full of water.
    Fill { object: String },
    /// Have what is in one thing in the other.
    Pour { from: String, into: String },
    /// Have something hot.
    Heat { object: String },
    /// Have something cold.
    Cool { object: String },
    /// Have something whole again.
    Repair { object: String },
    /// Have something in another colour.
    Color { object: String, color: Color },
}

impl Meaning {
    /// The object that it is about.
    #[must_use]
    pub fn object(&self) -> Option<&str> {
        match self {
            Self::GoTo { .. } => None,
            Self::TurnOn { device } => Some(device),
            Self::Pour { from, .. } => Some(from),
            Self::PickUp { object }
            | Self::Place { object, .. }
            | Self::Insert { object, .. }
            | Self::Scan { object }
            | Self::Break { object }
            | Self::Clean { object }
            | Self::Fill { object }
            | Self::Heat { object }
            | Self::Cool { object }
            | Self::Repair { object }
            | Self::Color { object, .. } => Some(object),
        }
    }

    /// The other object that it needs.
    #[must_use]
    pub fn target(&self) -> Option<&str> {
        match self {
            Self::Place { receptacle, .. } => Some(receptacle),
            Self::Insert { device, .. } => Some(device),
            Self::Pour { into, .. } => Some(into),
            _ => None,
        }
    }
}

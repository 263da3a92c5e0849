//! Kinds of buildings, and the rooms that each may have.

use std::{fmt, str::FromStr};

use cohabit_cdf::{RoomEntry, RoomId};
use serde::Deserialize;

/// A kind of building.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    /// Desks, meeting rooms, labs.
    Office,
    /// Living room, bedrooms, kitchen.
    Home,
}

/// There is no such kind of building.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("there is no kind of floor plan `{0}`: write `office` or `home`")]
pub struct UnknownKind(String);

impl Kind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Office, Self::Home];

    /// As people write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::Home => "home",
        }
    }

    /// The rooms that it may have.
    pub(crate) fn rooms(self) -> RoomTable {
        let text = match self {
            Self::Office => include_str!("../data/office.toml"),
            Self::Home => include_str!("../data/home.toml"),
        };
        toml::from_str(text).expect("invariant: the tables of rooms parse")
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kind {
    type Err = UnknownKind;

    fn from_str(text: &str) -> Result<Self, UnknownKind> {
        Self::ALL.into_iter().find(|kind| kind.name() == text).ok_or_else(|| UnknownKind(text.to_owned()))
    }
}

/// The rooms of a kind of building.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RoomTable {
    #[serde(rename = "room")]
    pub rooms: Vec<RoomType>,
    pub hallway: Hallway,
    pub entrance: Entrance,
}

/// A type of room.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RoomType {
    pub id: RoomId,
    /// Plans with that many rooms have it for certain.
    #[serde(default)]
    pub from: Option<usize>,
    #[serde(default)]
    pub weight: f32,
    pub area_m2: [f32; 2],
    pub least_m: f32,
    #[serde(default)]
    pub through: bool,
    #[serde(default)]
    pub openness: f64,
    pub floors: Vec<(String, String)>,
    pub walls: Vec<String>,
    /// What people read, for a room that is not built in.
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    words: Vec<String>,
    #[serde(default)]
    color: Option<String>,
}

impl RoomType {
    /// What a world pack says of it; nothing, if it is built in.
    pub fn entry(&self) -> Option<RoomEntry> {
        Some(RoomEntry {
            id: self.id,
            name: self.name.clone()?,
            words: self.words.clone(),
            kind: Vec::new(),
            color: self.color.clone(),
            corridor: false,
            secured: false,
        })
    }

    /// Its shortest side, dm.
    pub fn least(&self) -> i32 {
        (self.least_m * 10.0).round() as i32
    }
}

/// The hallway of a kind of building.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hallway {
    pub floors: Vec<(String, String)>,
    pub walls: Vec<String>,
    pub width_m: [f32; 2],
}

/// Where people come in.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Entrance {
    /// The class of the door, which nobody opens.
    pub class: String,
    /// The rooms that may have it, the best first.
    pub rooms: Vec<RoomId>,
}

impl Hallway {
    /// How likely a passage leads from the hallway to a room, beside what the room says.
    pub(crate) const OPENNESS: f64 = 0.5;
}

//! Kinds of buildings, and the rooms that each may have.

use std::{fmt, str::FromStr, sync::Arc};

use cohabit_cdf::{Catalog, RoomEntry, RoomId, WorldData, WorldPack, world_pack::builtin_files};
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

    /// The world pack, of those that come with the program, whose rooms and classes the plans have: a world with such plans has it too.
    #[must_use]
    pub const fn pack(self) -> Option<&'static str> {
        match self {
            Self::Office => None,
            Self::Home => Some("homes"),
        }
    }

    /// The rooms that it may have.
    pub(crate) fn rooms(self) -> RoomTable {
        let text = match self {
            Self::Office => include_str!("../data/office/rooms.toml"),
            Self::Home => include_str!("../data/home/rooms.toml"),
        };
        toml::from_str(text).expect("invariant: the tables of rooms parse")
    }

    /// The classes and rooms of a world with its plans, without the plans and missions of its pack.
    pub(crate) fn catalog(self) -> Arc<Catalog> {
        let Some(name) = self.pack() else { return Arc::new(Catalog::builtin()) };
        let mut files = builtin_files(name).expect("invariant: the pack comes with the program");
        files.retain(|file| !file.path.starts_with("layouts/") && !file.path.starts_with("missions/"));
        let pack = WorldPack::parse(name, files).expect("invariant: a pack that comes with the program is sound");
        let world = WorldData::layered(vec![pack]).expect("invariant: a pack that comes with the program is sound");
        Arc::clone(world.catalog())
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
    pub window: Window,
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
    /// What people read, for a room that is neither built in nor of the kind's pack.
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    words: Vec<String>,
    #[serde(default)]
    color: Option<String>,
}

impl RoomType {
    /// What a world pack of plans says of it; nothing, if it is there without.
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

/// Windows of a kind of building.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Window {
    /// The narrowest and the widest.
    pub width_m: [f32; 2],
}

impl Window {
    /// The narrowest and the widest, dm.
    pub fn width(self) -> [i32; 2] {
        self.width_m.map(|width_m| (width_m * 10.0).round() as i32)
    }
}

impl Hallway {
    /// How likely a passage leads from the hallway to a room, beside what the room says.
    pub(crate) const OPENNESS: f64 = 0.5;
}

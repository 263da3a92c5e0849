//! What world packs add to a catalogue beside classes and devices: floor plans, names of rooms, and which packs they are.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Catalog;
use crate::room::RoomId;

/// A world pack, as logs and messages name it.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct PackId {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// The BLAKE3 hash of all its files, in hexadecimal.
    pub digest: String,
}

impl fmt::Display for PackId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {} with hash {}", self.name, self.version, self.digest)
    }
}

/// What people call a room.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct RoomNames {
    /// The room's id in floor plans and missions, such as `SmallOffice`.
    pub id: String,
    /// What people read, in lower case.
    pub name: String,
    /// What people say; the name need not be repeated.
    #[serde(default)]
    pub words: Vec<String>,
}

/// All that packs add beside classes and devices.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layer {
    pub packs: Vec<PackId>,
    /// `(file name, text)` of floor plans.
    pub plans: Vec<(String, String)>,
    pub rooms: Vec<RoomNames>,
}

impl Catalog {
    pub(crate) fn with_layer(self, layer: Layer) -> Self {
        Self { layer, ..self }
    }

    /// The world packs that it has, in their order; none, if all of it is built in.
    #[must_use]
    pub fn packs(&self) -> &[PackId] {
        &self.layer.packs
    }

    /// `(file name, text)` of the packs' floor plans.
    pub(crate) fn plans(&self) -> impl Iterator<Item = (&str, &str)> {
        self.layer.plans.iter().map(|(file, text)| (file.as_str(), text.as_str()))
    }

    /// The rooms that packs name.
    #[must_use]
    pub fn named_rooms(&self) -> &[RoomNames] {
        &self.layer.rooms
    }

    /// What packs call the room with this id, if they name it.
    #[must_use]
    pub fn room_names(&self, id: &str) -> Option<&RoomNames> {
        self.layer.rooms.iter().find(|room| room.id == id)
    }
}

impl RoomId {
    /// What people call it in this world: its name, or the one that a world pack gives it.
    #[must_use]
    pub fn name_in(self, catalog: &Catalog) -> &str {
        catalog.room_names(self.id()).map_or(self.name(), |names| names.name.as_str())
    }
}

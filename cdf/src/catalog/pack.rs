//! What world packs add to a catalogue beside classes and devices: floor plans, rooms, and which packs they are.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::Catalog;
use crate::room::Rooms;

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

/// How people speak in a world: to whose words a robot's understanding of it is fitted.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Speech {
    /// As people at work do.
    #[default]
    Office,
    /// As people at home do.
    Household,
}

/// Which packs there are, their floor plans, and how people speak in their world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layer {
    pub packs: Vec<PackId>,
    pub speech: Speech,
    /// `(file name, text)` of floor plans.
    pub plans: Vec<(String, String)>,
}

impl Catalog {
    pub(crate) fn with_layer(self, rooms: Rooms, layer: Layer) -> Self {
        Self { rooms, layer, ..self }
    }

    /// The world packs that it has, in their order; none, if all of it is built in.
    #[must_use]
    pub fn packs(&self) -> &[PackId] {
        &self.layer.packs
    }

    /// How people speak in this world: as the last pack that says so has it.
    #[must_use]
    pub const fn speech(&self) -> Speech {
        self.layer.speech
    }

    /// `(file name, text)` of the packs' floor plans.
    pub(crate) fn plans(&self) -> impl Iterator<Item = (&str, &str)> {
        self.layer.plans.iter().map(|(file, text)| (file.as_str(), text.as_str()))
    }
}

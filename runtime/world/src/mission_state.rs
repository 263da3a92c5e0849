//! What changes in a world because of its mission: how far its goals have come, where its portals lead, which dinosaurs
//! were fed, and what is not there yet.

use cohabit_cdf::mission::{DinoFood, Era};
use serde::{Deserialize, Serialize};

use crate::{entity::Support, geometry::Pose};

/// How far a mission's goal has come.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) struct GoalProgress {
    pub met: bool,
    /// Whether a hidden goal was unlocked.
    pub shown: bool,
}

/// One time that a generator leads to.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Way {
    /// Its name in the mission.
    pub name: String,
    pub era: Era,
}

/// The times that a generator leads to; never empty.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Gate {
    pub ways: Vec<Way>,
    /// The one it leads to now, or as soon as it is opened.
    pub current: usize,
}

/// A dinosaur, and whether it was fed.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Dinosaur {
    /// What it eats: all that can be eaten, if nothing is said.
    pub food: Option<DinoFood>,
    pub fed: bool,
}

impl Gate {
    /// Where it leads.
    pub fn way(&self) -> &Way {
        &self.ways[self.current]
    }

    /// From now on it leads to the next time.
    pub fn turn(&mut self) {
        self.current = (self.current + 1) % self.ways.len();
    }
}

/// An object that is not there yet: where it will be, and from when.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Away {
    pub support: Support,
    pub pose: Pose,
    pub until: Until,
}

/// What something that is away waits for.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Until {
    /// The portal of that name opens.
    Portal(String),
    /// The condition of the mission's request with that index holds.
    Condition(usize),
    /// What it is in comes.
    Carrier,
}

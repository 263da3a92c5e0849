//! Draws that were not taken.

use serde::{Deserialize, Serialize};

/// Draws that were not taken, by the reason.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub struct Dropped {
    /// Fewer things were to be seen than asked for.
    pub few_things: u32,
    /// It looked like an image before it.
    pub near_duplicates: u32,
    /// What was drawn had no place, or no camera saw it.
    pub unplaceable: u32,
}

impl Dropped {
    /// Both together.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            few_things: self.few_things + other.few_things,
            near_duplicates: self.near_duplicates + other.near_duplicates,
            unplaceable: self.unplaceable + other.unplaceable,
        }
    }
}

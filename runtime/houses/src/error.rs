//! Why a house is refused.

use cohabit_cdf::world_pack::NAME_RULE;

use crate::MOST_BYTES;

/// Why a house is refused.
#[derive(Debug, thiserror::Error)]
pub enum HouseError {
    /// Its text is too long.
    #[error("{bytes} bytes: a house has at most {MOST_BYTES}; write many houses as JSON lines")]
    TooLarge {
        /// How long it is.
        bytes: usize,
    },
    /// It is not JSON.
    #[error("it is no JSON: {source}")]
    Json {
        /// Where and what.
        source: serde_json::Error,
    },
    /// Something in it cannot be.
    #[error("{at}: {reason}: {remedy}")]
    Content {
        /// JSON pointer.
        at: String,
        /// What is wrong.
        reason: String,
        /// What would be right.
        remedy: String,
    },
    /// Its floor plan has faults.
    #[error("the floor plan has faults: {}", .faults.join("; "))]
    Faults {
        /// What the check of floor plans says.
        faults: Vec<String>,
    },
    /// A pack, or the prefix of its floor plans, has no such name.
    #[error("`{name}` is no name of a world pack: {NAME_RULE}")]
    Name {
        /// What was asked for.
        name: String,
    },
    /// Floor plans are not called so.
    #[error("`{prefix}` cannot begin the ids of floor plans: write 1 to 24 letters, digits, `-` and `_`")]
    Prefix {
        /// What was asked for.
        prefix: String,
    },
    /// The rooms of all houses are too many for a world.
    #[error("its rooms would be the {rooms}th of one world, which has {most} at most: import fewer houses into a pack")]
    TooManyRooms {
        /// All of them.
        rooms: usize,
        /// What a world may have.
        most: usize,
    },
}

impl HouseError {
    /// What is wrong at a JSON pointer; the house itself, if that is empty.
    pub(crate) fn at(at: &str, reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        let at = if at.is_empty() { "the house" } else { at };
        Self::Content { at: at.to_owned(), reason: reason.into(), remedy: remedy.into() }
    }
}

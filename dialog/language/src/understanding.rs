//! What came of an utterance.

use cohabit_cdf::{Action, ObjectId};
use serde::{Deserialize, Serialize};

/// What the robot makes of what it was told.
#[derive(Clone, Debug, PartialEq)]
pub enum Understanding {
    /// It will do this.
    Plan {
        /// In this order; the robot walks to each object by itself.
        steps: Vec<Step>,
        /// What it says first.
        reply: String,
    },
    /// It must know something first.
    Question {
        /// What it asks.
        text: String,
        /// The objects that are in question, to be outlined; none when it asks for a yes.
        candidates: Vec<ObjectId>,
    },
    /// It was asked, and answers.
    Answer {
        /// What it says.
        text: String,
        /// What it speaks about, to be outlined.
        highlight: Vec<ObjectId>,
    },
    /// It did not understand, or cannot.
    Refusal {
        /// What it says.
        text: String,
    },
    /// It stops at once.
    Stop {
        /// What it says.
        reply: String,
    },
}

impl Understanding {
    pub(crate) fn refusal(text: impl Into<String>) -> Self {
        Self::Refusal { text: text.into() }
    }

    pub(crate) fn answer(text: impl Into<String>) -> Self {
        Self::Answer { text: text.into(), highlight: Vec::new() }
    }
}

/// One action of a plan.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Step {
    /// What to do.
    pub action: Action,
    /// What it says while it does it: `opening the fridge`.
    pub says: String,
}

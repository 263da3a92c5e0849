//! What an object is wanted for, and why none was found.

use cohabit_cdf::{ClassId, ObjectId, Property};

use crate::words::intent::Intent;

/// What the object is wanted for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Want<'a> {
    pub(crate) intent: Intent,
    pub(crate) affordances: &'a [Property],
    /// The only classes that will do, if any is among the candidates.
    pub(crate) classes: &'a [ClassId],
    pub(crate) exclude: Option<ObjectId>,
    /// Whether what is held is meant first.
    pub(crate) held_first: bool,
    /// Of a place that something is to be put: what it is taken from.
    pub(crate) origin: Option<ObjectId>,
}

impl<'a> Want<'a> {
    pub(crate) fn object(intent: Intent) -> Self {
        Self {
            intent,
            affordances: intent.affordances(),
            classes: &[],
            exclude: None,
            held_first: intent.is_about_held(),
            origin: None,
        }
    }

    pub(crate) fn place(intent: Intent, affordances: &'a [Property], exclude: Option<ObjectId>) -> Self {
        Self { intent, affordances, classes: &[], exclude, held_first: false, origin: None }
    }
}

/// Why no object was found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Miss {
    /// Nobody knows where such a thing is.
    Unseen,
    /// There are such things, but none as described.
    Mismatch(Vec<ObjectId>),
    /// Several, which can be told apart; or one that is too doubtful to act on.
    Several(Vec<ObjectId>),
    /// A pronoun, and nothing was spoken of.
    NoReferent,
    /// The words are not known.
    Unknown,
    /// There is one, but the robot has hardly looked about the room that it is in: people may mean another.
    Hasty,
}

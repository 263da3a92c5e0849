//! What came of an utterance.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Verb};
use serde::{Deserialize, Serialize};

use crate::{
    setting::named_in_a_word,
    words::{intent::Intent, prose},
};

/// What the robot makes of what it was told.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
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
        /// What kind of answer it needs.
        kind: Clarification,
        /// What it asks about, as people called it: `red mug`; empty where it asks about no object.
        about: String,
        /// What it asks.
        text: String,
        /// The objects that are in question, to be outlined.
        candidates: Vec<ObjectId>,
        /// Short answers that may be offered; of a reference, one for each candidate, in their order.
        options: Vec<String>,
    },
    /// It was asked, and answers.
    Answer {
        /// What it says.
        text: String,
        /// What it speaks about, to be outlined.
        highlight: Vec<ObjectId>,
        /// Whether what was asked is so; nothing, where that was not asked.
        holds: Option<bool>,
    },
    /// It did not understand, or cannot.
    Refusal {
        /// What it says.
        text: String,
        /// Whether it did not understand: in other words it might.
        is_lost: bool,
    },
    /// It stops at once.
    Stop {
        /// What it says.
        reply: String,
        /// What else was asked of it, once it has stopped.
        then: Option<Box<Self>>,
    },
}

impl Understanding {
    pub(crate) fn refusal(text: impl Into<String>) -> Self {
        Self::Refusal { text: text.into(), is_lost: false }
    }

    pub(crate) fn lost(text: impl Into<String>) -> Self {
        Self::Refusal { text: text.into(), is_lost: true }
    }

    pub(crate) fn answer(text: impl Into<String>) -> Self {
        Self::Answer { text: text.into(), highlight: Vec::new(), holds: None }
    }

    /// An answer about these things that says no more than how they are.
    pub(crate) fn about(text: impl Into<String>, highlight: Vec<ObjectId>) -> Self {
        Self::Answer { text: text.into(), highlight, holds: None }
    }

    /// An answer that says whether something is so.
    pub(crate) fn whether(holds: bool, text: impl Into<String>, highlight: Vec<ObjectId>) -> Self {
        Self::Answer { text: text.into(), highlight, holds: Some(holds) }
    }

    /// The same, said after something else.
    pub(crate) fn after(self, said: &str) -> Self {
        self.saying(|text| format!("{said} {text}"))
    }

    /// The same, with something else said after it.
    pub(crate) fn before(self, said: &str) -> Self {
        self.saying(|text| format!("{text} {said}"))
    }

    /// The same to a question that wants no yes or no.
    pub(crate) fn without_yes(self) -> Self {
        self.saying(prose::without_yes)
    }

    /// The same with another reply.
    fn saying(mut self, other: impl FnOnce(&str) -> String) -> Self {
        let (Self::Plan { reply: text, .. }
        | Self::Question { text, .. }
        | Self::Answer { text, .. }
        | Self::Refusal { text, .. }
        | Self::Stop { reply: text, .. }) = &mut self;
        *text = other(text);
        self
    }

    /// Whether nothing was made of what was said.
    pub(crate) const fn is_lost(&self) -> bool {
        matches!(self, Self::Refusal { is_lost: true, .. })
    }

    /// What it says.
    #[must_use]
    pub fn reply(&self) -> &str {
        match self {
            Self::Plan { reply: text, .. }
            | Self::Question { text, .. }
            | Self::Answer { text, .. }
            | Self::Refusal { text, .. }
            | Self::Stop { reply: text, .. } => text,
        }
    }

    /// The same answer with a yes or a no before it, where that was asked and it has none.
    pub(crate) fn with_yes_or_no(self, is_asked: bool) -> Self {
        match self {
            Self::Answer { text, highlight, holds: Some(holds) } if is_asked => {
                let has_one = text.starts_with("Yes") || text.starts_with("No");
                let start = if holds { "Yes" } else { "No" };
                let text = if has_one { text } else { format!("{start}, {}", prose::within_sentence(&text)) };
                Self::Answer { text, highlight, holds: Some(holds) }
            }
            other => other,
        }
    }
}

/// A way to take an utterance.
#[derive(Clone, Debug, PartialEq)]
pub struct Alternative {
    /// The words that are read: those that were said, or the plain requests that the rewriter makes of them.
    pub text: String,
    /// Whether it is what the grammar makes of the words that were said.
    pub by_grammar: bool,
    /// What it would mean.
    pub understanding: Understanding,
    /// How likely it is the one that is meant, from 0 to 1. Those of the rewriter are weighed among each other, so these and that of the
    /// grammar need not add up to 1.
    pub probability: f32,
}

/// Kinds of questions the robot asks: the four of Alexa Arena (location, appearance, direction, reference), a
/// confirmation, and what is to be done at all.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clarification {
    /// Where is it?
    Location,
    /// What does it look like?
    Appearance,
    /// Which direction?
    Direction,
    /// Which one, or which room, is meant?
    Reference,
    /// Shall it be done: what cannot be undone, what may help, what was only guessed?
    Confirmation,
    /// What shall be done?
    Request,
}

impl Clarification {
    /// All kinds.
    pub const ALL: [Self; 6] =
        [Self::Location, Self::Appearance, Self::Direction, Self::Reference, Self::Confirmation, Self::Request];

    /// In one word, as in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Location => "location",
            Self::Appearance => "appearance",
            Self::Direction => "direction",
            Self::Reference => "reference",
            Self::Confirmation => "confirmation",
            Self::Request => "request",
        }
    }
}

/// When the robot asks: a setting of a session.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Asking {
    /// It takes its best guess, and refuses where it has none.
    Never,
    /// Where a mistake is expected to cost more than a question.
    #[default]
    Unsure,
    /// Whenever there is a choice, and before it does anything.
    Always,
}

named_in_a_word!(Asking: Never = "never", Unsure = "unsure", Always = "always");

/// How much work goes into what people say.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Effort {
    /// That of the grammar alone: what is said plainly, in a millisecond.
    Fast,
    /// Also that of the rewriter, of what the grammar does not read to the last word: some tenths of a second more.
    #[default]
    Full,
}

named_in_a_word!(Effort: Fast = "fast", Full = "full");

impl Step {
    /// The object that it is about.
    pub(crate) const fn object(&self) -> Option<ObjectId> {
        match self.action {
            Action::PickUp { object }
            | Action::Place { receptacle: object }
            | Action::PlaceBeside { receptacle: object, .. }
            | Action::Interact { object, .. }
            | Action::Highlight { object }
            | Action::GoTo { target: GoToTarget::Object(object) } => Some(object),
            _ => None,
        }
    }

    /// What it does that its action calls otherwise: to iron is to clean with an iron.
    pub(crate) fn by_hand(&self) -> Option<Intent> {
        Intent::BY_HAND.into_iter().find(|by_hand| self.says.starts_with(by_hand.doing()))
    }

    /// Whether it does more than look and point.
    pub(crate) const fn commits(&self) -> bool {
        let moves = matches!(self.action, Action::GoTo { .. } | Action::Move { .. } | Action::Rotate { .. });
        self.changes() || moves || matches!(self.action, Action::PickUp { .. })
    }

    /// Whether something else than the robot and its hand is another after it.
    pub(crate) const fn changes(&self) -> bool {
        matches!(self.action, Action::Interact { .. } | Action::Place { .. } | Action::PlaceBeside { .. })
    }

    /// Whether what it changes is not simply put back.
    pub(crate) const fn is_lasting(&self) -> bool {
        let Action::Interact { verb, .. } = self.action else { return false };
        !matches!(verb, Verb::Open | Verb::Close | Verb::Examine | Verb::Scan)
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

//! What a conversation wants done.

use cohabit_bus::message::DialogMessage;
use cohabit_language::Unclear;
use serde_json::Value;

use crate::{expression::FacialExpression, page::Line};

/// What the conversation wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum Reaction {
    /// To the bus.
    Bus(Box<DialogMessage>),
    /// To the chat of all pages.
    Chat(Line),
    /// To all pages, not kept.
    Page(Value),
    /// To all pages: what the robot's face shows from now on.
    Expresses(FacialExpression),
    /// To an interpreter: what is not understood in this turn.
    Interpret(u64, Box<Unclear>),
    /// To wizards: what is held back has changed.
    Proposes,
    /// To wizards alone: what the robot would say of what they ordered.
    ForWizard(String),
    /// What was held back is answered now, by what follows.
    Answers {
        /// The number of the plan that answers it.
        turn: u64,
        /// When it was said, ns of the monotonic clock.
        received_nanos: u64,
    },
    /// The turn is over: show the state as it is, then say so.
    TurnEnded {
        /// Which.
        turn: u64,
        /// How.
        end: TurnEnd,
    },
}

/// How a turn ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum TurnEnd {
    /// The robot did all that was asked.
    Done,
    /// The robot answered.
    Answered,
    /// The robot asks, and waits for an answer.
    Asked,
    /// A step failed.
    Failed,
    /// The robot did not understand, or will not.
    Refused,
    /// Something else was asked for meanwhile.
    Interrupted,
}

impl Reaction {
    /// The line of chat, if it is one.
    pub const fn line(&self) -> Option<&Line> {
        match self {
            Self::Chat(line) => Some(line),
            _ => None,
        }
    }
}

impl TurnEnd {
    /// In one word, for the page and for reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Answered => "answered",
            Self::Asked => "asked",
            Self::Failed => "failed",
            Self::Refused => "refused",
            Self::Interrupted => "interrupted",
        }
    }

    /// Whether it is what the person wanted.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::Done | Self::Answered)
    }
}

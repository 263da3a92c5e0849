//! All that a conversation lets happen.

use cohabit_bus::{
    Text,
    message::{DialogKind, DialogMessage, PlanStep},
};
use cohabit_language::{Step, Unclear};

use crate::{
    expression::FacialExpression,
    page::{Answer, Line, LineKind, Speaker},
};

/// Something that a conversation lets happen. What follows from one message happens in the order in which it is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Outgoing {
    /// What somebody said to the robot: to the bus, and to the pages if it is not shown there already.
    Utterance {
        /// The line.
        line: Line,
        /// Whether it is shown.
        is_shown: bool,
    },
    /// The robot says something: to the bus, to the pages and aloud.
    Say(Line),
    /// The robot asks something, in the same ways.
    Ask(Line),
    /// What the robot does: to its mind, by the bus.
    Plan {
        /// The plan's number.
        number: u64,
        /// Its steps.
        steps: Vec<Step>,
    },
    /// How far a plan is: to the pages, kept for those that come before its turn is over.
    Progress {
        /// The turn that it is for.
        turn: u64,
        /// The step that begins, from 0.
        step: u32,
        /// How many there are.
        steps: usize,
        /// The step in words.
        says: String,
    },
    /// What the robot's face shows from now on: to the bus and to the pages.
    Express {
        /// The turn in which it shows it.
        turn: u64,
        /// What.
        shown: FacialExpression,
    },
    /// A note for the log: to the bus.
    Note {
        /// What is noted.
        kind: DialogKind,
        /// The turn that it is about.
        turn: u64,
        /// What.
        text: String,
    },
    /// To an interpreter: what is not understood.
    Interpret {
        /// In this turn.
        turn: u64,
        /// What, and what helps.
        unclear: Box<Unclear>,
    },
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

impl Outgoing {
    /// What somebody said in a turn.
    pub(super) fn utterance(turn: u64, text: &str) -> Self {
        Self::Utterance { line: Line::new(Speaker::Person, LineKind::Say, turn, text), is_shown: true }
    }

    /// The line of chat that the pages show of it, if they do.
    #[must_use]
    pub const fn line(&self) -> Option<&Line> {
        match self {
            Self::Utterance { line, is_shown: true } | Self::Say(line) | Self::Ask(line) => Some(line),
            _ => None,
        }
    }

    /// What the bus is told of it, of the robot of a body.
    #[must_use]
    pub fn message(&self, body: u32) -> Option<DialogMessage> {
        match self {
            Self::Utterance { line, .. } | Self::Say(line) | Self::Ask(line) => line_message(line, body),
            Self::Plan { number, steps } => Some(plan_message(*number, steps, body)),
            Self::Express { turn, shown } => Some(DialogMessage::new(DialogKind::Expressed, body, *turn, shown.name())),
            Self::Note { kind, turn, text } => Some(DialogMessage::new(*kind, body, *turn, text)),
            Self::Progress { .. }
            | Self::Interpret { .. }
            | Self::Proposes
            | Self::ForWizard(_)
            | Self::Answers { .. }
            | Self::TurnEnded { .. } => None,
        }
    }
}

/// What the bus is told of a line of chat: nothing of what the game says, or a mind of its own accord.
pub(crate) fn line_message(line: &Line, body: u32) -> Option<DialogMessage> {
    let kind = match (line.from, line.kind) {
        (Speaker::Person, _) => DialogKind::Utterance,
        (Speaker::Robot, _) if line.turn == 0 => return None,
        (Speaker::Robot, LineKind::Question) => DialogKind::Question,
        (Speaker::Robot, _) => DialogKind::Reply,
        (Speaker::Game, _) => return None,
    };
    let mut message = DialogMessage::new(kind, body, line.turn, &line.text);
    message.header.person = line.visitor.unwrap_or(0);
    message.steps = line.answers.iter().map(Answer::offer).collect();
    Some(message)
}

pub(super) fn plan_message(number: u64, steps: &[Step], body: u32) -> DialogMessage {
    let mut message = DialogMessage::new(DialogKind::Plan, body, number, "");
    message.steps =
        steps.iter().map(|step| PlanStep { action: step.action.into(), says: Text::new(&step.says) }).collect();
    message
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

//! What annotators are asked, and what they write.

use serde::{Deserialize, Serialize};

/// Steps of an episode that are watched in one go.
#[derive(Clone, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
pub struct Segment {
    /// The folder of its episode, in that of the data set.
    pub episode: String,
    /// Its first step.
    pub first_step: usize,
    /// The step behind its last one; the picture before that one is the segment's last.
    pub end_step: usize,
}

/// What somebody had read when they wrote.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Reading {
    /// The annotation that it is.
    pub id: u64,
    /// Its text, as it was then.
    pub text: String,
}

/// What an annotator is asked.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Task {
    /// Write the instruction that would make a robot do this.
    Instruction {
        /// What is watched.
        segment: Segment,
    },
    /// Ask what one would ask before one went on.
    Question {
        /// Of which steps.
        segment: Segment,
        /// The step before which one stands: what is watched ends there.
        moment_step: usize,
        /// What the robot was told.
        instruction: Reading,
    },
    /// Answer a question of somebody else.
    Answer {
        /// What is watched.
        segment: Segment,
        /// What the robot was told.
        instruction: Reading,
        /// What somebody asked.
        question: Reading,
    },
}

/// A kind of task.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Kind {
    /// To write instructions.
    Instruction,
    /// To ask.
    Question,
    /// To answer.
    Answer,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Instruction, Self::Question, Self::Answer];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Instruction => "instruction",
            Self::Question => "question",
            Self::Answer => "answer",
        }
    }
}

/// What several people are asked alike, so that their texts can be compared.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Unit {
    /// The instruction for a segment.
    Instruction(Segment),
    /// A question about a segment.
    Question(Segment),
    /// The answer to the question that is this annotation.
    Answer(u64),
}

impl Unit {
    /// What kind of task it is.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Instruction(_) => Kind::Instruction,
            Self::Question(_) => Kind::Question,
            Self::Answer(_) => Kind::Answer,
        }
    }
}

impl Task {
    /// What others are asked, too.
    #[must_use]
    pub fn unit(&self) -> Unit {
        match self {
            Self::Instruction { segment } => Unit::Instruction(segment.clone()),
            Self::Question { segment, .. } => Unit::Question(segment.clone()),
            Self::Answer { question, .. } => Unit::Answer(question.id),
        }
    }

    /// What it is about.
    #[must_use]
    pub const fn segment(&self) -> &Segment {
        match self {
            Self::Instruction { segment } | Self::Question { segment, .. } | Self::Answer { segment, .. } => segment,
        }
    }

    /// The step whose picture is the last that is watched.
    #[must_use]
    pub const fn last_step(&self) -> usize {
        match self {
            Self::Instruction { segment } | Self::Answer { segment, .. } => segment.end_step,
            Self::Question { moment_step, .. } => *moment_step,
        }
    }
}

/// Why somebody wrote nothing.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// What is seen does not tell.
    CannotTell,
    /// What they had to read makes no sense.
    Unclear,
    /// The pictures are missing or broken.
    Pictures,
}

/// What came of a task.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// A text, in one line.
    Text(String),
    /// None.
    Skipped(Reason),
}

/// A line of the journal.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Annotation {
    /// Its number.
    pub id: u64,
    /// Whose it is, by pseudonym.
    pub annotator: String,
    /// What they were asked.
    pub task: Task,
    /// What they wrote.
    #[serde(flatten)]
    pub what: What,
    /// When they took the task, ms since 1970.
    pub taken_ms: u64,
    /// When they sent it, ms since 1970.
    pub at_ms: u64,
    /// The annotation that has this text from then on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub corrects: Option<u64>,
}

impl Annotation {
    /// Its text, if it has one.
    #[must_use]
    pub fn text(&self) -> Option<&str> {
        match &self.what {
            What::Text(text) => Some(text),
            What::Skipped(_) => None,
        }
    }
}

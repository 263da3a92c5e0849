//! A mission of a benchmark, and what is said in it.

use cohabit_generate::Part;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// What a mission is for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// For training; nothing of it is scored.
    Train,
    /// For choosing between agents.
    Validation,
    /// For the figures that are reported.
    Test,
}

impl Split {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Train, Self::Validation, Self::Test];
    /// Those that are played.
    pub const PLAYED: [Self; 2] = [Self::Validation, Self::Test];

    /// Its name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Validation => "validation",
            Self::Test => "test",
        }
    }
}

/// A mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Mission {
    /// Its name: the type, and its number.
    pub id: String,
    /// Its type.
    pub kind: String,
    /// What it is for.
    pub split: Split,
    /// What of it no mission for training has.
    pub part: Part,
    /// What is said in it, in order.
    pub instructions: Vec<Instruction>,
    /// The mission file (CDF).
    pub cdf: Value,
}

/// One thing that a person says.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Instruction {
    /// What.
    pub text: String,
    /// What they answer to a question about it: what they mean, with where it is as the mission begins.
    pub answer: String,
}

impl Mission {
    /// As a line of a file of missions, which `eval` and `check` read.
    #[must_use]
    pub fn as_line(&self) -> Value {
        let said = |part: fn(&Instruction) -> &str| self.instructions.iter().map(part).collect::<Vec<_>>();
        json!({
            "id": self.id,
            "type": self.kind,
            "split": self.split.name(),
            "part": self.part.name(),
            "preparation_utterances": [],
            "utterances": said(|instruction| &instruction.text),
            "answers": said(|instruction| &instruction.answer),
            "cdf": self.cdf,
        })
    }
}

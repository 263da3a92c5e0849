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
    /// The mission of such a line as [`Self::as_line`] gives.
    pub(crate) fn of_line(line: &Value) -> Option<Self> {
        let text = |key: &str| line[key].as_str().map(str::to_owned);
        let texts = |key: &str| -> Option<Vec<String>> {
            line[key].as_array()?.iter().map(|text| text.as_str().map(str::to_owned)).collect()
        };
        let (said, answers) = (texts("utterances")?, texts("answers")?);
        let named = |name: &str| Split::ALL.into_iter().find(|split| split.name() == name);
        let of_part = |name: &str| Part::ALL.into_iter().find(|part| part.name() == name);
        let instructions = said.into_iter().zip(answers).map(|(text, answer)| Instruction { text, answer });
        Some(Self {
            id: text("id")?,
            kind: text("type")?,
            split: named(line["split"].as_str()?)?,
            part: of_part(line["part"].as_str()?)?,
            instructions: instructions.collect(),
            cdf: line.get("cdf")?.clone(),
        })
    }

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

/// The digest of missions (BLAKE3, in hexadecimal).
pub(crate) fn digest(missions: &[Mission]) -> String {
    let mut hasher = blake3::Hasher::new();
    for mission in missions {
        hasher.update(format!("{}\n", mission.as_line()).as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

//! A mission and what is said in it.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::{meaning::Meaning, simulated::expert};

/// Questions about one thing that a person answers.
const MOST_ANSWERS: usize = 2;

/// A mission, and its script.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Task {
    /// Its name in the report; no two of one source are equal.
    pub id: String,
    /// What kind of task it is, if whoever made it says so.
    pub family: Option<String>,
    /// The mission's text (CDF).
    pub cdf: String,
    /// What comes before the mission counts.
    pub preparation: Vec<Line>,
    /// What is to solve it.
    pub script: Vec<Line>,
}

/// One line of a script.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Line {
    /// Something said to the robot.
    Utterance {
        /// What.
        text: String,
        /// What the person answers to questions that may come back.
        answers: Vec<Answer>,
    },
    /// Something that a person wants, to be said in their own words.
    Meant(Meaning),
    /// A command, as the reference's models emit them: `{"type": "Pickup", "pickup": {"object": {"id": "Mug_1"}}}`.
    Action(Value),
}

/// An answer that a person has ready.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Answer {
    /// To what question.
    pub question: String,
    /// What they say.
    pub text: String,
}

impl Task {
    /// The task as a line of a file of missions, in the expert's words.
    #[must_use]
    pub fn as_line(&self) -> Value {
        let said = |lines: &[Line]| lines.iter().map(ToString::to_string).collect::<Vec<_>>();
        let cdf: Value = serde_json::from_str(&self.cdf).unwrap_or_default();
        json!({
            "id": self.id,
            "preparation_utterances": said(&self.preparation),
            "utterances": said(&self.script),
            "cdf": cdf,
        })
    }
}

impl Line {
    /// Something said, to which no question is answered.
    #[must_use]
    pub fn utterance(text: &str) -> Self {
        Self::Utterance { text: text.to_owned(), answers: Vec::new() }
    }

    /// Something said by a person who answers the same, whatever is asked about it.
    #[must_use]
    pub fn answered(text: &str, answer: &str) -> Self {
        let answer = Answer { question: String::new(), text: answer.to_owned() };
        Self::Utterance { text: text.to_owned(), answers: vec![answer; MOST_ANSWERS] }
    }
}

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Utterance { text, .. } => f.write_str(text),
            Self::Meant(meaning) => f.write_str(&expert(meaning)),
            Self::Action(action) => write!(f, "{action}"),
        }
    }
}

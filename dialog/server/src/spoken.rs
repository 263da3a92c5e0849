//! What was said aloud: which of its readings is meant, and whether the robot had better ask.

use cohabit_language::{Clarification, Step, Understanding};
use cohabit_speech::{Meaning, Recognition, Sense, choose};

/// What somebody said aloud, as it was heard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spoken {
    /// What it may be.
    pub heard: Recognition,
    /// The reading that they were shown or wrote instead, if they could change it.
    pub settled: Option<Reading>,
    /// When it began, when it ended, and when its text was there, ns.
    pub began_nanos: u64,
    /// See [`Spoken::began_nanos`].
    pub ended_nanos: u64,
    /// See [`Spoken::began_nanos`].
    pub text_nanos: u64,
}

/// The reading that is meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its words.
    pub text: String,
    /// Whether the robot asks before it does it.
    pub is_doubtful: bool,
}

impl Spoken {
    /// The likeliest words; none if nobody seems to have said anything.
    pub fn first(&self) -> Option<&str> {
        let settled = self.settled.as_ref().map(|reading| reading.text.as_str());
        settled.or_else(|| Some(self.heard.best()).filter(|text| !text.is_empty()))
    }

    /// The reading that is meant, where `understand` tells what each comes to; `None` if nobody seems to have said anything.
    pub fn reading(&self, understand: impl Fn(&str) -> Understanding) -> Option<Reading> {
        let choose = || choose(&self.heard, |text| meaning(understand(text)));
        let chosen = || choose().map(|choice| Reading { text: choice.text, is_doubtful: choice.is_doubtful });
        self.settled.clone().or_else(chosen)
    }
}

/// What a reading comes to, by what the language makes of it.
#[must_use]
pub fn meaning(understanding: Understanding) -> Meaning<Vec<Step>> {
    let (sense, deed) = match understanding {
        Understanding::Plan { steps, .. } => (Sense::Clear, Some(steps)),
        Understanding::Stop { .. } | Understanding::Answer { .. } => (Sense::Clear, None),
        Understanding::Question { kind: Clarification::Appearance | Clarification::Request, .. } => {
            (Sense::Vague, None)
        }
        Understanding::Question { .. } | Understanding::Refusal { is_lost: false, .. } => (Sense::Asks, None),
        Understanding::Refusal { is_lost: true, .. } => (Sense::None, None),
    };
    Meaning { sense, deed }
}

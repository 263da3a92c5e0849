//! The alphabet of what the network writes: acts, relations, conditions, forms, and words that nobody said.

use crate::request::{Answer, Form, Inquiry, Social};

/// One letter of the alphabet.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Symbol {
    /// All requests have been written.
    End,
    Also,
    Instead,
    If,
    Unless,
    When,
    Until,
    Otherwise,
    Refrain,
    Inquire(Inquiry),
    /// How the request before is to be done.
    Manner,
    /// The description goes on elsewhere.
    Continued,
    Unknown,
    Goal,
    Tell,
    Nothing,
    Answer(Answer),
    AnswerWords,
    Social(Social),
    /// A word of a description that was not said.
    Word(String),
    Do(Form),
}

impl Symbol {
    /// Reads the name that the model has for it.
    pub(crate) fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "<eos>" => Self::End,
            "also" => Self::Also,
            "instead" => Self::Instead,
            "IF" => Self::If,
            "UNLESS" => Self::Unless,
            "WHEN" => Self::When,
            "UNTIL" => Self::Until,
            "OTHERWISE" => Self::Otherwise,
            "NOT" => Self::Refrain,
            "CAN" => Self::Inquire(Inquiry::Can),
            "HOW" => Self::Inquire(Inquiry::How),
            "DID" => Self::Inquire(Inquiry::Did),
            "WHY" => Self::Inquire(Inquiry::Why),
            "MANNER" => Self::Manner,
            "CONT" => Self::Continued,
            "UNKNOWN" => Self::Unknown,
            "GOAL" => Self::Goal,
            "TELL" => Self::Tell,
            "NONE" => Self::Nothing,
            "ANSWER" => Self::AnswerWords,
            _ => match name.split_once(':') {
                Some(("answer", answer)) => Self::Answer(answer.parse().ok()?),
                Some(("social", social)) => Self::Social(social.parse().ok()?),
                Some(("const", word)) => Self::Word(word.to_owned()),
                _ => Self::Do(name.parse().ok()?),
            },
        })
    }

    /// How many descriptions follow it.
    pub(crate) fn places(&self) -> usize {
        match self {
            Self::If | Self::Unless | Self::When | Self::Until => 1,
            Self::Manner | Self::Unknown | Self::Goal | Self::Tell | Self::AnswerWords => 1,
            Self::Do(form) => form.places(),
            _ => 0,
        }
    }

    pub(crate) const fn is_relation(&self) -> bool {
        matches!(self, Self::Also | Self::Instead)
    }

    pub(crate) const fn is_condition(&self) -> bool {
        matches!(self, Self::If | Self::Unless | Self::When | Self::Until)
    }

    /// Whether it stands before a command.
    pub(crate) const fn is_prefix(&self) -> bool {
        matches!(self, Self::Refrain | Self::Inquire(_))
    }

    pub(crate) const fn is_command(&self) -> bool {
        matches!(self, Self::Do(_) | Self::Unknown)
    }

    pub(crate) const fn is_act(&self) -> bool {
        self.is_command()
            || matches!(
                self,
                Self::Goal | Self::Tell | Self::Nothing | Self::Answer(_) | Self::AnswerWords | Self::Social(_)
            )
    }
}

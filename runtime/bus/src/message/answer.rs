//! What people answer to questionnaires.

use bytemuck::{Pod, Zeroable};

use crate::text::Text;

/// What kind of answer it is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum AnswerKind {
    /// A number on a scale.
    Scale = 1,
    /// One of several, by its number from 1.
    Choice = 2,
    /// In the person's own words.
    Words = 3,
}

/// A person's answer to one question of a questionnaire; the first to a question counts.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct AnswerMessage {
    /// The number of the person's page.
    pub person: u32,
    /// Which question, from 1.
    pub item: u32,
    /// `AnswerKind`.
    kind: u32,
    /// 1 if a high number means little of what the questionnaire measures.
    pub reversed: u32,
    /// The number that was chosen; 0 where there are words alone.
    pub value: i32,
    /// The scale's lowest number.
    pub least: i32,
    /// Its highest.
    pub most: i32,
    /// Zero.
    pub reserved: u32,
    /// The questionnaire's name.
    pub questionnaire: Text<62>,
    /// What was asked.
    pub question: Text<510>,
    /// The words, or what was chosen says.
    pub text: Text<8006>,
}

impl AnswerMessage {
    /// An answer of that kind, of which nothing more is said.
    #[must_use]
    pub fn new(kind: AnswerKind) -> Self {
        Self { kind: kind as u32, ..Self::zeroed() }
    }

    /// What it is; `None` if a peer wrote a kind that does not exist.
    #[must_use]
    pub const fn kind(&self) -> Option<AnswerKind> {
        match self.kind {
            1 => Some(AnswerKind::Scale),
            2 => Some(AnswerKind::Choice),
            3 => Some(AnswerKind::Words),
            _ => None,
        }
    }
}

//! Kinds of questions people ask the robot, and how they may be put.

use serde::{Deserialize, Serialize};

use crate::words::table::PhraseTable;

/// What a question asks for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum QuestionKind {
    Holding,
    #[serde(rename = "self")]
    Robot,
    Where,
    Abilities,
    /// What there is that it could carry.
    Carried,
    Doing,
    /// Whether it has done what it was told.
    Finished,
    Goals,
    Seeing,
    Contents,
    /// What is next to it.
    Near,
    /// What lies under it or behind it.
    Under,
    /// What is before it, which is what it aims at.
    Before,
    Color,
    Distance,
    Text,
    Look,
    Count,
    State,
    Unknown,
    /// What there is to do, and how to ask for it.
    Options,
    HowTo,
    Why,
    /// What it did.
    Done,
    /// All that it did.
    DoneSoFar,
    /// What something is for, or does.
    Purpose,
    /// Whether something is dangerous.
    Danger,
    /// What is wrong with something.
    Trouble,
    /// Whose something is.
    Owner,
    /// Who has it.
    Holder,
    /// Where something was before it was taken.
    Origin,
    /// Which of several is so: `which mug is red`.
    Which,
    /// Which things of a kind there are: `which cups are on the table`.
    OfKind,
    /// What else there is, after a list.
    Rest,
    /// What it said last.
    Said,
    /// Whether the session is recorded.
    Recording,
    Time,
    /// Who is there.
    People,
    /// Which rooms there are.
    Rooms,
    /// How many rooms there are.
    RoomCount,
}

impl QuestionKind {
    /// Whether it may be about nothing that is named.
    pub(crate) const fn stands_alone(self) -> bool {
        matches!(
            self,
            Self::Done
                | Self::DoneSoFar
                | Self::Danger
                | Self::Rest
                | Self::Said
                | Self::Recording
                | Self::Time
                | Self::People
                | Self::Rooms
                | Self::RoomCount
        )
    }
}

/// How a question may be put that its beginning alone does not tell: `what is … for`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shape {
    pub(crate) kind: QuestionKind,
    pub(crate) begins: PhraseTable<()>,
    /// How it ends, if that matters.
    #[serde(default)]
    pub(crate) ends: Vec<String>,
    /// Words any of which is in it, if that matters.
    #[serde(default)]
    pub(crate) has: PhraseTable<()>,
    /// Whether nothing more may be said.
    #[serde(default)]
    pub(crate) is_whole: bool,
}

//! All words the robot understands: its own tables, and the names of the catalogue's classes.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_cdf::{ClassId, Fluid, RoomId, state::StateFlag};
use serde::{Deserialize, Serialize};

use crate::words::{
    intent::Intent,
    lists::{Chatter, Conditions, Fillers, HintWords, TalkReply, WaitingWords, Wishes, YesNo},
    misheard::Misheard,
    question_kind::{QuestionKind, Shape},
    sound::Sounding,
    spelling::Vocabulary,
    table::PhraseTable,
};

/// A room that somebody spoke of.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct NamedRoom {
    pub(crate) id: RoomId,
    /// What it is called first of all in this world.
    pub(crate) name: String,
}

/// A class that a word may mean, and how much it means it: 1 for its name, less for words further down its list.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Naming {
    pub(crate) class: ClassId,
    pub(crate) weight: f32,
}

/// Words that join others or carry no meaning of their own: nobody takes them for others.
const SMALL_WORDS: &[&str] = &[
    "and", "to", "in", "on", "at", "of", "i", "you", "please", "with", "then", "can", "could", "would", "will",
    "should", "must", "may", "might", "be", "is", "are", "was", "has", "have", "had", "do", "does", "did", "not", "no",
    "me", "us", "there", "here", "what", "which", "who", "where", "when", "why", "how", "if", "as", "so", "but", "or",
    "for", "from", "off", "out", "by", "now", "just", "also", "again", "all", "both", "either", "neither", "go", "put",
    "take", "get", "we", "he", "she", "up", "down",
];

/// How a verb has it done, besides what it asks for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Manner {
    /// Into what was made for it.
    Insert,
    /// To nowhere that could be named.
    Shift,
    /// As it is, or where it is.
    Leave,
    /// To be rid of it.
    Away,
    /// To where it was taken from.
    Back,
    /// To where such things are kept.
    Store,
    /// In a color, said or not.
    Color,
}

/// What an adjective demands of an object's state.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum StateWord {
    Flag(StateFlag, bool),
    Filled(bool),
}

/// What a preposition says about the phrase after it.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Preposition {
    In,
    On,
    To,
    At,
    From,
    Near,
    With,
    For,
    LeftOf,
    RightOf,
}

impl Preposition {
    /// Whether it says that something is beside what is named after it, and not on or in it.
    pub(crate) const fn is_beside(self) -> bool {
        matches!(self, Self::Near | Self::LeftOf | Self::RightOf)
    }

    /// How the robot says it.
    pub(crate) const fn word(self) -> &'static str {
        match self {
            Self::In => "in",
            Self::On => "on",
            Self::To => "to",
            Self::At => "at",
            Self::From => "from",
            Self::Near => "next to",
            Self::With => "with",
            Self::For => "for",
            Self::LeftOf => "to the left of",
            Self::RightOf => "to the right of",
        }
    }
}

/// Which of several, by where they are and how large.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Side {
    Left,
    Right,
    Front,
    Behind,
    Nearest,
    Farthest,
    Biggest,
    Smallest,
    Tallest,
    Longest,
    Shortest,
    Heaviest,
    Lightest,
    Upper,
    Lower,
    Middle,
    Other,
}

/// Which way.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Direction {
    Forward,
    Backward,
    Left,
    Right,
    Around,
    Up,
    Down,
}

/// What a pronoun stands for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Pronoun {
    Thing,
    Things,
    Place,
    One,
}

/// Words that are a whole utterance, or its beginning.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Small {
    Yes,
    No,
    Neither,
    /// What is offered besides is wanted, too.
    More,
    Unsure,
    /// Look for it.
    Search,
    Any,
    /// Of several plans, the one that does most, and the one that does least.
    Longer,
    Shorter,
    Hello,
    Thanks,
    Again,
    Undo,
    /// Go on with what was stopped.
    Resume,
    /// Do what the mission wants next.
    Goal,
    Mission,
    /// Go where the person goes.
    Follow,
    /// Go there no longer.
    Unfollow,
    /// Get out of somebody's way.
    Aside,
}

/// The tables.
#[derive(Debug, Default)]
pub(crate) struct Lexicon {
    pub(crate) replace: PhraseTable<Vec<String>>,
    pub(crate) lead: PhraseTable<()>,
    pub(crate) trail: PhraseTable<()>,
    pub(crate) articles: PhraseTable<()>,
    pub(crate) adjectives: PhraseTable<()>,
    /// Words for a size, and the measure by which others of its kind are less so.
    pub(crate) sizes: PhraseTable<Side>,
    pub(crate) all: PhraseTable<()>,
    /// Any one of several.
    pub(crate) one_of: PhraseTable<()>,
    pub(crate) link: PhraseTable<()>,
    pub(crate) here: PhraseTable<()>,
    /// Parts of rooms that are no things.
    pub(crate) nooks: PhraseTable<()>,
    pub(crate) degrees: PhraseTable<()>,
    pub(crate) viewpoints: PhraseTable<()>,
    pub(crate) negation: PhraseTable<()>,
    /// Openers, fillers and oaths.
    pub(crate) talk: PhraseTable<()>,
    pub(crate) answer_lead: PhraseTable<()>,
    /// Nouns for anything.
    pub(crate) generic: PhraseTable<()>,
    pub(crate) people: PhraseTable<()>,
    pub(crate) goal_words: PhraseTable<()>,
    pub(crate) text_words: PhraseTable<()>,
    pub(crate) control_words: PhraseTable<()>,
    pub(crate) hand_words: PhraseTable<()>,
    pub(crate) motion_spare: PhraseTable<()>,
    pub(crate) reports: PhraseTable<()>,
    /// Before or after what was meant, where another thing was taken.
    pub(crate) corrections: PhraseTable<()>,
    /// After a denial, before what was meant.
    pub(crate) instead: PhraseTable<()>,
    /// After what is done to a door by who goes out by it.
    pub(crate) exits: PhraseTable<()>,
    /// Before what is to be done if what was asked about is so, or if it is not.
    pub(crate) conditions: PhraseTable<()>,
    /// `show me`, before `how many mugs there are`.
    pub(crate) tells: PhraseTable<()>,
    pub(crate) undone: PhraseTable<()>,
    /// Before or after a request that is carried out before those that were said before it.
    pub(crate) beforehand: PhraseTable<()>,
    pub(crate) titles: PhraseTable<()>,
    pub(crate) pronouns: PhraseTable<Pronoun>,
    pub(crate) prepositions: PhraseTable<Preposition>,
    pub(crate) sides: PhraseTable<Side>,
    pub(crate) ordinals: PhraseTable<i32>,
    pub(crate) directions: PhraseTable<Direction>,
    pub(crate) units: PhraseTable<f32>,
    /// Parts of a turn, in degrees.
    pub(crate) turns: PhraseTable<f32>,
    pub(crate) numbers: PhraseTable<f32>,
    pub(crate) colors: PhraseTable<String>,
    pub(crate) states: PhraseTable<StateWord>,
    /// Words for a state, and the verb that brings it about.
    pub(crate) brings_about: PhraseTable<Vec<String>>,
    pub(crate) fluids: PhraseTable<Fluid>,
    pub(crate) rooms: PhraseTable<RoomId>,
    /// What people call several rooms of which they mean one.
    pub(crate) room_kinds: PhraseTable<Vec<RoomId>>,
    pub(crate) rooms_of_kinds: BTreeSet<RoomId>,
    /// What each room is called first of all.
    pub(crate) room_names: BTreeMap<RoomId, String>,
    /// Rooms by their ids, in lower case.
    pub(crate) room_ids: BTreeMap<String, RoomId>,
    pub(crate) small: PhraseTable<BTreeSet<Small>>,
    pub(crate) verbs: PhraseTable<Vec<Intent>>,
    /// Those that are said of one kind of things alone, as the tables of the world name kinds.
    pub(crate) verbs_of_kinds: PhraseTable<Vec<(Intent, String)>>,
    /// The first words of all verbs.
    pub(crate) verb_heads: BTreeSet<String>,
    /// Those that say no more than that something is to be changed or destroyed: nobody is taken to have meant one by another word.
    pub(crate) risky_verbs: BTreeSet<String>,
    pub(crate) manners: PhraseTable<Manner>,
    /// First words of a verb whose last word may stand after the object; that word; the intent.
    pub(crate) separable: Vec<(Vec<String>, String, Intent)>,
    pub(crate) questions: PhraseTable<QuestionKind>,
    /// Questions by more than their beginning, the first that fits counts.
    pub(crate) question_shapes: Vec<Shape>,
    /// Replies to what asks for nothing to be done.
    pub(crate) chat: PhraseTable<String>,
    /// Replies to what asks for nothing to be done, by what kind of talk it is.
    pub(crate) talk_replies: BTreeMap<String, TalkReply>,
    pub(crate) classes: PhraseTable<Vec<Naming>>,
    /// Single words of names of several words: `trash` for the trash can.
    pub(crate) name_parts: PhraseTable<Vec<Naming>>,
    /// Words for kinds of things.
    pub(crate) kinds: BTreeSet<String>,
    /// What can be picked up.
    pub(crate) carried: BTreeSet<ClassId>,
    /// Furniture that things stand on, and no machine.
    pub(crate) furniture: BTreeSet<ClassId>,
    /// All words that name a class, by its index.
    pub(crate) class_words: Vec<BTreeSet<String>>,
    pub(crate) vocabulary: Vocabulary,
    /// All words of the vocabulary, for who hears them.
    pub(crate) known: Arc<BTreeSet<String>>,
    pub(crate) wishes: Wishes,
    pub(crate) fillers: Fillers,
    pub(crate) chatter: Chatter,
    pub(crate) ifs: Conditions,
    pub(crate) waiting: WaitingWords,
    pub(crate) hints: HintWords,
    pub(crate) yes_no: YesNo,
    /// How the words sound that may be taken for others.
    pub(crate) sounds: Sounding,
    pub(crate) misheard: Misheard,
}

impl Lexicon {
    /// The room, with what it is called first of all.
    pub(crate) fn named_room(&self, id: RoomId) -> NamedRoom {
        NamedRoom { id, name: self.room_names.get(&id).cloned().unwrap_or_default() }
    }

    /// Whether it only joins other words, and nobody mistakes it.
    pub(crate) fn is_small_word(&self, word: &str) -> bool {
        let word = [word.to_owned()];
        self.articles.exact(&word).is_some()
            || self.pronouns.exact(&word).is_some()
            || SMALL_WORDS.contains(&word[0].as_str())
    }

    /// Whether it is a word of the name of a thing.
    pub(crate) fn is_noun(&self, word: &str) -> bool {
        let word = [word.to_owned()];
        self.classes.exact(&word).is_some() || self.name_parts.exact(&word).is_some()
    }
}

//! What a rewriting was made of: what was said, and before, as names of things, rooms and states.

use std::collections::BTreeSet;

use cohabit_cdf::{ClassId, RoomId};

use crate::{
    answer::claim::asked_either,
    read::whether,
    talk::condition,
    words::{
        lexicon::{Lexicon, StateWord},
        token,
    },
};

/// What says that a question is about this room; the first is how a plain one says so.
pub(crate) const HERE: [&str; 3] = ["in this room", "in here", "around here"];
/// Within so many words after `if` its `not` is said.
const CLAUSE: usize = 6;

/// What a rewriting was made of: what was said, and before.
pub(crate) struct Source {
    pub(crate) words: BTreeSet<String>,
    /// The words that were said now.
    pub(crate) said: BTreeSet<String>,
    /// Each two words that stood beside each other before.
    pub(crate) pairs: BTreeSet<[String; 2]>,
    /// The same of what is around the robot.
    pub(crate) pairs_around: BTreeSet<[String; 2]>,
    /// Whether a condition was denied: `if it is not`.
    pub(crate) is_denied: bool,
    /// Whether anything was.
    pub(crate) has_denial: bool,
    /// Whether all that was said asks how things are: `is the bowl clean?`.
    pub(crate) only_asks: bool,
    /// Whether a condition was told.
    pub(crate) has_condition: bool,
    /// The two states of which one was asked for, and the words for them: `open or shut`.
    pub(crate) either: Option<([StateWord; 2], String)>,
    /// Whether it is about this room.
    pub(crate) is_here: bool,
    /// The rooms that were named, now or before, and now.
    pub(crate) rooms: Vec<RoomId>,
    pub(crate) rooms_said: Vec<RoomId>,
    /// What names things among the words that were said now, and which classes it may mean.
    pub(crate) things: Vec<(String, BTreeSet<ClassId>)>,
    /// Each two things that were said now with `and` or `or` between them, and that word.
    pub(crate) joined: Vec<[String; 3]>,
    /// Those before which a colour was said, with it.
    pub(crate) colored: Vec<Colored>,
    /// The classes that anything may mean that was said, now or before.
    pub(crate) spoken: BTreeSet<ClassId>,
    /// The same of what is around.
    pub(crate) around: BTreeSet<ClassId>,
}

/// A thing of which the colour was said, and which classes the words for it may mean.
pub(crate) struct Colored {
    pub(crate) color: String,
    pub(crate) thing: String,
    pub(crate) classes: BTreeSet<ClassId>,
}

impl Source {
    pub(crate) fn new(lexicon: &Lexicon, said: &[String], lines: &[(bool, String)], around: &str) -> Self {
        let before: Vec<Vec<String>> = lines.iter().map(|(_, line)| lexicon.normalise(line).0).collect();
        let around_words = token::words(around);
        let things = things(lexicon, said);
        let earlier = before.iter().flat_map(|words| things_of(lexicon, words));
        Self {
            spoken: things.iter().flat_map(|(_, classes)| classes.iter().copied()).chain(earlier).collect(),
            around: things_of(lexicon, &around_words).collect(),
            things,
            colored: colored(lexicon, said),
            pairs: before.iter().flat_map(|line| pairs(line)).collect(),
            pairs_around: pairs(&around_words).collect(),
            said: said.iter().cloned().collect(),
            joined: joined(lexicon, said),
            is_denied: denies_condition(lexicon, said),
            only_asks: only_asks(lexicon, said),
            has_condition: condition::has_condition(lexicon, said),
            either: either(lexicon, said),
            rooms: before.iter().map(Vec::as_slice).chain([said]).flat_map(|words| rooms(lexicon, words)).collect(),
            rooms_said: rooms(lexicon, said),
            is_here: HERE.iter().any(|here| format!(" {} ", said.join(" ")).contains(&format!(" {here} "))),
            has_denial: said.iter().any(|word| lexicon.ifs.negations.contains(word)),
            words: said.iter().cloned().chain(before.into_iter().flatten()).collect(),
        }
    }
}

/// What names things among words, and which classes it may mean.
pub(crate) fn things(lexicon: &Lexicon, words: &[String]) -> Vec<(String, BTreeSet<ClassId>)> {
    let (mut things, mut at) = (Vec::new(), 0);
    while at < words.len() {
        let Some((length, namings)) = lexicon.classes.longest(&words[at..]) else {
            at += 1;
            continue;
        };
        things.push((words[at..at + length].join(" "), namings.iter().map(|naming| naming.class).collect()));
        at += length;
    }
    things
}

/// What a colour stands before that is no part of its name.
fn colored(lexicon: &Lexicon, words: &[String]) -> Vec<Colored> {
    let thing_at = |at: usize| {
        let (length, color) = lexicon.colors.longest(&words[at..])?;
        let noun = &words[at + length..];
        let (end, namings) = lexicon.classes.longest(noun)?;
        let thing = words[at..at + length + end].join(" ");
        let classes = namings.iter().map(|naming| naming.class).collect();
        (name_length(lexicon, &words[at..]) == 0).then(|| Colored { color: color.clone(), thing, classes })
    };
    (0..words.len()).filter_map(thing_at).collect()
}

pub(crate) fn things_of(lexicon: &Lexicon, words: &[String]) -> impl Iterator<Item = ClassId> {
    things(lexicon, words).into_iter().flat_map(|(_, classes)| classes)
}

/// Each two things with `and` or `or` between them, and that word.
fn joined(lexicon: &Lexicon, words: &[String]) -> Vec<[String; 3]> {
    let pair = |at: usize| {
        let length = name_length(lexicon, &words[at..]);
        let joint = words.get(at + length).filter(|word| length > 0 && matches!(word.as_str(), "and" | "or"))?;
        let start = at + length + 1;
        let article = lexicon.articles.longest(&words[start..]).map_or(0, |(length, ())| length);
        let other = name_length(lexicon, &words[start + article..]);
        let second = &words[start + article..start + article + other];
        (other > 0).then(|| [words[at..at + length].join(" "), joint.clone(), second.join(" ")])
    };
    (0..words.len()).filter_map(pair).collect()
}

/// The rooms that words name.
pub(crate) fn rooms(lexicon: &Lexicon, words: &[String]) -> Vec<RoomId> {
    (0..words.len()).filter_map(|at| lexicon.rooms.longest(&words[at..]).map(|(_, room)| *room)).collect()
}

/// Each two words that stand beside each other.
pub(crate) fn pairs(words: &[String]) -> impl Iterator<Item = [String; 2]> {
    words.windows(2).map(|pair| [pair[0].clone(), pair[1].clone()])
}

/// How many words name the thing that words begin with.
pub(crate) fn name_length(lexicon: &Lexicon, words: &[String]) -> usize {
    lexicon.classes.longest(words).map_or(0, |(length, _)| length)
}

/// Whether every sentence wants a yes or a no, and requests nothing.
fn only_asks(lexicon: &Lexicon, words: &[String]) -> bool {
    let mut sentences =
        words.split(|word| token::ends_sentence(word)).filter(|sentence| !sentence.is_empty()).peekable();
    let asks_to_know = |sentence: &[String]| lexicon.yes_no.knowing.longest(sentence).is_some();
    let asks = |sentence: &[String]| whether::asked_at(lexicon, sentence).is_some() || asks_to_know(sentence);
    sentences.peek().is_some() && sentences.all(asks)
}

/// The two states of which one is asked for in some sentence, and the words for them.
fn either(lexicon: &Lexicon, words: &[String]) -> Option<([StateWord; 2], String)> {
    let [first, second] = whether::sentences(words).into_iter().find_map(|one| asked_either(lexicon, one))?;
    Some(([first.0, second.0], format!("{} or {}", first.1.join(" "), second.1.join(" "))))
}

/// `if it is not`, `if not`, `unless`.
fn denies_condition(lexicon: &Lexicon, words: &[String]) -> bool {
    let after = |at: usize| lexicon.ifs.holds.longest(&words[at..]).map(|(length, ())| at + length);
    (0..words.len()).filter_map(after).any(|start| {
        let end =
            words[start..].iter().position(|word| token::is_punctuation(word)).map_or(words.len(), |end| start + end);
        words[start..end.min(start + CLAUSE)].iter().any(|word| lexicon.ifs.negations.contains(word))
    })
}

//! Kinds of questions people ask the robot.

use serde::Deserialize;

use crate::{
    clause,
    lexicon::Lexicon,
    phrase::{Phrase, Reader},
    token,
};

/// What a question asks for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum QuestionKind {
    Holding,
    #[serde(rename = "self")]
    Robot,
    Where,
    Abilities,
    Doing,
    Goals,
    Seeing,
    Contents,
    Color,
    Text,
    Look,
    Count,
    State,
    Unknown,
    /// What there is to do, and how to ask for it.
    Options,
    HowTo,
    Why,
}

/// A question, and what it is about.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    pub(crate) kind: QuestionKind,
    pub(crate) about: Option<Phrase>,
    /// What follows the start.
    pub(crate) rest: Vec<String>,
}

/// The question that these words ask, if they ask one.
pub(crate) fn read(lexicon: &Lexicon, words: &[String]) -> Option<Question> {
    let first = clause::segments(lexicon, words).into_iter().next()?;
    let (kind, start) = start(lexicon, first)?;
    let mut rest: Vec<String> = first[start..].to_vec();
    rest.retain(|word| !token::is_punctuation(word));
    if kind == QuestionKind::Abilities && rest.len() > 2 {
        return None;
    }
    let about = Reader::new(lexicon, &rest).phrase_with_place();
    Some(Question { kind, about, rest })
}

/// Tries the words as they are, then without each polite word at the start: `can you see` must win over `can you`.
fn start(lexicon: &Lexicon, words: &[String]) -> Option<(QuestionKind, usize)> {
    let mut at = 0;
    loop {
        let rest = &words[at..];
        if let Some((length, kind)) = lexicon.questions.longest(rest)
            && lexicon.lead.longest(rest).is_none_or(|(lead, ())| lead < length)
        {
            return Some((*kind, at + length));
        }
        match lexicon.lead.longest(rest) {
            Some((length, ())) => at += length,
            None if rest.first().is_some_and(|word| token::is_punctuation(word)) => at += 1,
            None => return None,
        }
    }
}

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
    // `show me where is the mug`
    if kind == QuestionKind::Where {
        let skipped =
            rest.iter().take_while(|word| matches!(word.as_str(), "is" | "are" | "it" | "was" | "exactly")).count();
        rest.drain(..skipped.min(rest.len().saturating_sub(1)));
    }
    let about = Reader::new(lexicon, &rest).phrase_with_place();
    Some(Question { kind, about, rest })
}

/// Tries the words as they are, then without each polite word at the start: `can you see` must win over `can you`.
fn start(lexicon: &Lexicon, words: &[String]) -> Option<(QuestionKind, usize)> {
    let mut at = 0;
    loop {
        let rest = &words[at..];
        let lead = lexicon.lead.longest(rest).map_or(0, |(length, ())| length);
        let talk = lexicon.talk.longest(rest).map_or(0, |(length, ())| length);
        let polite = if talk == rest.len() { lead } else { lead.max(talk) };
        if let Some((length, kind)) = lexicon.questions.longest(rest)
            && polite < length
        {
            return (!is_statement(&words[..at], &rest[0])).then_some((*kind, at + length));
        }
        match polite {
            1.. => at += polite,
            0 if rest.first().is_some_and(|word| token::is_punctuation(word)) => at += 1,
            0 => return None,
        }
    }
}

/// `you are driving me mad`: who speaks so says, and does not ask.
fn is_statement(before: &[String], first: &str) -> bool {
    let is_subject = before.last().is_some_and(|word| matches!(word.as_str(), "you" | "i" | "we" | "that" | "there"));
    is_subject && matches!(first, "are" | "am" | "is" | "was" | "were" | "do" | "did" | "have" | "has")
}

//! Whether somebody tells the robot to stop, and what else they say.
//!
//! Knows nothing of the rest of the language: text in, the stop and the rest of the text out. It is pure, total and quick, as
//! it is asked of every piece of speech before anything else is understood. All words lie in `data/stop.toml`.
//!
//! A phrase that says stop counts by where it stands in its clause and by what follows it: "stop by the kitchen", "did you
//! stop?", "stop the laser" and "go two metres and stop" tell the robot something else.

mod after;
pub(crate) mod said;
mod tokens;
mod words;

use crate::stop::said::{Firmness, Said};

/// Somebody tells the robot to stop.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Stop {
    /// What they say after it, without the stop itself; empty if that is all.
    pub rest: String,
    /// How surely they do.
    pub firmness: Firmness,
    /// Whether the word itself was said: a phrase such as "wait" may yet go on as "wait for me".
    pub is_plain: bool,
    /// Whether they say nothing else.
    pub is_all: bool,
}

/// The stop in a text, if there is one. What is said before it is taken back by it.
#[must_use]
pub fn find_stop(text: &str) -> Option<Stop> {
    let words = words::words();
    let tokens = tokens::tokens(words, text);
    let clauses = tokens::clauses(&tokens);
    let spelt: Vec<String> = tokens.iter().map(|token| token.word.clone()).collect();
    let said = Said { words, tokens: &tokens, spelt: &spelt, clauses: &clauses };
    let mut stop: Option<Stop> = None;
    let mut end = 0;
    for (number, clause) in clauses.iter().enumerate() {
        for at in clause.words.clone() {
            let Some(found) = (at >= end).then(|| said.stop_at(number, at, stop.is_some())).flatten() else { continue };
            end = found.end.max(at + 1);
            let before = stop.take();
            let rest = said.rest(text, end);
            stop = Some(Stop {
                is_all: rest.is_empty() && before.as_ref().map_or(number == 0, |before| before.is_all),
                rest,
                firmness: before.as_ref().map_or(found.firmness, |before| before.firmness.max(found.firmness)),
                is_plain: found.is_plain || before.is_some_and(|before| before.is_plain),
            });
        }
    }
    stop
}

/// What somebody drops before they ask for something else, or after.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Dropped {
    /// The words for the thing that is not wanted; empty, where all of it is dropped.
    pub(crate) what: String,
    /// What else they say.
    pub(crate) rest: String,
}

/// What is dropped in a text, if anything is: `never mind the mug, bring me the plate`.
#[must_use]
pub(crate) fn find_dropped(text: &str) -> Option<Dropped> {
    let words = words::words();
    let tokens = tokens::tokens(words, text);
    let clauses = tokens::clauses(&tokens);
    let spelt: Vec<String> = tokens.iter().map(|token| token.word.clone()).collect();
    let said = Said { words, tokens: &tokens, spelt: &spelt, clauses: &clauses };
    let mut all =
        clauses.iter().enumerate().flat_map(|(number, clause)| clause.words.clone().map(move |at| (number, at)));
    let (number, what) = all.find_map(|(number, at)| Some((number, said.dropped_at(number, at)?)))?;
    let before = text[..tokens.get(clauses[number].words.start)?.from].trim();
    let rest = format!("{before} {}", said.rest(text, what.end));
    Some(Dropped { what: spelt[what].join(" "), rest: rest.trim().to_owned() })
}

/// Whether a text has the word itself in it, told to the robot or not: "OK, I stop."
#[must_use]
pub fn mentions_stop(text: &str) -> bool {
    let words = words::words();
    tokens::tokens(words, text).iter().any(|token| words.core.contains(&token.word))
}

/// Whether a text has the word itself in it, and none but what somebody says not to do: "don't stop now."
#[must_use]
pub(crate) fn denies_stop(text: &str) -> bool {
    let words = words::words();
    let tokens = tokens::tokens(words, text);
    let clauses = tokens::clauses(&tokens);
    let spelt: Vec<String> = tokens.iter().map(|token| token.word.clone()).collect();
    let said = Said { words, tokens: &tokens, spelt: &spelt, clauses: &clauses };
    let all = clauses.iter().flat_map(|clause| clause.words.clone().map(|at| (clause.words.start, at)));
    let mut stops = all.filter(|(_, at)| words.core.contains(said.word(*at))).peekable();
    stops.peek().is_some() && stops.all(|(start, at)| said.is_negated(start, at))
}

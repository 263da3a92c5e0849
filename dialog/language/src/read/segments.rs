//! Where one part of an utterance ends and the next one begins, and how many words stand before what it asks for.

use std::ops::Range;

use crate::{
    read::reader::Reader,
    words::{lexicon::Lexicon, token},
};

/// Most words of a courtesy that ends in `and`.
const LONGEST_COURTESY: usize = 6;

/// Whether the word begins a clause that asks for nothing.
pub(crate) fn is_subordinator(lexicon: &Lexicon, word: &str) -> bool {
    lexicon.chatter.subordinators.contains(word)
}

/// The words up to the next punctuation.
pub(crate) fn chunk(words: &[String]) -> &[String] {
    let end = words.iter().position(|word| token::is_punctuation(word)).unwrap_or(words.len());
    &words[..end]
}

/// Whether the word at `at` is in a part of the utterance that is not to be done.
pub(crate) fn is_forbidden(lexicon: &Lexicon, words: &[String], at: usize) -> bool {
    cuts(lexicon, words).into_iter().filter(|cut| cut.contains(&at)).any(|cut| {
        let segment = &words[cut];
        lexicon.negation.longest(&segment[leading(lexicon, segment).min(segment.len() - 1)..]).is_some()
    })
}

/// The words between cuts.
pub(crate) fn segments<'a>(lexicon: &Lexicon, words: &'a [String]) -> Vec<&'a [String]> {
    cuts(lexicon, words).into_iter().map(|cut| &words[cut]).collect()
}

/// Cuts at sentence ends, and at `and` or a comma before a verb.
pub(crate) fn cuts(lexicon: &Lexicon, words: &[String]) -> Vec<Range<usize>> {
    let mut cuts = Vec::new();
    let mut start = 0;
    for at in 0..words.len() {
        let is_end = token::ends_sentence(&words[at]) || words[at] == "then";
        let is_joint = matches!(words[at].as_str(), "," | "and" | "but" | "so")
            && !ends_courtesy(lexicon, &words[start..=at])
            && {
                let mut reader = Reader::new(lexicon, words);
                reader.at = at + 1;
                let forbids = lexicon.negation.longest(reader.rest()).is_some();
                reader.skip(|lexicon| &lexicon.lead);
                forbids || reader.at_verb() || lexicon.negation.longest(reader.rest()).is_some()
            };
        if is_end || is_joint {
            cuts.push(start..at);
            start = at + 1;
        }
    }
    cuts.push(start..words.len());
    cuts.retain(|cut| words[cut.clone()].iter().any(|word| !token::is_punctuation(word)));
    cuts
}

/// The cuts that are to be carried out before those in front of them: `take the mug, but first open the fridge`, and what goes on with
/// `and`.
pub(crate) fn done_first(lexicon: &Lexicon, words: &[String], cuts: &[Range<usize>]) -> Option<Range<usize>> {
    // `take the mug. before that, open the fridge`
    let is_announced = |at: usize| at > 1 && lexicon.beforehand.exact(said_in(words, &cuts[at - 1])).is_some();
    let first = (1..cuts.len()).rev().find(|at| is_announced(*at) || is_done_first(lexicon, words, &cuts[*at]))?;
    let goes_on = |cut: &&Range<usize>| words[cut.start - 1] == "and";
    let more = cuts[first + 1..].iter().take_while(goes_on).count();
    Some(first..first + 1 + more)
}

/// Whether a cut behind others begins or ends in words that say so; `then first` tells the order as it is, and `the first` is a thing.
fn is_done_first(lexicon: &Lexicon, words: &[String], cut: &Range<usize>) -> bool {
    let said = said_in(words, cut);
    let begins = lexicon.beforehand.longest(said).is_some_and(|(length, ())| length < said.len());
    let ends = || {
        (1..said.len()).any(|at| {
            lexicon.beforehand.exact(&said[at..]).is_some() && lexicon.articles.exact(&said[at - 1..at]).is_none()
        })
    };
    words[cut.start - 1] != "then" && (begins || ends())
}

/// The words of a cut without the punctuation around them.
fn said_in<'a>(words: &'a [String], cut: &Range<usize>) -> &'a [String] {
    let is_said = |at: &usize| !token::is_punctuation(&words[*at]);
    match (cut.clone().find(is_said), cut.clone().rfind(is_said)) {
        (Some(start), Some(last)) => &words[start..=last],
        _ => &[],
    }
}

/// `go ahead and`, `be so kind and`: no joint between two requests.
fn ends_courtesy(lexicon: &Lexicon, words: &[String]) -> bool {
    let is_one = |start: usize| {
        let said = &words[start..];
        lexicon.lead.exact(said).is_some() || lexicon.talk.exact(said).is_some()
    };
    words.len() > 1 && (words.len().saturating_sub(LONGEST_COURTESY)..words.len() - 1).any(is_one)
}

/// How many words at the start mean nothing: politeness, `and`, commas.
pub(crate) fn leading(lexicon: &Lexicon, words: &[String]) -> usize {
    let mut at = 0;
    loop {
        let rest = &words[at..];
        let is_joint = rest.first().is_some_and(|word| token::is_punctuation(word));
        let verb = lexicon.verbs.longest(rest).map_or(0, |(length, _)| length);
        let lead = lexicon.lead.longest(rest).map_or(0, |(length, ())| length);
        let talk = lexicon.talk.longest(rest).map_or(0, |(length, ())| length);
        // `cool the banana` is no `cool!`, nor `move it to the table` a `move it!`.
        let is_verb = verb > 0
            && rest.get(talk).is_some_and(|word| !token::is_punctuation(word))
            && (talk == verb || talk > verb && lexicon.prepositions.longest(&rest[talk..]).is_some());
        let talk = if is_verb { 0 } else { talk };
        match lead.max(talk) {
            length @ 1.. if length >= verb && (talk > 0 || lexicon.negation.longest(rest).is_none()) => at += length,
            _ if is_joint || verb == 1 && goes_to_do(lexicon, rest) => at += 1,
            _ => return at,
        }
    }
}

/// `go fill the mug`: one who goes to do something does it.
fn goes_to_do(lexicon: &Lexicon, words: &[String]) -> bool {
    let does = |rest: &[String]| {
        let is_way = lexicon.directions.longest(rest).is_some() || lexicon.prepositions.longest(rest).is_some();
        !is_way && Reader::new(lexicon, rest).at_verb()
    };
    matches!(words[0].as_str(), "go" | "come") && does(&words[1..])
}

/// The words that are not in the vocabulary.
pub(crate) fn unknown_words(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let is_unknown =
        |word: &&String| !lexicon.vocabulary.has(word) && !token::is_punctuation(word) && token::digits(word).is_none();
    words.iter().filter(is_unknown).cloned().collect()
}

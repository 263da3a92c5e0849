//! Talk around requests: openers, reasons, asides. Finds where the next request begins, and what is spoken of before it.

use cohabit_cdf::Catalog;

use crate::{
    read::{
        clause::{Clause, Part},
        phrase::{Phrase, Place},
        reader::Reader,
        reading, segments,
    },
    words::{intent::Intent, lexicon::Lexicon, token},
};

/// Most words of an opener.
const LONGEST_TALK: usize = 10;

/// Reads talk at the start of `words`: up to the next request, or all of them.
pub(crate) fn read(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> (Part, usize) {
    let end = (1..words.len()).find(|at| is_request(lexicon, catalog, words, *at)).unwrap_or(words.len());
    let (talk, first) = (&words[..end], segments::chunk(words));
    if is_unknown_order(lexicon, first) || end == words.len() && asks_unclearly(lexicon, words) {
        return (Part::Unclear(segments::unknown_words(lexicon, words)), words.len());
    }
    if is_forbidden(lexicon, talk) && end < words.len() {
        let about = mention(lexicon, &words[end..end + segments::chunk(&words[end..]).len()]).map(|(phrase, _)| phrase);
        return (Part::Forbidden(about), end + segments::chunk(&words[end..]).len());
    }
    match mention(lexicon, talk) {
        Some((phrase, used)) => (Part::Mention(phrase), used),
        None => (Part::Aside(segments::unknown_words(lexicon, talk)), end),
    }
}

/// Whether a request begins at `at`: a verb where one may ask for something, with all that it needs.
fn is_request(lexicon: &Lexicon, catalog: &Catalog, words: &[String], at: usize) -> bool {
    let before = &words[at - 1];
    let ends_talk = |length: usize| {
        let talk = &words[at - length..at];
        lexicon.talk.exact(talk).is_some() || lexicon.lead.exact(talk).is_some()
    };
    let is_allowed = token::is_punctuation(before)
        || lexicon.chatter.before_requests.contains(before)
        || (1..=at.min(LONGEST_TALK)).any(ends_talk);
    is_allowed && !is_reported(lexicon, &words[..at]) && {
        let rest = &words[at..];
        crate::read::wish::is_said(lexicon, rest)
            || lexicon.verbs.longest(rest).is_some()
                && reading::read(lexicon, catalog, rest).is_some_and(|(clause, _)| is_clear(&clause))
            || token::is_punctuation(before) && lexicon.negation.longest(rest).is_some()
    }
}

/// Whether the words before tell of something: `somebody told me that you can …`.
fn is_reported(lexicon: &Lexicon, before: &[String]) -> bool {
    let is_cut = |word: &String| token::is_punctuation(word) || matches!(word.as_str(), "so" | "but" | "and" | "then");
    let start = before.iter().rposition(is_cut).map_or(0, |at| at + 1);
    // `my mother said you have to …`
    let musts =
        [&["you", "have", "to"][..], &["you", "should"], &["you", "must"], &["you", "need", "to"], &["you", "to"]];
    let ends = |must: &&[&str]| {
        before.len() >= must.len()
            && before[before.len() - must.len()..].iter().zip(*must).all(|(word, one)| word == one)
    };
    if musts.iter().any(ends) {
        return false;
    }
    before[start..].iter().any(|word| lexicon.chatter.reports.contains(word))
}

/// Whether all that a request names means something.
pub(crate) fn is_clear(clause: &Clause) -> bool {
    let is_known = |phrase: &Phrase| phrase.unknown.is_empty();
    clause.intent != Intent::Impossible
        && clause.objects.iter().all(is_known)
        && clause.places.iter().all(|(_, place)| !matches!(place, Place::Object(phrase) if !is_known(phrase)))
}

/// `frobnicate the mug`: a verb that nobody taught it, not to be passed over.
fn is_unknown_order(lexicon: &Lexicon, words: &[String]) -> bool {
    let [first, rest @ ..] = words else { return false };
    let is_talk = lexicon.vocabulary.has(first)
        || segments::is_subordinator(lexicon, first)
        || lexicon.talk.longest(words).is_some();
    let has_object = lexicon.articles.longest(rest).is_some()
        || lexicon.pronouns.longest(rest).is_some()
        || lexicon.classes.longest(rest).is_some();
    !is_talk && has_object
}

/// Whether talk without a request has a verb where a request would have one: it was meant to be one.
fn asks_unclearly(lexicon: &Lexicon, words: &[String]) -> bool {
    lexicon.verbs.longest(words).is_some()
}

/// Whether the talk just before a request says not to do it.
fn is_forbidden(lexicon: &Lexicon, talk: &[String]) -> bool {
    let start = talk.iter().rposition(|word| token::is_punctuation(word)).map_or(0, |at| at + 1);
    lexicon.negation.occurs_in(&talk[start..])
}

/// The first thing that the talk is about, or else the first room, and how many words that takes.
pub(crate) fn mention(lexicon: &Lexicon, talk: &[String]) -> Option<(Phrase, usize)> {
    named(lexicon, talk).or_else(|| {
        let (at, (length, room)) = (0..talk.len()).find_map(|at| Some((at, lexicon.rooms.longest(&talk[at..])?)))?;
        Some((Phrase { room: Some(*room), ..Phrase::default() }, at + length))
    })
}

fn named(lexicon: &Lexicon, talk: &[String]) -> Option<(Phrase, usize)> {
    (0..talk.len()).find_map(|at| {
        let mut reader = Reader::new(lexicon, talk);
        reader.at = at;
        let is_name = !reader.at_verb();
        let is_told = |phrase: &Phrase| !phrase.namings.is_empty() || phrase.pronoun.is_some() && phrase.is_described();
        let phrase = reader.phrase_with_place().filter(|phrase| is_name && is_told(phrase))?;
        phrase.unknown.is_empty().then_some((phrase, reader.at))
    })
}

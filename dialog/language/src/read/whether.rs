//! Questions that want a yes or a no: where they begin, and what deed they ask about.

use cohabit_cdf::Catalog;

use crate::{
    read::{clause::Clause, reader::Reader, reading, segments},
    words::{inflect, lexicon::Lexicon, token},
};

/// Where the question that a sentence asks begins, if it wants a yes or a no and requests nothing.
pub(crate) fn asked_at(lexicon: &Lexicon, sentence: &[String]) -> Option<usize> {
    let words = &lexicon.yes_no;
    let start = segments::leading(lexicon, sentence);
    let [first, next, ..] = sentence.get(start..)? else { return None };
    let rest = &sentence[start + 1..];
    let is_thing = words.things.contains(next)
        || lexicon.articles.longest(rest).is_some()
        || lexicon.classes.longest(rest).is_some();
    let is_stated = start > 0 && words.stated.contains(&sentence[start - 1]);
    let is_asked = words.past.contains(first) && words.subjects.contains(next)
        || words.perfect.contains(first) && words.persons.contains(next)
        || words.being.contains(first) && is_thing
        || words.modals.contains(first) && is_thing && !rest.iter().any(|word| words.passive.contains(word));
    (is_asked && !is_stated).then_some(start)
}

/// The sentences of what was said, without their ends.
pub(crate) fn sentences(words: &[String]) -> Vec<&[String]> {
    let sentences = words.split(|word| token::ends_sentence(word));
    sentences.filter(|sentence| sentence.iter().any(|word| !token::is_punctuation(word))).collect()
}

/// `did you close the fridge`, `did the plant get watered`: what the robot may have done.
pub(crate) fn deed_asked_about(lexicon: &Lexicon, catalog: &Catalog, asked: &[String]) -> Option<Clause> {
    let words = &lexicon.yes_no;
    let active = put_actively(lexicon, asked);
    let asked = active.as_deref().unwrap_or(asked);
    let [helper, subject, done @ ..] = asked else { return None };
    let is_asked = words.past.contains(helper) || words.perfect.contains(helper);
    if !is_asked || subject != "you" && subject != "we" {
        return None;
    }
    let skipped = done.iter().take_while(|word| words.between.contains(*word)).count();
    let mut done = done[skipped..].to_vec();
    let is_verb = lexicon.verbs.longest(&done).is_some();
    let first = done.first_mut()?;
    if !is_verb && !inflect::is_verb(lexicon, first) {
        *first = inflect::stem(lexicon, first)?;
    }
    reading::read(lexicon, catalog, &done).map(|(clause, _)| clause)
}

/// `did the plant get its water`, `has the milk been put in the fridge`: the same asked of the robot, `did you water the plant`. Whether
/// something is back is told by where it is.
pub(crate) fn put_actively(lexicon: &Lexicon, asked: &[String]) -> Option<Vec<String>> {
    const PERFECT: [&str; 3] = ["has", "have", "had"];
    let words = &lexicon.yes_no;
    let (helper, rest) = asked.split_first()?;
    let mut reader = Reader::new(lexicon, rest);
    let is_person = rest.first().is_some_and(|first| first == "you" || first == "we" || first == "i");
    reader.phrase().filter(|phrase| !is_person && (!phrase.namings.is_empty() || phrase.is_bare_pronoun()))?;
    let (thing, after) = rest.split_at(reader.at);
    let (auxiliary, done) = after.split_first()?;
    let gets = words.past.contains(helper) && auxiliary == "get";
    if !(gets || PERFECT.contains(&helper.as_str()) && auxiliary == "been") {
        return None;
    }
    let skipped = done.iter().take_while(|word| words.between.contains(*word)).count();
    let done = &done[skipped..];
    if words.says_back(after) {
        return None;
    }
    let (length, verb) = match words.gets.longest(done) {
        Some((length, verb)) if gets => (length, verb.clone()),
        _ => {
            let first = done.first()?;
            (1, inflect::stem(lexicon, first).or_else(|| inflect::is_verb(lexicon, first).then(|| first.clone()))?)
        }
    };
    let asks = ["did".to_owned(), "you".to_owned(), verb];
    Some(asks.iter().chain(thing).chain(&done[length..]).cloned().collect())
}

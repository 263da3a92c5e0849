//! The parts of an utterance, in order: requests, talk, things named without a verb.

use std::ops::Range;

use cohabit_cdf::Catalog;

use crate::{
    read::{
        chatter,
        clause::{self, Clause, Part},
        phrase::{Phrase, Place},
        reader::Reader,
        reading, segments, slot, wish,
    },
    words::{
        intent::Intent,
        lexicon::{Lexicon, Preposition, Pronoun},
        token,
    },
};

/// The parts of an utterance, in order.
pub(crate) fn parts(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Vec<Part> {
    let mut parts = Vec::new();
    let cuts = segments::cuts(lexicon, words);
    let first = segments::done_first(lexicon, words, &cuts);
    let mut early: Option<Range<usize>> = None;
    for (number, cut) in cuts.into_iter().enumerate() {
        let before = parts.len();
        let is_consequence = cut.start > 0 && words[cut.start - 1] == "so" || words[cut.start] == "so";
        read_segment(lexicon, catalog, &words[cut], &mut parts);
        let asks = |part: &Part| matches!(part, Part::Clause(clause) if !clause.is_wish);
        if is_consequence && parts[before..].iter().any(asks) {
            parts[..before].iter_mut().for_each(demote);
        }
        if first.as_ref().is_some_and(|first| first.contains(&number)) {
            early = Some(early.map_or(before, |early| early.start)..parts.len());
        }
    }
    early.into_iter().for_each(|early| move_to_front(&mut parts, early));
    parts
}

/// What is to be carried out first stands before all else; `it` in it is what was named before it.
fn move_to_front(parts: &mut Vec<Part>, early: Range<usize>) {
    let is_request = |part: &Part| matches!(part, Part::Clause(_));
    if !parts[early.clone()].iter().any(is_request) {
        return;
    }
    let named = parts[..early.start].iter().rev().find_map(|part| match part {
        Part::Clause(clause) => slot::named(clause).first().map(|phrase| (*phrase).clone()),
        Part::Fragment(phrase) | Part::Mention(phrase) => Some(phrase.clone()),
        _ => None,
    });
    let mut moved: Vec<Part> = parts.drain(early).collect();
    if let Some(named) = named.filter(|phrase| !phrase.is_empty()) {
        let objects = moved.iter_mut().flat_map(|part| match part {
            Part::Clause(clause) => clause.objects.as_mut_slice(),
            _ => &mut [],
        });
        let is_it = |phrase: &&mut Phrase| phrase.pronoun == Some(Pronoun::Thing) && phrase.is_bare_pronoun();
        objects.filter(is_it).for_each(|phrase| *phrase = named.clone());
    }
    parts.splice(0..0, moved);
}

/// `i could use a coffee, so take the mug`: what was wished for is the reason.
fn demote(part: &mut Part) {
    if let Part::Clause(clause) = part
        && clause.is_wish
    {
        let phrase = clause.objects.first().cloned();
        *part = phrase.map_or_else(|| Part::Aside(Vec::new()), Part::Mention);
    }
}

/// `main office`: whoever names a room wants the robot there.
pub(crate) fn to_room(lexicon: &Lexicon, words: &[String]) -> Option<Clause> {
    let mut reader = Reader::new(lexicon, words);
    reader.at = segments::leading(lexicon, words);
    reader.skip(|lexicon| &lexicon.articles);
    let place = reader.destination().filter(|place| matches!(place, Place::Room(_)))?;
    reader.skip(|lexicon| &lexicon.trail);
    let is_whole = reader.rest().iter().all(|word| token::is_punctuation(word));
    let clause = Clause::about(Intent::GoTo, "go to", Phrase::default());
    is_whole.then(|| Clause { objects: Vec::new(), places: vec![(Preposition::To, place)], ..clause })
}

fn read_segment(lexicon: &Lexicon, catalog: &Catalog, segment: &[String], parts: &mut Vec<Part>) {
    let mut rest = segment;
    while !rest.is_empty() {
        let skipped = segments::leading(lexicon, rest);
        rest = &rest[skipped..];
        if rest.is_empty() {
            break;
        }
        if let Some(used) = read_wish(lexicon, catalog, rest, parts) {
            rest = &rest[used..];
            continue;
        }
        let start = segment.len() - rest.len();
        let is_means = start > 0 && segment[start - 1] == "by";
        let (mut part, used) = read_part(lexicon, catalog, rest, parts);
        if let Part::Clause(clause) = &mut part {
            clause.is_means = is_means && matches!(parts.last(), Some(Part::Clause(_)));
        }
        parts.push(part);
        rest = &rest[used.clamp(1, rest.len())..];
    }
}

/// What is wished for, and how many words say so.
fn read_wish(lexicon: &Lexicon, catalog: &Catalog, words: &[String], parts: &mut Vec<Part>) -> Option<usize> {
    let (request, used) = wish::request(lexicon, words)?;
    let (clause, read) = reading::read(lexicon, catalog, &request)?;
    parts.push(Part::Clause(Clause { is_wish: true, ..clause }));
    // `I want the apple on the plate and the banana in the fridge`
    let rest = &request[read..];
    if rest.first().is_some_and(|word| word == "and") {
        read_segment(lexicon, catalog, &rest[1..], parts);
    }
    Some(used)
}

fn read_part(lexicon: &Lexicon, catalog: &Catalog, words: &[String], before: &[Part]) -> (Part, usize) {
    let length = |found: Option<usize>| found.unwrap_or(0);
    if length(lexicon.negation.longest(words).map(|(length, ())| length))
        > length(lexicon.verbs.longest(words).map(|(length, _)| length))
    {
        let chunk = segments::chunk(words);
        return (Part::Forbidden(chatter::mention(lexicon, chunk).map(|(phrase, _)| phrase)), chunk.len());
    }
    if let Some((clause, used)) = reading::read(lexicon, catalog, words).or_else(|| reading::motion(lexicon, words)) {
        return (Part::Clause(clause), used);
    }
    let mut reader = Reader::new(lexicon, words);
    if let Some(Part::Clause(previous)) = before.last()
        && clause::takes_objects(previous.intent)
        && !tells_of_it(lexicon, words)
        && let Some((clause, used)) = reading::read_as(lexicon, previous.intent, &previous.verb, words, 0)
            .filter(|(clause, _)| reading::is_complete(clause, catalog) && clause.names_any())
    {
        return (Part::Clause(clause), used);
    }
    if let Some(phrase) = reader.phrase_with_place().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty()) {
        reader.skip(|lexicon| &lexicon.trail);
        let is_whole = reader.rest().first().is_none_or(|word| token::is_punctuation(word));
        if is_whole {
            return (Part::Fragment(phrase), reader.at);
        }
    }
    chatter::read(lexicon, catalog, words)
}

/// `shut the fridge, it lets the cold out`: says something of it, and asks for nothing.
fn tells_of_it(lexicon: &Lexicon, words: &[String]) -> bool {
    let is_subject = matches!(words[0].as_str(), "it" | "they" | "he" | "she" | "i" | "we");
    is_subject
        && words.get(1).is_some_and(|next| !token::is_punctuation(next) && lexicon.trail.longest(&words[1..]).is_none())
        && lexicon.prepositions.longest(&words[1..]).is_none()
}

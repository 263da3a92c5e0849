//! Requests without a verb, or with it where nobody looks for it: `back to the kitchen`, `with the hammer, break it`.

use cohabit_cdf::Catalog;

use crate::{
    chatter,
    clause::Clause,
    intent::Intent,
    lexicon::{Direction, Lexicon, Preposition, Pronoun},
    phrase::{Phrase, Place, Reader},
    reading, tail, token,
};

/// `with it smash the trophy`
pub(crate) fn begins_with_tool(mut reader: Reader<'_>) -> bool {
    reader.at += 1;
    reader.phrase().is_some() && reader.at_verb()
}

/// `…, on the counter please`: a place, and nothing else.
pub(crate) fn late_place(lexicon: &Lexicon, words: &[String]) -> Option<(Preposition, Place, usize)> {
    let chunk = chatter::chunk(words);
    let mut reader = Reader::new(lexicon, chunk);
    lexicon.prepositions.longest(chunk)?;
    let is_goal = ["to", "into", "onto"].iter().any(|to| reader.next_is(to));
    let (preposition, place) = reader.place().filter(|(_, place)| is_known_place(place))?;
    reader.skip(|lexicon| &lexicon.trail);
    let preposition = if is_goal { Preposition::To } else { preposition };
    reader.is_done().then_some((preposition, place, chunk.len()))
}

/// `a hammer that I would like you to pick up`: what the verb at the end is about was said before.
pub(crate) fn gap(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Option<(Clause, usize)> {
    let (length, _) = lexicon.verbs.longest(words)?;
    let is_last = words[length..].iter().all(|word| token::is_punctuation(word));
    if !is_last {
        return None;
    }
    let mut whole = words[..length].to_vec();
    whole.push("it".to_owned());
    let (mut clause, _) = reading::read(lexicon, catalog, &whole)?;
    clause.objects.iter_mut().for_each(|unsaid| unsaid.text.clear());
    Some((clause, words.len()))
}

/// `use the hammer to break the mug`, `with the hammer, break the mug`.
pub(crate) fn with_tool_first(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Option<(Clause, usize)> {
    if !matches!(words.first()?.as_str(), "use" | "using" | "with" | "take") {
        return None;
    }
    let mut reader = Reader::new(lexicon, words);
    reader.at = 1;
    let tool = reader.phrase_with_place()?;
    let is_joined = matches!(reader.rest().first()?.as_str(), "to" | "and" | ",");
    if !is_joined && words[0] != "with" || words[0] == "take" && !reader.next_is("to") {
        return None;
    }
    reader.at += usize::from(is_joined);
    reader.skip(|lexicon| &lexicon.lead);
    if !reader.at_verb() {
        return None;
    }
    let start = reader.at;
    let (mut clause, used) = reading::read(lexicon, catalog, reader.rest())?;
    clause.places.push((Preposition::With, Place::Object(tool)));
    Some((clause, start + used))
}

/// `left`, `forward 2 meters`: motion without a verb.
pub(crate) fn implied_motion(lexicon: &Lexicon, words: &[String]) -> Option<(Clause, usize)> {
    let mut reader = Reader::new(lexicon, words);
    if reading::read_amount(&mut reader).is_none() {
        reader.at = reading::a_bit(words).unwrap_or_default();
    }
    let (_, direction) = lexicon.directions.longest(reader.rest())?;
    let intent = match direction {
        Direction::Forward | Direction::Backward => Intent::Travel,
        Direction::Left | Direction::Right | Direction::Around => Intent::Turn,
        Direction::Up | Direction::Down => Intent::Look,
    };
    let (mut clause, used) = reading::read_as(lexicon, intent, intent.verb(), words, 0)?;
    clause.verb.clear();
    let is_motion = clause.direction.is_some() && clause.places.is_empty() && reading::is_whole(&clause);
    (is_motion && used == words.len()).then_some((clause, used))
}

/// `back to the kitchen`, `over to the sink with you`: going without a verb.
pub(crate) fn implied_going(lexicon: &Lexicon, words: &[String]) -> Option<Clause> {
    let mut reader = Reader::new(lexicon, words);
    let ways = ["back", "over", "up", "off", "out", "on", "straight", "right", "down", "away", "home", "next"];
    while ways.iter().any(|way| reader.next_is(way)) {
        reader.at += 1;
    }
    let is_to = ["to", "into", "towards", "toward"].iter().any(|to| reader.next_is(to));
    if !is_to && !["in", "on", "onto"].iter().any(|on| reader.next_is(on)) {
        return None;
    }
    reader.at += 1;
    // `to open the fridge` is no way to the open fridge.
    if is_to && reader.at_verb() {
        return None;
    }
    let place = reader.destination().filter(is_known_place)?;
    // `into the fridge with it`
    if reader.next_is("with")
        && let Some((length, Pronoun::Thing | Pronoun::Things)) = lexicon.pronouns.longest(&reader.rest()[1..])
        && reader.rest().len() == 1 + length
    {
        let it = Phrase { pronoun: Some(Pronoun::Thing), text: "it".to_owned(), ..Phrase::default() };
        return Some(Clause { places: vec![(Preposition::In, place)], ..Clause::about(Intent::Place, "put", it) });
    }
    let mut clause = Clause { places: vec![(Preposition::To, place)], ..Clause::new(Intent::GoTo, "go to") };
    tail::read_tail(&mut reader, &mut clause);
    (is_to && reader.is_done() && reading::is_whole(&clause)).then_some(clause)
}

/// `the cartridge into the printer`: putting without a verb.
pub(crate) fn implied_placing(lexicon: &Lexicon, words: &[String]) -> Option<Clause> {
    let mut reader = Reader::new(lexicon, words);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    if !["to", "into", "onto", "back"].iter().any(|to| reader.next_is(to)) {
        return None;
    }
    let place = reader.place().filter(|(_, place)| is_known_place(place))?;
    let mut clause = Clause { places: vec![place], ..Clause::about(Intent::Place, "put", phrase) };
    tail::read_tail(&mut reader, &mut clause);
    (reader.is_done() && reading::is_whole(&clause)).then_some(clause)
}

pub(crate) fn is_known_place(place: &Place) -> bool {
    !matches!(place, Place::Object(phrase) if phrase.is_empty() || !phrase.unknown.is_empty())
}

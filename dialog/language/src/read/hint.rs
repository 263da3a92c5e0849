//! Where somebody thinks that a thing is: `I think it is in the bathroom, in the cabinet`, `it should be on the shelf or in the drawer`.

use serde::{Deserialize, Serialize};

use crate::{
    read::{
        phrase::{Phrase, Place, RelationKind},
        reader::Reader,
    },
    words::{
        lexicon::{Lexicon, Preposition},
        table::PhraseTable,
        token,
    },
};

/// Over how many pieces of a sentence one hint goes at most: `I think it is in the bathroom, in the cabinet, on the left`.
const PIECES: usize = 4;
/// What ends a piece of a sentence.
const ENDS: [char; 10] = ['.', '!', '?', ';', ',', '(', ')', '—', '–', '\n'];
/// What is left over between pieces.
const LOOSE: [char; 6] = [',', ' ', '-', '—', '–', '('];
/// How a piece begins that goes on with what is before it.
const JOINTS: [&str; 4] = ["and", "then", "but", "or"];
/// What stands for the thing in a clause that belongs to it.
const RELATIVES: [&str; 2] = ["which", "that"];

/// Where somebody thinks that a thing is.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Hint {
    /// The thing, if it was named.
    pub(crate) about: Option<Phrase>,
    /// One of these, or somewhere else.
    pub(crate) places: Vec<Phrase>,
    /// Whether it may as well say where the thing is to be.
    pub(crate) is_owed: bool,
}

/// An utterance without the hint that follows what is asked for, and the hint; nothing is left of what is a hint and no more.
pub(crate) fn parted(lexicon: &Lexicon, utterance: &str) -> Option<(String, Hint)> {
    let pieces: Vec<&str> = utterance.split_inclusive(ENDS).collect();
    let (before, after, hint) = (0..pieces.len()).find_map(|at| {
        let starts = std::iter::once(0).chain(guesses_within(lexicon, pieces[at]));
        starts.into_iter().find_map(|from| {
            let last = pieces.len().min(at + PIECES);
            (at + 1..=last).rev().find_map(|end| {
                let text = format!("{}{}", &pieces[at][from..], pieces[at + 1..end].concat());
                let hint = read(lexicon, &lexicon.normalise(&text).0, from == 0)?;
                let before = format!("{}{}", pieces[..at].concat(), &pieces[at][..from]);
                Some((before, pieces[end..].concat(), hint))
            })
        })
    })?;
    Some((joined(&before, &after)?, hint))
}

/// What stands before a hint and after it; nothing, where all of it stands after: then the hint says what that is about.
fn joined(before: &str, after: &str) -> Option<String> {
    let (before, after) = (before.trim().trim_end_matches(LOOSE), after.trim().trim_start_matches(LOOSE));
    if before.is_empty() || after.is_empty() {
        return after.is_empty().then(|| before.to_owned());
    }
    let goes_on = token::words(after).first().is_some_and(|word| JOINTS.contains(&word.as_str()));
    let joint = if goes_on || before.ends_with(['.', '!', '?']) { " " } else { ". " };
    Some(format!("{before}{joint}{after}"))
}

/// Where a guess may begin inside a piece: `get the shirt I think it is in the basket`.
fn guesses_within(lexicon: &Lexicon, piece: &str) -> Vec<usize> {
    let words = || piece.split_whitespace().map(|word| (word.as_ptr() as usize - piece.as_ptr() as usize, word));
    let plain = |word: &str| token::words(word).concat();
    let begins = |word: &str| {
        let word = plain(word);
        word == "im"
            || RELATIVES.contains(&word.as_str())
            || lexicon.hints.guesses.phrases().any(|guess| guess[0] == word)
    };
    let is_own = |before: &str| !lexicon.hints.not_after.contains(&plain(before));
    words()
        .zip(words().skip(1))
        .filter(|((_, before), (_, word))| is_own(before) && begins(word))
        .map(|(_, (at, _))| at)
        .collect()
}

/// The hint that words are, to the last one; one in which the thing is left out has to be a piece of its own.
fn read(lexicon: &Lexicon, words: &[String], is_piece: bool) -> Option<Hint> {
    let mut reader = Reader::new(lexicon, words);
    let mut is_guess = skip_guesses(&mut reader);
    let stated = kept(&mut reader).or_else(|| stated(&mut reader));
    let (about, how) = match stated {
        Some(stated) => stated,
        None if is_guess && is_piece => (None, Sureness::Owed),
        None => return None,
    };
    is_guess |= how != Sureness::Plain;
    is_guess |= skip_guesses(&mut reader);
    let places = places(&mut reader)?;
    is_guess |= skip_guesses(&mut reader);
    reader.skip(|lexicon| &lexicon.trail);
    while reader.rest().first().is_some_and(|word| token::is_punctuation(word)) {
        reader.at += 1;
    }
    (is_guess && reader.is_done()).then_some(Hint { about, places, is_owed: how == Sureness::Owed })
}

/// How sure somebody is of where a thing is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Sureness {
    Plain,
    Supposed,
    /// It should be there.
    Owed,
}

/// Steps over guesses and what stands between; whether there was a guess.
fn skip_guesses(reader: &mut Reader<'_>) -> bool {
    let words = &reader.lexicon.hints;
    let mut is_guess = false;
    loop {
        if let Some((length, ())) = words.guesses.longest(reader.rest()) {
            is_guess = true;
            reader.at += length;
        } else if let Some((length, ())) = words.between.longest(reader.rest()) {
            reader.at += length;
        } else if reader.next_is(",") {
            reader.at += 1;
        } else {
            return is_guess;
        }
    }
}

/// Steps over a phrase of a table that stands here.
fn takes(reader: &mut Reader<'_>, table: &PhraseTable<()>) -> bool {
    let length = table.longest(reader.rest()).map_or(0, |(length, ())| length);
    reader.at += length;
    length > 0
}

/// `I left it`, `we usually keep the pills`: who had it, and what.
fn kept(reader: &mut Reader<'_>) -> Option<(Option<Phrase>, Sureness)> {
    let mut read = *reader;
    let words = &read.lexicon.hints;
    if !takes(&mut read, &words.persons) {
        return None;
    }
    skip_guesses(&mut read);
    if !takes(&mut read, &words.kept) {
        return None;
    }
    let about = if takes(&mut read, &words.things) { None } else { Some(named(&mut read)?) };
    *reader = read;
    Some((about, Sureness::Supposed))
}

/// `it should be`, `the pills are`: what is said to be somewhere.
fn stated(reader: &mut Reader<'_>) -> Option<(Option<Phrase>, Sureness)> {
    let mut read = *reader;
    let words = &read.lexicon.hints;
    if takes(&mut read, &words.subjects_plainly) {
        *reader = read;
        return Some((None, Sureness::Plain));
    }
    let about = if takes(&mut read, &words.subjects) { None } else { Some(named(&mut read)?) };
    let is_guess = skip_guesses(&mut read);
    let of = |table: &PhraseTable<()>| table.longest(read.rest()).map(|(length, ())| length);
    let ways =
        [(&words.owed, Sureness::Owed), (&words.supposedly, Sureness::Supposed), (&words.plainly, Sureness::Plain)];
    let (length, how) =
        ways.into_iter().filter_map(|(table, how)| Some((of(table)?, how))).max_by_key(|(length, _)| *length)?;
    read.at += length;
    *reader = read;
    let how = if how == Sureness::Plain && is_guess { Sureness::Supposed } else { how };
    Some((about, how))
}

fn named(reader: &mut Reader<'_>) -> Option<Phrase> {
    reader.phrase().filter(|phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty())
}

/// Places of which one is meant: `in the bathroom, in the cabinet`, `on the desk or the shelf`.
fn places(reader: &mut Reader<'_>) -> Option<Vec<Phrase>> {
    let mut all: Vec<Phrase> = Vec::new();
    let mut before = None;
    loop {
        let (mut one, mut preposition) = (Phrase::default(), before);
        while let Some((said, place)) = place(reader, preposition.take()) {
            add_place(&mut one, said, place);
            before = Some(said);
            let mut next = *reader;
            skip_guesses(&mut next);
            if next.lexicon.prepositions.longest(next.rest()).is_some() {
                reader.at = next.at;
            }
        }
        if one.room.is_none() && !one.is_here && one.relations.is_empty() {
            return None;
        }
        all.push(one);
        let mut next = *reader;
        let lexicon = next.lexicon;
        skip_guesses(&mut next);
        if !takes(&mut next, &lexicon.hints.either) {
            return Some(all);
        }
        skip_guesses(&mut next);
        reader.at = next.at;
    }
}

/// What stands by the place that was named before it says which place that is: `on the little table by the sofa`.
fn add_place(one: &mut Phrase, preposition: Preposition, place: Place) {
    let is_by = preposition == Preposition::Near || preposition == Preposition::At;
    let named = one.relations.last_mut().filter(|last| last.kind == RelationKind::Inside && !last.to.is_floor);
    match named {
        Some(last) if is_by && matches!(place, Place::Object(_)) => last.to.attach(preposition, place),
        _ => one.attach(preposition, place),
    }
}

/// A place with its preposition; after `or` the one before may hold for it, too.
fn place(reader: &mut Reader<'_>, before: Option<Preposition>) -> Option<(Preposition, Place)> {
    let mut read = *reader;
    let (preposition, place) = read.place().or_else(|| Some((before?, read.destination()?)))?;
    let says_where = !matches!(preposition, Preposition::To | Preposition::With | Preposition::From | Preposition::For);
    let is_known = match &place {
        Place::Object(to) => !to.namings.is_empty(),
        place => !matches!(place, Place::Viewpoints(_)),
    };
    (says_where && is_known).then(|| {
        *reader = read;
        (preposition, place)
    })
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    fn parts_of(utterance: &str) -> Option<(String, Hint)> {
        parted(&Lexicon::new(&Catalog::builtin()), utterance)
    }

    #[test]
    fn what_is_only_thought_is_parted_from_what_is_asked_for() {
        for (said, rest, places) in [
            ("Please find the mug. I think it is in the break room, on the table.", "Please find the mug.", 1),
            ("grab my mug, it should be on the shelf or the table", "grab my mug", 2),
            ("where is the hammer? I left it in the main office.", "where is the hammer?", 1),
            ("get the mug I think it's in the break room and bring it here", "", 0),
            (
                "get the mug, I'm pretty sure it's in the break room, and put it on the desk",
                "get the mug and put it on the desk",
                1,
            ),
            ("fetch the hammer, which should be in the main office", "fetch the hammer", 1),
            ("bring me the milk. Probably in the fridge!", "bring me the milk.", 1),
            ("it might still be in the fridge", "", 1),
            ("do you see a hammer? we usually keep the hammer on the desk", "do you see a hammer?", 1),
        ] {
            let found = parts_of(said);
            let places_found = found.as_ref().map_or(0, |(_, hint)| hint.places.len());
            assert_eq!(places_found, places, "{said}: {found:?}");
            assert!(places == 0 || found.as_ref().unwrap().0 == rest, "{said}: {found:?}");
        }
    }

    #[test]
    fn what_stands_by_a_place_says_which_place_that_is() {
        let said = "find the mug. I rather think I left it on the little table by the sink";
        let (rest, hint) = parts_of(said).unwrap();
        assert_eq!((rest.as_str(), hint.places.len(), hint.places[0].relations.len()), ("find the mug.", 1, 1));
        let table = &hint.places[0].relations[0];
        assert_eq!((table.kind, table.to.relations[0].kind), (RelationKind::Inside, RelationKind::Near));
    }

    #[test]
    fn facts_wishes_and_conditions_are_no_hints() {
        for said in [
            "put the mug somewhere on the desk",
            "the mug is on the desk",
            "if it should be in the fridge, bring it to me",
            "check if it might be in the drawer",
            "it should not be in the fridge",
            "it should be clean",
            "I think you should go to the break room",
            "maybe turn on the light in the break room",
            "I left the lab",
            "that is in the wrong place",
            "I believe I left my hammer on the desk. Could you pick it up?",
        ] {
            assert_eq!(parts_of(said), None, "{said}");
        }
    }
}

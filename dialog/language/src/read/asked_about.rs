//! What a question is about: the thing that its words name, or each of several.

use cohabit_cdf::state::StateFlag;

use crate::{
    read::{phrase::Phrase, reader::Reader},
    words::lexicon::{Lexicon, Preposition, Pronoun, StateWord},
};

/// The phrase that words begin with, or else the first thing that they name.
pub(crate) fn first_named(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    at_start(lexicon, words).filter(|phrase| !phrase.is_empty()).or_else(|| named(lexicon, words))
}

/// `mug is that on the table`, of `whose`: the mug on the table.
pub(crate) fn owned(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let is_joint = |word: &&String| !matches!(word.as_str(), "is" | "are" | "that" | "this" | "these" | "those");
    let named: Vec<String> = words.iter().filter(is_joint).cloned().collect();
    at_start(lexicon, &named).filter(|phrase| !phrase.namings.is_empty())
}

/// `what is its color`, `and their colors`, `colors do they have`: what these stand for.
pub(crate) fn owner(words: &[String]) -> Option<Phrase> {
    let (text, pronoun) = words.iter().find_map(|word| match word.as_str() {
        "its" | "it" => Some(("it", Pronoun::Thing)),
        "their" | "they" | "them" => Some(("them", Pronoun::Things)),
        _ => None,
    })?;
    Some(Phrase { text: text.to_owned(), pronoun: Some(pronoun), ..Phrase::default() })
}

/// The phrase that words begin with.
pub(crate) fn at_start(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    Reader::new(lexicon, words).phrase_with_place()
}

/// `computer controls the laser`: the computer for the laser.
pub(crate) fn which_works(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let (at, length) = (1..words.len()).find_map(|at| Some((at, lexicon.control_words.longest(&words[at..])?.0)))?;
    let is_spare = |word: &&String| !matches!(word.as_str(), "is" | "are" | "one");
    let thing: Vec<String> = words[..at].iter().filter(is_spare).cloned().collect();
    let mut what = Reader::new(lexicon, &thing).phrase().filter(|phrase| !phrase.namings.is_empty())?;
    let place = Reader::new(lexicon, &words[at + length..]).destination()?;
    what.attach(Preposition::For, place);
    Some(what)
}

/// `shelves do you see there`: the shelves.
pub(crate) fn which_seen(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let sees = |words: &[String]| matches!(words, [helper, you, see] if matches!(helper.as_str(), "do" | "can") && you == "you" && see == "see");
    let at = words.windows(3).position(sees)?;
    Reader::new(lexicon, &words[..at]).phrase().filter(|phrase| !phrase.namings.is_empty())
}

/// `mug is red`, `one is the biggest`: the red mug.
pub(crate) fn which_is_so(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let phrase = which_works(lexicon, words).or_else(|| which_seen(lexicon, words));
    if let Some(phrase) = phrase.or_else(|| which_is_switched(lexicon, words)) {
        return Some(phrase);
    }
    // `mug has coffee in it`: the mug with coffee in it.
    if let Some(verb) = words.iter().position(|word| matches!(word.as_str(), "has" | "have" | "contains" | "contain")) {
        let mut said = words.to_vec();
        "with".clone_into(&mut said[verb]);
        let mut reader = Reader::new(lexicon, &said);
        return reader.phrase_with_place().filter(|phrase| reader.is_done() && phrase.is_described());
    }
    let verb = words.iter().position(|word| matches!(word.as_str(), "is" | "are"))?;
    let is_joint = |word: &&String| !matches!(word.as_str(), "and" | "a" | "an" | "the");
    let said: Vec<String> = words[verb + 1..].iter().chain(&words[..verb]).filter(is_joint).cloned().collect();
    let mut reader = Reader::new(lexicon, &said);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    let is_told = phrase.color.is_some() || !phrase.states.is_empty() || phrase.side.is_some();
    (reader.is_done() && is_told).then_some(phrase)
}

/// `lights are still on`: the lights that are switched on.
pub(crate) fn which_is_switched(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let verb = words.iter().position(|word| matches!(word.as_str(), "is" | "are"))?;
    let said = lexicon.yes_no.without_fillers(&words[verb + 1..]);
    let said = said.strip_prefix(&["still".to_owned()]).unwrap_or(said);
    let is_on = match said {
        [word] if word == "on" => true,
        [word] if word == "off" => false,
        _ => return None,
    };
    let mut reader = Reader::new(lexicon, &words[..verb]);
    let mut phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    phrase.states.push(StateWord::Flag(StateFlag::Toggled, is_on));
    reader.is_done().then_some(phrase)
}

/// The first thing that the words name.
pub(crate) fn named(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    (0..words.len()).find_map(|at| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at;
        reader.phrase_with_place().filter(|phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty())
    })
}

/// `which machine is the bowl on`: where the bowl is.
pub(crate) fn which_holds(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let mut reader = Reader::new(lexicon, words);
    reader.phrase().filter(|phrase| !phrase.is_empty())?;
    if !reader.next_is("is") && !reader.next_is("are") {
        return None;
    }
    reader.at += 1;
    let about = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    let (length, _) = lexicon.prepositions.longest(reader.rest()).filter(|_| !reader.is_done())?;
    reader.at += length;
    // `which table is the can on, the round one?`
    let is_guess = |mut reader: Reader<'_>| reader.phrase().is_some() && reader.is_done();
    (reader.is_done() || is_guess(reader)).then_some(about)
}

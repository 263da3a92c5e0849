//! Second thoughts: `no, I meant the freezer`, `on the counter, sorry`, `the other one too`. The last request again, with
//! what was said now in the place of what was said then.

use crate::{
    clause::{self, Clause, Part},
    intent::Intent,
    lexicon::{Direction, Lexicon, Preposition, Pronoun, Side},
    phrase::{Phrase, Place, Reader},
    token,
};

/// Words by which people take back or go on from what they said.
const MARKERS: &[&str] = &[
    "no",
    "nope",
    "not",
    "sorry",
    "mean",
    "meant",
    "instead",
    "rather",
    "actually",
    "wait",
    "oops",
    "wrong",
    "too",
    "also",
    "well",
    "and",
    "now",
    "other",
    "said",
    "same",
    "again",
    "nah",
    "ah",
    "oh",
    "then",
    "correction",
    "but",
];

/// Words around what was said now.
const AROUND: &[&str] = &[
    "i", "meant", "mean", "said", "want", "wanted", "was", "is", "it", "that", "please", "instead", "rather", "too",
    "also", "as", "well", "sorry", "oops", "actually", "then", "wait", "do", "same", "with", "for", "the", "now",
    "one", "of", "course", "not", "wrong", "again", "no", "and", "to", "talking", "about",
];

/// The last request as it is meant now, if the words amend it.
pub(crate) fn amended(lexicon: &Lexicon, words: &[String], parts: &[Part], request: &[Clause]) -> Option<Vec<Clause>> {
    // `both`, `all of them`
    if lexicon.all.longest(words).is_some_and(|(length, ())| {
        words[length..].iter().all(|word| is_around(lexicon, word) || word == "them" || token::is_punctuation(word))
    }) {
        let mut clause = request.iter().rfind(|clause| clause.intent != Intent::Mention)?.clone();
        clause.objects.last_mut().map(|phrase| {
            phrase.is_all = true;
            phrase.chosen = None;
        })?;
        return Some(vec![clause]);
    }
    let is_new = parts.iter().any(|part| matches!(part, Part::Clause(clause) if !clause.verb.is_empty()));
    let is_marked = words.iter().any(|word| MARKERS.contains(&word.as_str()));
    if is_new || !is_marked || words.len() > LONGEST {
        return None;
    }
    let last = request.iter().rfind(|clause| clause.intent != Intent::Mention)?;
    let plain: Vec<String> = words.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
    let starts = (0..plain.len()).filter(|start| plain[..*start].iter().all(|word| is_around(lexicon, word)));
    starts.into_iter().find_map(|start| amend(lexicon, &plain[start..], last)).map(|clause| vec![clause])
}

/// More words than this are no second thought.
const LONGEST: usize = 14;

fn is_around(lexicon: &Lexicon, word: &String) -> bool {
    let word = std::slice::from_ref(word);
    AROUND.contains(&word[0].as_str()) || lexicon.talk.exact(word).is_some() || lexicon.lead.exact(word).is_some()
}

/// `last` with what the words say, if they say nothing else.
fn amend(lexicon: &Lexicon, words: &[String], last: &Clause) -> Option<Clause> {
    let mut clause = last.clone();
    let mut reader = Reader::new(lexicon, words);
    if matches!(last.intent, Intent::Turn | Intent::Travel | Intent::Look) {
        let (length, direction) = lexicon.directions.longest(words)?;
        reader.at = length;
        // A turn the wrong way is made good by turning round.
        let is_taken_back = last.intent == Intent::Turn && *direction == Direction::Around;
        (clause.direction, clause.amount) = (Some(*direction), last.amount.filter(|_| !is_taken_back));
    } else if let Some((length, color)) = lexicon.colors.longest(words).filter(|_| last.intent == Intent::Color) {
        reader.at = length;
        clause.color = Some(color.clone());
    } else if let Some((preposition, place)) = reader.place() {
        match clause.places.last_mut().filter(|_| !matches!(place, Place::Side(_))) {
            Some(slot) => *slot = (preposition, place),
            None if clause.intent == Intent::GoTo => return None,
            None => clause.objects.last_mut()?.attach(preposition, place),
        }
    } else {
        match reader.destination()? {
            Place::Object(phrase) => replace(&mut clause, phrase)?,
            place => match clause.places.last_mut()? {
                (_, slot) if matches!(slot, Place::Room(_) | Place::Object(_) | Place::Viewpoint(..)) => *slot = place,
                _ => return None,
            },
        }
        // Where it is: `the banana on the table`.
        while let Some((preposition, place)) = reader.place() {
            clause.objects.last_mut()?.attach(preposition, place);
        }
    }
    let is_whole = reader.rest().iter().all(|word| is_around(lexicon, word));
    is_whole.then_some(clause)
}

/// Puts a phrase where the last one of its kind stood; an adjective alone says more of what was named then.
fn replace(clause: &mut Clause, phrase: Phrase) -> Option<()> {
    let is_vague = phrase.pronoun.is_some_and(|pronoun| pronoun != Pronoun::One);
    if is_vague || !phrase.unknown.is_empty() || !phrase.says_something() {
        return None;
    }
    let slot = match (clause.intent, clause.objects.as_mut_slice(), clause.places.as_mut_slice()) {
        (Intent::GoTo, _, [.., (_, Place::Object(slot))]) => slot,
        (Intent::GoTo, _, [.., (_, place)]) => {
            *place = Place::Object(phrase);
            return Some(());
        }
        (_, [.., slot], _) => slot,
        (_, [], [.., (preposition, Place::Object(slot))]) if *preposition != Preposition::With => slot,
        _ => return None,
    };
    if phrase.side == Some(Side::Other) && phrase.namings.is_empty() {
        let excluded = slot.chosen.into_iter().collect();
        *slot = Phrase { chosen: None, excluded, side: Some(Side::Other), states: Vec::new(), ..slot.clone() };
        slot.color = None;
    } else if phrase.namings.is_empty() && phrase.instance.is_none() && phrase.fluid.is_none() {
        let namings = std::mem::take(&mut slot.namings);
        *slot = Phrase { namings, pronoun: None, ..phrase };
    } else {
        *slot = phrase;
    }
    Some(())
}

/// `go where the hammer is`: to the hammer.
pub(crate) fn without_where(lexicon: &Lexicon, words: Vec<String>) -> Vec<String> {
    let start = clause::leading(lexicon, &words);
    let goes = words.get(start).is_some_and(|word| GOES.contains(&word.as_str()));
    let Some(at) = words.iter().position(|word| word == "where").filter(|at| goes && *at > start) else { return words };
    let end = words[at..]
        .iter()
        .position(|word| token::is_punctuation(word) || word == "and")
        .map_or(words.len(), |skip| at + skip);
    let is_spare = |word: &&String| !PLACES.contains(&word.as_str());
    let head = words[..at].iter().rposition(|word| is_spare(&word)).map_or(0, |last| last + 1);
    let thing = &words[at + 1..end];
    let from = thing.iter().take_while(|word| KEEPERS.contains(&word.as_str())).count();
    let to = thing.iter().rposition(|word| !STANDS.contains(&word.as_str())).map_or(from, |last| last + 1);
    if from >= to {
        return words;
    }
    let to_there = ["to".to_owned()];
    words[..head].iter().chain(&to_there).chain(&thing[from..to]).chain(&words[end..]).cloned().collect()
}

/// Verbs of going, words for a place, who keeps things there, and that they are there.
const GOES: &[&str] = &[
    "go", "walk", "head", "move", "run", "drive", "come", "take", "bring", "return", "proceed", "get", "lead", "guide",
    "step",
];
const PLACES: &[&str] =
    &["to", "the", "place", "room", "spot", "over", "location", "point", "position", "area", "into", "there", "back"];
const KEEPERS: &[&str] =
    &["they", "we", "you", "people", "keep", "have", "store", "put", "got", "i", "one", "can", "find", "is", "are"];
const STANDS: &[&str] = &[
    "is", "are", "was", "stands", "stand", "sits", "lies", "lie", "located", "kept", "stored", "lives", "at", "in",
    "made", "stay", "being", "usually", "located",
];

/// `pick up the red, no, the yellow mug`: what was taken back in the same breath, left out.
pub(crate) fn without_slips(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let Some((start, end)) = slip(lexicon, words) else { return words.to_vec() };
    let (before, after) = (&words[..start], &words[end..]);
    let mut first = Reader::new(lexicon, after);
    // `on the table, no, on the counter`: from the preposition on; `the red, no, the yellow`: from the phrase on.
    let is_place = lexicon.prepositions.longest(after).is_some();
    let spans = |at: usize| {
        let mut reader = Reader::new(lexicon, before);
        reader.at = at;
        let is_one = if is_place { reader.place().is_some() } else { reader.phrase().is_some() };
        is_one && reader.is_done() && !Reader { at, ..reader }.at_verb()
    };
    let has_phrase = if is_place { first.place().is_some() } else { first.phrase().is_some() };
    let verb = lexicon.verbs.longest(after).is_some();
    match (0..before.len()).find(|at| spans(*at)).filter(|_| has_phrase && !verb) {
        Some(at) => {
            let mut words: Vec<String> = before[..at].iter().chain(after).cloned().collect();
            // `the red mug, I mean the yellow one`: a mug still.
            let noun = (at..before.len()).find(|at| lexicon.classes.exact(&before[*at..]).is_some());
            if let Some(noun) = noun
                && let Some(one) = words.iter().skip(at).position(|word| word == "one").map(|skip| at + skip)
            {
                words.splice(one..=one, before[noun..].iter().cloned());
            }
            words
        }
        None => words.to_vec(),
    }
}

/// Where somebody takes back what was just said: from there, to what is said instead.
fn slip(lexicon: &Lexicon, words: &[String]) -> Option<(usize, usize)> {
    let start = (1..words.len()).find(|at| {
        let is_marker = matches!(
            words[*at].as_str(),
            "no" | "sorry" | "rather" | "actually" | "wait" | "correction" | "oops" | "mean" | "nope" | "meant"
        ) || words[*at] == "i"
            && words.get(at + 1).is_some_and(|word| matches!(word.as_str(), "mean" | "meant"));
        let before = words[at - 1].as_str();
        is_marker
            && (matches!(before, "," | "or" | "uh" | "er" | "um" | "erm" | ".")
                || words[*at] == "i"
                || words[*at] == "no")
    })?;
    let skipped = words[start..].iter().take_while(|word| {
        *word == ","
            || matches!(
                word.as_str(),
                "no" | "i"
                    | "mean"
                    | "meant"
                    | "sorry"
                    | "rather"
                    | "actually"
                    | "wait"
                    | "correction"
                    | "oops"
                    | "nope"
                    | "not"
                    | "that"
                    | "or"
                    | "uh"
                    | "er"
                    | "um"
                    | "erm"
            )
    });
    let end = start + skipped.count();
    let is_spare = |word: &str| word == "," || matches!(word, "or" | "uh" | "er" | "um" | "erm");
    let cut = words[..start].iter().rposition(|word| !is_spare(word)).map_or(0, |at| at + 1);
    (end < words.len() && cut > 0 && !clause::is_negation(lexicon, &words[start..end])).then_some((cut, end))
}

//! Goals instead of steps: what is wished for, said as the request that brings it about.
//! `i want the mug to be hot` → `heat the mug`; `the green desk needs the hammer on it` → `put the hammer on the green desk`.

use crate::{
    chatter,
    inflect::{self, stem},
    lexicon::{Lexicon, Preposition},
    phrase::Reader,
};

/// Words that may stand before a verb of wishing: who wishes, and how much.
const WISHERS: &[&str] = &[
    "i",
    "we",
    "he",
    "she",
    "they",
    "you",
    "my",
    "the",
    "boss",
    "manager",
    "would",
    "really",
    "just",
    "do",
    "also",
    "still",
    "will",
    "might",
    "now",
    "am",
    "in",
    "everybody",
    "everyone",
    "somebody",
    "someone",
    "could",
];
const WISHES: &[&str] =
    &["want", "wants", "need", "needs", "like", "love", "prefer", "require", "requires", "desire", "use"];

/// Words that say that something must be so.
const MUSTS: &[&[&str]] = &[
    &["needs", "to"],
    &["need", "to"],
    &["needs"],
    &["need"],
    &["should"],
    &["must"],
    &["has", "to"],
    &["have", "to"],
    &["ought", "to"],
    &["is", "to"],
    &["are", "to"],
    &["wants", "to"],
    &["is", "supposed", "to"],
    &["could", "use"],
    &["belongs"],
    &["belong"],
    &["goes"],
    &["go"],
    &["gets"],
    &["requires"],
    &["better"],
    &["shall"],
];

/// Verbs that make something be so.
const MAKERS: &[&str] = &["make", "get", "keep", "have", "turn", "let", "render", "bring"];
/// Verbs by which people order something to drink or to eat.
const ORDERS: &[&str] = &[
    "make", "brew", "do", "prepare", "get", "give", "bring", "have", "fetch", "fix", "pour", "serve", "cook",
    "produce", "hand",
];
/// What a drink comes in, and how much of it.
const MEASURES: &[&str] = &[
    "cup", "mug", "glass", "pot", "bit", "drop", "splash", "some", "a", "an", "of", "nice", "hot", "fresh", "little",
    "cold", "good", "more", "quick", "big", "bowl",
];
/// Words between a thing and what it is to be.
const BETWEEN: &[&str] = &[
    "to",
    "be",
    "get",
    "become",
    "go",
    "being",
    "really",
    "very",
    "nice",
    "and",
    "all",
    "completely",
    "again",
    "nicely",
    "as",
    "so",
    "properly",
    "a",
    "bit",
    "quite",
    "just",
    "super",
    "stay",
    "look",
    "fully",
    "totally",
    "go",
];
/// What follows a thing that is to be so, at most.
const AFTER: &[&str] = &["again", "please", "for", "now", "me", "us", "first", "then", "too", "robot", "today", "asap"];

/// The request that a wish at the start of `words` comes to, and how many words the wish took.
pub(crate) fn request(lexicon: &Lexicon, words: &[String]) -> Option<(Vec<String>, usize)> {
    let chunk = until_next(lexicon, chatter::chunk(words));
    let wished = wanted(lexicon, chunk)
        .or_else(|| ordered(lexicon, chunk))
        .or_else(|| made(lexicon, chunk))
        .or_else(|| given(lexicon, chunk))
        .or_else(|| asked(lexicon, chunk))
        .or_else(|| required(lexicon, chunk))?;
    Some((wished, chunk.len()))
}

/// The words up to `and`, `so` or `but` before a request of its own.
fn until_next<'a>(lexicon: &Lexicon, words: &'a [String]) -> &'a [String] {
    let end = (0..words.len()).find(|at| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at + 1;
        let is_joint = matches!(words[*at].as_str(), "and" | "so" | "but" | "then");
        reader.skip(|lexicon| &lexicon.lead);
        is_joint && reader.at_verb()
    });
    &words[..end.unwrap_or(words.len())]
}

/// `i want …`, `my boss would like …`.
fn wanted(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let at = words.iter().position(|word| !WISHERS.contains(&word.as_str()))?;
    let is_wish = WISHES.contains(&words[at].as_str())
        && (!matches!(words[at].as_str(), "like" | "love" | "use")
            || at > 0 && matches!(words[at - 1].as_str(), "would" | "really" | "could" | "will"));
    if !is_wish || at == 0 && !words[0].ends_with('s') && words[0] != "need" && words[0] != "want" {
        return None;
    }
    let rest = &words[at + 1..];
    if let Some(drink) = drink(lexicon, rest) {
        return Some(drink);
    }
    let (thing, after) = thing(lexicon, rest)?;
    become_so(lexicon, thing, after).or_else(|| {
        let is_end = after.iter().all(|word| AFTER.contains(&word.as_str()));
        is_end.then(|| joined(&[&["get"], &texts(thing)]))
    })
}

/// `make me a cup of coffee`, `let us have toast`.
fn ordered(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !ORDERS.contains(&first.as_str()) {
        return None;
    }
    let skipped = rest.iter().take_while(|word| matches!(word.as_str(), "me" | "us" | "him" | "her" | "up")).count();
    let rest = &rest[skipped..];
    let has_measure =
        rest.iter().take(3).any(|word| matches!(word.as_str(), "glass" | "cup" | "mug" | "drop" | "splash" | "pot"));
    let is_made = matches!(first.as_str(), "make" | "brew" | "do" | "prepare" | "have" | "cook" | "fix" | "produce");
    let is_coffee = rest.iter().take(3).any(|word| word == "coffee") && rest.first().is_some_and(|word| word != "the");
    let is_some = rest.first().is_some_and(|word| word == "some") && rest.get(1).is_some_and(|word| word == "water");
    (is_made || has_measure || is_coffee || is_some).then(|| drink(lexicon, rest)).flatten()
}

/// Something to drink or to eat that has to be made.
fn drink(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let measured = words.iter().take_while(|word| MEASURES.contains(&word.as_str())).count();
    let rest = &words[measured..];
    let (length, after) = match rest.first()?.as_str() {
        "toast" => (1, &rest[1..]),
        _ => {
            let (length, _) = lexicon.fluids.longest(rest)?;
            let noun = lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
            (length, rest.get(length..).filter(|_| noun <= length)?)
        }
    };
    let what = rest[..length].join(" ");
    let into = after.first().is_some_and(|word| matches!(word.as_str(), "in" | "into" | "to")) && after.len() > 1;
    if !into && !after.iter().all(|word| AFTER.contains(&word.as_str())) {
        return None;
    }
    let place: Vec<&str> = if into { texts(&after[1..]) } else { vec!["a", "mug"] };
    Some(match what.as_str() {
        "toast" => joined(&[&["toast", "the", "bread"]]),
        "milk" if into => joined(&[&["pour", "the", "milk", "into"], &place]),
        "milk" => return None,
        _ if what.ends_with("coffee") && !into => joined(&[&["make", "coffee"]]),
        _ => joined(&[&["fill"], &place, &["with"], &texts(&rest[..length])]),
    })
}

/// `make it whole again`, `get the bowl really cold`.
fn made(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !MAKERS.contains(&first.as_str()) {
        return None;
    }
    let (thing, after) = thing(lexicon, rest)?;
    let skipped = after.iter().take_while(|word| BETWEEN.contains(&word.as_str())).count();
    let (request, left) = state(lexicon, &after[skipped..])?;
    finish(request, thing, left)
}

/// `give it a wash`.
fn given(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    if !matches!(first.as_str(), "give" | "have" | "do") {
        return None;
    }
    let (thing, after) = thing(lexicon, rest)?;
    let skipped = after
        .iter()
        .take_while(|word| {
            matches!(
                word.as_str(),
                "a" | "an" | "another" | "good" | "quick" | "nice" | "little" | "proper" | "thorough"
            )
        })
        .count();
    let verb = after.get(skipped).filter(|_| skipped > 0)?;
    let verb = match verb.as_str() {
        "bath" | "shower" | "cleaning" | "washing" => "wash",
        other => other,
    };
    lexicon.verbs.exact(&[verb.to_owned()])?;
    Some(joined(&[&[verb], &texts(thing), &texts(&after[skipped + 1..])]))
}

/// `can the mug be heated`.
fn asked(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (first, rest) = words.split_first()?;
    let may = matches!(first.as_str(), "can" | "could" | "would" | "will" | "should" | "may" | "might" | "shall");
    let (thing, after) = thing(lexicon, rest).filter(|_| may)?;
    let is_passive = after.first().is_some_and(|word| matches!(word.as_str(), "be" | "get" | "go"));
    is_passive.then(|| become_so(lexicon, thing, after)).flatten()
}

/// `the plate needs to be cleaned`, `the trophy belongs on the blue desk`.
fn required(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let (thing, after) = thing(lexicon, words)?;
    let must =
        MUSTS.iter().find(|must| after.len() > must.len() && after.iter().zip(must.iter()).all(|(a, b)| a == b))?;
    let after = &after[must.len()..];
    if let Some(request) = become_so(lexicon, thing, after) {
        return Some(request);
    }
    // `the desk needs the hammer on it`
    let mut reader = Reader::new(lexicon, after);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty())?;
    let (part, left) = after.split_at(reader.at);
    match left {
        [preposition, it, ..] if matches!(it.as_str(), "it" | "there") && phrase.unknown.is_empty() => {
            Some(joined(&[&["put"], &texts(part), &[preposition.as_str()], &texts(thing)]))
        }
        [word, more @ ..] if matches!(word.as_str(), "inside" | "in") && more.is_empty() => {
            Some(joined(&[&["put"], &texts(part), &["in"], &texts(thing)]))
        }
        // `the mug needs a wash`, `the bowl needs water`
        _ => None,
    }
}

/// What is to be done for `thing` to become what `after` says.
fn become_so(lexicon: &Lexicon, thing: &[String], after: &[String]) -> Option<Vec<String>> {
    let skipped = after.iter().take_while(|word| BETWEEN.contains(&word.as_str())).count();
    let rest = &after[skipped..];
    if let Some((request, left)) = state(lexicon, rest).or_else(|| participle(lexicon, rest)) {
        return finish(request, thing, left);
    }
    let mut reader = Reader::new(lexicon, rest);
    match reader.place()? {
        (Preposition::In | Preposition::On | Preposition::At | Preposition::Near | Preposition::To, _) => {
            let is_fluid = lexicon.fluids.longest(inner(lexicon, thing)).is_some();
            let verb = if is_fluid { "pour" } else { "put" };
            Some(joined(&[&[verb], &texts(thing), &texts(rest)]))
        }
        _ => None,
    }
}

/// The verb that brings a state about: its words, and what follows.
fn state<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(Vec<String>, &'a [String])> {
    let (length, verb) = lexicon.brings_about.longest(words)?;
    let left = &words[length..];
    let is_end = left.iter().all(|word| AFTER.contains(&word.as_str())) || lexicon.prepositions.longest(left).is_some();
    is_end.then(|| (verb.clone(), left))
}

/// `cleaned`, `picked up`, `filled` as the verb they come from.
fn participle<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(Vec<String>, &'a [String])> {
    let (first, rest) = words.split_first()?;
    let verb = stem(lexicon, first).or_else(|| (inflect::is_verb(lexicon, first)).then(|| first.clone()))?;
    if let Some(particle) = rest.first() {
        let whole = [verb.clone(), particle.clone()];
        if lexicon.verbs.exact(&whole).is_some() && !matches!(particle.as_str(), "to" | "in" | "into") {
            return Some((whole.to_vec(), &rest[1..]));
        }
    }
    Some((vec![verb], rest))
}

/// The verb, the thing, and what follows it.
fn finish(verb: Vec<String>, thing: &[String], left: &[String]) -> Option<Vec<String>> {
    let left = if left.iter().all(|word| AFTER.contains(&word.as_str())) { &[][..] } else { left };
    Some(joined(&[&texts(&verb), &texts(thing), &texts(left)]))
}

/// The noun phrase at the start, with what describes it by `that is`, and what follows.
fn thing<'a>(lexicon: &Lexicon, words: &'a [String]) -> Option<(&'a [String], &'a [String])> {
    let mut reader = Reader::new(lexicon, words);
    let phrase = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    let _ = phrase;
    Some(words.split_at(reader.at))
}

fn inner<'a>(lexicon: &Lexicon, words: &'a [String]) -> &'a [String] {
    let skipped = words.iter().take_while(|word| lexicon.articles.exact(std::slice::from_ref(*word)).is_some()).count();
    &words[skipped..]
}

fn texts(words: &[String]) -> Vec<&str> {
    words.iter().map(String::as_str).collect()
}

fn joined(parts: &[&[&str]]) -> Vec<String> {
    parts.iter().flat_map(|part| part.iter().map(|word| (*word).to_owned())).collect()
}

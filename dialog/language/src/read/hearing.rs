//! What may have been said instead of what was heard: words that make no sense where they stand, and words that sound
//! like them and do.

use std::collections::BTreeSet;

use cohabit_cdf::Catalog;

use crate::{
    read::{chatter, clause::Part, parts, question},
    words::{intent::Intent, lexicon::Lexicon, question_kind::QuestionKind, sound, token::is_punctuation},
};

/// At most so many readings are tried, and so many words in place of one.
const MOST_READINGS: usize = 24;
const MOST_WORDS: usize = 8;
/// At most so many words were heard for one, which has more letters than this.
const MOST_JOINED: usize = 3;
const SHORTEST_JOINED: usize = 4;
/// So many names of several words, and so many letters with a number, are tried in one place.
const MOST_NAMES: usize = 2;
const MOST_CODES: usize = 2;
/// Longer utterances are not guessed at, nor what has more strange words than this.
const LONGEST: usize = 24;
const MOST_STRANGE: usize = 4;

/// Other words that may stand at a place: how many they replace, which, and how different they sound.
struct Guess {
    at: usize,
    length: usize,
    word: String,
    cost: f32,
    /// Whether so little was to be heard of it that one had better ask.
    is_doubtful: bool,
}

/// What may have been said.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heard {
    pub(crate) words: Vec<String>,
    pub(crate) is_doubtful: bool,
}

/// Whether something in the words made no sense.
pub(crate) fn is_puzzled(parts: &[Part], words: &[String]) -> bool {
    parts.iter().any(|part| match part {
        // `turn write`: a turn that nobody said the way of.
        Part::Clause(clause)
            if clause.intent == Intent::Turn && clause.direction.is_none() && clause.amount.is_none() =>
        {
            clause.places.is_empty() && words.len() > 1
        }
        Part::Clause(clause) if clause.intent == Intent::Impossible => false,
        Part::Clause(clause) => !chatter::is_clear(clause) || clause.has_stray_noun || !clause.unknown.is_empty(),
        Part::Unclear(_) => true,
        Part::Aside(_) => !parts.iter().any(|part| matches!(part, Part::Clause(_))),
        Part::Fragment(phrase) | Part::Mention(phrase) => !phrase.unknown.is_empty(),
        Part::Forbidden(_) => false,
    })
}

/// What may have been said, the likeliest first; each makes sense as it stands.
pub(crate) fn readings(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Vec<Heard> {
    let strange = words.iter().filter(|word| is_strange(lexicon, word)).count();
    if words.len() > LONGEST || strange > MOST_STRANGE {
        return Vec::new();
    }
    let mut guesses = guesses(lexicon, words);
    guesses.sort_by(|one, other| {
        one.cost.total_cmp(&other.cost).then(one.at.cmp(&other.at)).then(one.word.cmp(&other.word))
    });
    let mut readings: Vec<(f32, Vec<String>, bool)> =
        guesses.iter().map(|guess| (guess.cost, with(words, &[guess]), guess.is_doubtful)).collect();
    for (index, one) in guesses.iter().enumerate().take(MOST_READINGS) {
        for other in guesses[index + 1..].iter().take(MOST_READINGS) {
            let is_apart = one.at + one.length <= other.at || other.at + other.length <= one.at;
            if is_apart {
                let is_doubtful = one.is_doubtful || other.is_doubtful;
                readings.push((one.cost + other.cost + PAIR, with(words, &[one, other]), is_doubtful));
            }
        }
    }
    readings.sort_by(|(one, a, _), (other, b, _)| one.total_cmp(other).then_with(|| a.cmp(b)));
    let mut sensible: Vec<Heard> = Vec::new();
    for (cost, reading, is_doubtful) in readings.into_iter().take(MOST_TRIED) {
        let reading = lexicon.replaced(&reading);
        let makes_sense = asks(lexicon, catalog, &reading) || cost <= NEARLY && is_question(lexicon, &reading);
        if makes_sense && sensible.iter().all(|known| known.words != reading) {
            sensible.push(Heard { words: reading, is_doubtful });
        }
        if sensible.len() == MOST_READINGS / 4 {
            break;
        }
    }
    sensible
}

/// Whether it is a request, and makes sense.
fn asks(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> bool {
    let parts = parts::parts(lexicon, catalog, words);
    let stops = |part: &Part| matches!(part, Part::Clause(clause) if clause.intent == Intent::Stop);
    let asks = parts.iter().any(|part| matches!(part, Part::Clause(_)));
    // `hit the road` is no `hit the red`.
    let names = |part: &Part| match part {
        Part::Clause(clause) => clause.objects.iter().all(|phrase| !phrase.is_empty()),
        _ => true,
    };
    asks && !is_puzzled(&parts, words) && !parts.iter().any(stops) && parts.iter().all(names)
}

/// What may have been said instead, of words that make no request: the likeliest first.
pub(crate) fn variants(lexicon: &Lexicon, words: &[String]) -> Vec<Vec<String>> {
    let mut guesses = guesses(lexicon, words);
    guesses.sort_by(|one, other| {
        one.cost.total_cmp(&other.cost).then(one.at.cmp(&other.at)).then(one.word.cmp(&other.word))
    });
    guesses.iter().take(MOST_WORDS).map(|guess| with(words, &[guess])).collect()
}

fn is_question(lexicon: &Lexicon, words: &[String]) -> bool {
    question::read(lexicon, words).is_some_and(|question| question.kind != QuestionKind::Unknown)
}

/// What sounds the same: `brake`.
const HOMOPHONE: f32 = 0.02;
/// What sounds all but the same.
const SAME: f32 = 0.36;
/// What an ordinary word, which people say as well, may differ by.
const NEARLY: f32 = 0.5;
/// What an ordinary word may differ by, for each of its sounds.
const ORDINARY_EACH: f32 = 0.14;
/// What two slips at once cost more than each.
const PAIR: f32 = 0.5;
/// So many readings are looked at.
const MOST_TRIED: usize = 40;

fn guesses(lexicon: &Lexicon, words: &[String]) -> Vec<Guess> {
    let mut guesses = Vec::new();
    let has_strange = words.iter().any(|word| is_strange(lexicon, word));
    for at in 0..words.len() {
        // A verb is misheard where a request begins, not within talk.
        let begins =
            at == 0 || lexicon.chatter.before_requests.contains(&words[at - 1]) || is_punctuation(&words[at - 1]);
        for length in 1..=MOST_JOINED.min(words.len() - at) {
            let heard = &words[at..at + length];
            let guess = |cost, word: &str, is_doubtful| Guess { at, length, word: word.to_owned(), cost, is_doubtful };
            let codes = lexicon.misheard.codes(heard).into_iter().filter(|(_, code)| heard.join(" ") != **code);
            guesses.extend(codes.take(MOST_CODES).map(|(cost, code)| guess(cost, code, true)));
            if !is_spoken(&heard[length - 1]) {
                break;
            }
            if length == 1 {
                guesses.extend(lexicon.misheard.small(&heard[0], begins).map(|(cost, word)| guess(cost, word, false)));
            }
            let is_odd = heard.iter().any(|word| !lexicon.vocabulary.is_word(word));
            let names = lexicon.misheard.names(heard, is_odd).into_iter().filter(|(_, name)| heard.join(" ") != **name);
            guesses.extend(names.take(MOST_NAMES).map(|(cost, name)| guess(cost, name, false)));
            let limit =
                if length == 1 { limit_of(lexicon, &heard[0], has_strange) } else { joined_limit(lexicon, heard) };
            if limit == 0.0 {
                continue;
            }
            let is_english = heard.iter().all(|word| lexicon.vocabulary.is_ordinary(word));
            // No verb that changes things is made of others, and none at all of a verb that the robot merely does not know.
            let may_be = |cost: f32, meant: &str| {
                !lexicon.verb_heads.contains(meant)
                    || lexicon.is_noun(meant)
                    || cost <= HOMOPHONE
                    || !lexicon.risky_verbs.contains(meant) && cost <= NEARLY && !is_english
            };
            let fits = |(cost, meant): &(f32, &str)| {
                *cost <= limit
                    && may_be(*cost, meant)
                    && !heard.iter().any(|word| word == meant)
                    && (length == 1 && begins || !lexicon.verb_heads.contains(*meant) || lexicon.is_noun(meant))
                    && (length == 1 || meant.len() > SHORTEST_JOINED)
            };
            let found = alike(lexicon, heard).into_iter().filter(fits).take(if length == 1 { MOST_WORDS } else { 2 });
            guesses.extend(found.map(|(cost, word)| guess(cost, word, false)));
        }
    }
    guesses
}

/// How differently what was meant may sound. Where a word is not known it is the one that was misheard; the others are,
/// if they sound all but the same.
fn limit_of(lexicon: &Lexicon, word: &str, has_strange: bool) -> f32 {
    match (has_strange, is_strange(lexicon, word), lexicon.vocabulary.is_plain(word)) {
        _ if lexicon.is_small_word(word) => 0.0,
        _ if lexicon.vocabulary.is_ordinary(word) => ordinary_limit(&[word.to_owned()]),
        (true, true, false) => f32::INFINITY,
        (true, true, true) => NEARLY,
        _ => SAME,
    }
}

/// The same of what was heard as several words: `where house`, `fridge rater`, `Mike row wave`.
fn joined_limit(lexicon: &Lexicon, heard: &[String]) -> f32 {
    let is_odd = |word: &String| is_strange(lexicon, word) && !lexicon.vocabulary.is_ordinary(word);
    match heard.iter().any(is_odd) {
        _ if heard.iter().all(|word| lexicon.is_small_word(word)) => 0.0,
        true => f32::INFINITY,
        false if heard.iter().any(|word| is_strange(lexicon, word)) => ordinary_limit(heard),
        false => SAME,
    }
}

/// What a recogniser takes for ordinary words sounds much like them: else they were said, and mean nothing here.
fn ordinary_limit(heard: &[String]) -> f32 {
    ORDINARY_EACH * heard.iter().map(|word| sound::sounds(word).len()).sum::<usize>() as f32
}

fn is_strange(lexicon: &Lexicon, word: &str) -> bool {
    is_spoken(word) && !lexicon.vocabulary.has(word)
}

/// The words that sound like what was heard, the likest first.
fn alike<'a>(lexicon: &'a Lexicon, heard: &[String]) -> Vec<(f32, &'a str)> {
    let mut apart: Vec<char> = heard.iter().flat_map(|word| sound::sounds(word)).collect();
    apart.dedup();
    let together = sound::sounds(&heard.concat());
    let mut found = lexicon.sounds.alike(&apart);
    if together != apart {
        found.extend(lexicon.sounds.alike(&together));
    }
    found.sort_by(|(one, a), (other, b)| one.total_cmp(other).then(a.cmp(b)));
    let mut known = BTreeSet::new();
    found.retain(|(_, word)| known.insert(*word));
    found
}

fn is_spoken(word: &str) -> bool {
    word.chars().all(|character| character.is_ascii_alphabetic())
}

fn with(words: &[String], guesses: &[&Guess]) -> Vec<String> {
    let mut result = Vec::with_capacity(words.len());
    let mut at = 0;
    while at < words.len() {
        match guesses.iter().find(|guess| guess.at == at) {
            Some(guess) => {
                result.extend(guess.word.split(' ').map(str::to_owned));
                at += guess.length;
            }
            None => {
                result.push(words[at].clone());
                at += 1;
            }
        }
    }
    result
}

//! What may have been said instead of what was heard: words that make no sense where they stand, and words that sound
//! like them and do.

use cohabit_cdf::Catalog;

use crate::{
    chatter,
    clause::{self, Part},
    intent::Intent,
    lexicon::Lexicon,
    sound,
};

/// At most so many readings are tried, and so many words in place of one.
const MOST_READINGS: usize = 24;
const MOST_WORDS: usize = 8;
/// Longer utterances are not guessed at.
const LONGEST: usize = 24;

/// Other words that may stand at a place: how many they replace, which, and how different they sound.
struct Guess {
    at: usize,
    length: usize,
    word: String,
    cost: f32,
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
        Part::Forbidden => false,
    })
}

/// What may have been said, the likeliest first; each makes sense as it stands.
pub(crate) fn readings(lexicon: &Lexicon, catalog: &Catalog, words: &[String]) -> Vec<Vec<String>> {
    if words.len() > LONGEST {
        return Vec::new();
    }
    let mut guesses = guesses(lexicon, words);
    guesses.sort_by(|one, other| {
        one.cost.total_cmp(&other.cost).then(one.at.cmp(&other.at)).then(one.word.cmp(&other.word))
    });
    let mut readings: Vec<(f32, Vec<String>)> =
        guesses.iter().map(|guess| (guess.cost, with(words, &[guess]))).collect();
    for (index, one) in guesses.iter().enumerate().take(MOST_READINGS) {
        for other in guesses[index + 1..].iter().take(MOST_READINGS) {
            let is_apart = one.at + one.length <= other.at || other.at + other.length <= one.at;
            if is_apart {
                readings.push((one.cost + other.cost + PAIR, with(words, &[one, other])));
            }
        }
    }
    readings.sort_by(|(one, a), (other, b)| one.total_cmp(other).then_with(|| a.cmp(b)));
    let mut sensible: Vec<Vec<String>> = Vec::new();
    for (_, reading) in readings.into_iter().take(MOST_TRIED) {
        let reading = lexicon.replaced(&reading);
        let parts = clause::parts(lexicon, catalog, &reading);
        let stops = |part: &Part| matches!(part, Part::Clause(clause) if clause.intent == Intent::Stop);
        let asks = parts.iter().any(|part| matches!(part, Part::Clause(_)));
        if asks && !is_puzzled(&parts, &reading) && !parts.iter().any(stops) && !sensible.contains(&reading) {
            sensible.push(reading);
        }
        if sensible.len() == MOST_READINGS / 4 {
            break;
        }
    }
    sensible
}

/// What sounds all but the same.
const SAME: f32 = 0.36;
/// What an ordinary word, which people say as well, may differ by.
const NEARLY: f32 = 0.5;
/// What two slips at once cost more than each.
const PAIR: f32 = 0.5;
/// So many readings are looked at.
const MOST_TRIED: usize = 40;

fn guesses(lexicon: &Lexicon, words: &[String]) -> Vec<Guess> {
    let mut guesses = Vec::new();
    let is_strange = |word: &String| is_spoken(word) && !lexicon.vocabulary.has(word);
    let has_strange = words.iter().any(is_strange);
    for at in 0..words.len() {
        let word = &words[at];
        // Where a word is not known it is the one that was misheard; the others are, if they sound all but the same.
        let limit = match (has_strange, is_strange(word), lexicon.vocabulary.is_plain(word)) {
            (true, true, false) => f32::INFINITY,
            (true, true, true) => NEARLY,
            _ => SAME,
        };
        if is_spoken(word) && !lexicon.is_small_word(word) {
            let heard = sound::sounds(word);
            // A verb is misheard where a request begins, not within talk.
            let begins =
                at == 0 || matches!(words[at - 1].as_str(), "," | "." | "and" | "then" | "please" | "you" | "to");
            let found = alike(lexicon, &heard, word)
                .into_iter()
                .filter(|(cost, meant)| *cost <= limit && (begins || !lexicon.verb_heads.contains(meant)));
            guesses.extend(found.map(|(cost, word)| Guess { at, length: 1, word, cost }));
        }
        // `where house`: heard as two words.
        if let Some(next) = words.get(at + 1).filter(|next| is_spoken(word) && is_spoken(next)) {
            let whole = format!("{word}{next}");
            let heard = sound::sounds(&whole);
            let limit = if is_strange(word) || is_strange(next) { f32::INFINITY } else { SAME };
            let fits = |(cost, meant): &(f32, String)| {
                meant.len() > 4 && *cost <= limit && !lexicon.is_small_word(word) && !lexicon.verb_heads.contains(meant)
            };
            let found = alike(lexicon, &heard, &whole).into_iter().filter(fits).take(2);
            guesses.extend(found.map(|(cost, word)| Guess { at, length: 2, word, cost }));
        }
    }
    guesses
}

/// The words that sound like what was heard, the likest first.
fn alike(lexicon: &Lexicon, heard: &Vec<char>, word: &str) -> Vec<(f32, String)> {
    let mut found: Vec<(f32, &String)> = lexicon
        .sounds
        .iter()
        .filter(|(known, _)| known.as_str() != word)
        .filter_map(|(known, sounds)| sound::difference(heard, sounds).map(|cost| (cost, known)))
        .collect();
    found.sort_by(|(one, a), (other, b)| one.total_cmp(other).then(a.cmp(b)));
    found.into_iter().take(MOST_WORDS).map(|(cost, word)| (cost, word.clone())).collect()
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
                result.push(guess.word.clone());
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

//! The words of a text with the pauses between them, as far as a stop is looked for: run together, drawn out or mistyped as they may be.

use std::ops::Range;

use crate::{stop::words::Words, words::spelling::distance};

/// Words beyond these are not listened to.
const MOST_WORDS: usize = 400;
/// Fewest letters of a word in which slips are repaired, and of several that were run together.
const SHORTEST_SLIP: usize = 3;
const SHORTEST_JOINED: usize = 5;

/// A word of a text.
#[derive(Clone, Debug)]
pub(crate) struct Token {
    pub(crate) word: String,
    /// Where it is in the text, bytes.
    pub(crate) from: usize,
    /// What stands between it and the word before.
    pub(crate) pause: Pause,
}

/// What stands between two words.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Pause {
    None,
    /// A comma or a dash.
    Short,
    /// The end of a sentence.
    Long,
    /// The same, with an exclamation mark.
    Exclaimed,
}

fn pause_of(mark: char) -> Option<Pause> {
    match mark {
        ',' | ':' | '—' | '–' | '(' | ')' | '*' | '/' => Some(Pause::Short),
        '.' | '?' | ';' | '\n' | '…' => Some(Pause::Long),
        '!' => Some(Pause::Exclaimed),
        _ => None,
    }
}

pub(crate) fn tokens(words: &Words, text: &str) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    let (mut word, mut from, mut pause) = (String::new(), 0, Pause::None);
    let mut characters = text.char_indices().chain([(text.len(), ' ')]).peekable();
    while let Some((at, character)) = characters.next() {
        let is_sign = words.same.contains_key(character.encode_utf8(&mut [0; 4]) as &str);
        if character.is_alphanumeric() || is_sign {
            if word.is_empty() {
                from = at;
            }
            word.extend(character.to_lowercase());
            continue;
        }
        let follows = characters.peek().is_some_and(|(_, next)| next.is_alphanumeric());
        if matches!(character, '\'' | '’' | '‘' | '`') || character == '.' && follows && is_number(&word) {
            continue;
        }
        if !word.is_empty() {
            push(words, &mut tokens, std::mem::take(&mut word), from, std::mem::replace(&mut pause, Pause::None));
        }
        let is_dash = character == '-' && !follows;
        pause = pause.max(pause_of(character).unwrap_or(if is_dash { Pause::Short } else { Pause::None }));
        if tokens.len() > MOST_WORDS {
            break;
        }
    }
    spelt_out(words, tokens)
}

pub(crate) fn is_number(word: &str) -> bool {
    word.starts_with(|first: char| first.is_ascii_digit())
}

fn push(words: &Words, tokens: &mut Vec<Token>, word: String, from: usize, pause: Pause) {
    let parts = parts(words, &word).unwrap_or_else(|| vec![meant(words, word)]);
    for (at, word) in parts.into_iter().enumerate() {
        tokens.push(Token { word, from, pause: if at == 0 { pause } else { Pause::None } });
    }
}

/// The word that was meant: drawn out, mistyped or spelt otherwise.
fn meant(words: &Words, word: String) -> String {
    if let Some(same) = words.same.get(&word) {
        return same.clone();
    }
    if word.len() < SHORTEST_SLIP || words.has(&word) || !word.chars().all(|letter| letter.is_ascii_alphabetic()) {
        return word;
    }
    let single = squeezed(&word);
    let drawn = words.drawn.iter().find(|known| single.len() < word.len() && squeezed(known) == single);
    let slip = |known: &&String| distance(word.as_bytes(), known.as_bytes()) == 1;
    let swap = |known: &&String| known.len() == word.len() && slip(known) && is_reordered(&word, known);
    let found = drawn.or_else(|| words.swapped.iter().find(swap)).or_else(|| words.mistyped.iter().find(slip));
    found.cloned().unwrap_or_else(|| words.same.get(&single).cloned().unwrap_or(word))
}

/// `stooop` as `stop`.
fn squeezed(word: &str) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    letters.dedup();
    letters.into_iter().collect()
}

fn is_reordered(one: &str, other: &str) -> bool {
    let sorted = |word: &str| {
        let mut letters = word.as_bytes().to_vec();
        letters.sort_unstable();
        letters
    };
    sorted(one) == sorted(other)
}

/// `stopit`: the words that were run together.
fn parts(words: &Words, word: &str) -> Option<Vec<String>> {
    if word.len() < SHORTEST_JOINED || word.len() > 40 || !word.is_ascii() || words.has(word) {
        return None;
    }
    // The words up to each letter.
    let mut best: Vec<Option<Vec<String>>> = vec![None; word.len() + 1];
    best[0] = Some(Vec::new());
    for end in 1..=word.len() {
        best[end] = (0..end).find_map(|start| {
            let before = best[start].as_ref()?;
            let part = words.joined.get(&word[start..end])?;
            Some(before.iter().chain([part]).cloned().collect())
        });
    }
    best.pop().flatten().filter(|parts| parts.len() > 1)
}

/// `s t o p` as one word.
fn spelt_out(words: &Words, tokens: Vec<Token>) -> Vec<Token> {
    let mut result: Vec<Token> = Vec::with_capacity(tokens.len());
    let mut at = 0;
    while at < tokens.len() {
        let letters = tokens[at..].iter().take_while(|token| token.word.chars().count() == 1).count();
        let word: String = tokens[at..at + letters].iter().map(|token| token.word.as_str()).collect();
        if words.core.contains(&word) {
            result.push(Token { word, ..tokens[at].clone() });
            at += letters;
        } else {
            result.push(tokens[at].clone());
            at += 1;
        }
    }
    result
}

/// The words between two pauses.
#[derive(Clone, Debug)]
pub(crate) struct Clause {
    pub(crate) words: Range<usize>,
    /// The pauses before and after it.
    pub(crate) before: Pause,
    pub(crate) after: Pause,
}

pub(crate) fn clauses(tokens: &[Token]) -> Vec<Clause> {
    let mut starts: Vec<usize> = (0..tokens.len()).filter(|at| *at == 0 || tokens[*at].pause > Pause::None).collect();
    starts.push(tokens.len());
    let pause = |at: usize| tokens.get(at).map_or(Pause::Long, |token| token.pause);
    let clause = |pair: &[usize]| Clause { words: pair[0]..pair[1], before: pause(pair[0]), after: pause(pair[1]) };
    starts.windows(2).map(clause).collect()
}

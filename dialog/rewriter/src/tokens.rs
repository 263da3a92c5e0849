//! Tokens: pieces of words by byte pair encoding, as GPT-2 has them. Text is read in lower case.

use std::collections::HashMap;

/// The token behind all that is written.
pub(crate) const END: usize = 2;
/// Endings that are words of their own: `mug's`, `don't`.
const CLITICS: [&str; 7] = ["'re", "'ve", "'ll", "'s", "'t", "'m", "'d"];

/// The longest run of letters that is read as one, in bytes: to join the pieces of a run takes the square of its length.
const LONGEST_RUN: usize = 64;

/// What the network reads at a place.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Token {
    Text(usize),
    /// One of the marks between lines.
    Mark(usize),
}

#[derive(Debug)]
pub(crate) struct Tokens {
    /// Tokens by the bytes that they stand for; the earlier a token stands in the vocabulary, the sooner its halves are joined.
    of_bytes: HashMap<Vec<u8>, usize>,
    bytes: Vec<Vec<u8>>,
}

impl Tokens {
    /// Of a vocabulary, a token a line, each byte of it a printable character.
    pub(crate) fn new(vocabulary: &str) -> Self {
        let byte_of: HashMap<char, u8> = (0..=255).map(|byte| (printable(byte), byte)).collect();
        let bytes: Vec<Vec<u8>> =
            vocabulary.lines().map(|token| token.chars().filter_map(|c| byte_of.get(&c).copied()).collect()).collect();
        let of_bytes = bytes.iter().cloned().zip(0..).collect();
        Self { of_bytes, bytes }
    }

    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// The tokens of a text; what the vocabulary has no byte for is left out.
    pub(crate) fn of(&self, text: &str) -> Vec<usize> {
        let words: Vec<&str> = text.split_whitespace().collect();
        let text = format!(" {}", words.join(" ").to_lowercase());
        if words.is_empty() {
            Vec::new()
        } else {
            pretokens(&text).into_iter().flat_map(|part| self.joined(part)).collect()
        }
    }

    /// The text of tokens.
    pub(crate) fn text(&self, tokens: &[usize]) -> String {
        let bytes: Vec<u8> = tokens.iter().filter_map(|token| self.bytes.get(*token)).flatten().copied().collect();
        String::from_utf8_lossy(&bytes).trim().to_owned()
    }

    /// The tokens of a part of a text: the earliest pair of neighbours in the vocabulary is joined until there is none.
    fn joined(&self, part: &str) -> Vec<usize> {
        let mut pieces: Vec<Vec<u8>> = part.bytes().map(|byte| vec![byte]).collect();
        loop {
            let pairs =
                pieces.windows(2).enumerate().filter_map(|(at, pair)| Some((*self.of_bytes.get(&pair.concat())?, at)));
            let Some((_, at)) = pairs.min() else { break };
            let second = pieces.remove(at + 1);
            pieces[at].extend(second);
        }
        pieces.iter().filter_map(|piece| self.of_bytes.get(piece).copied()).collect()
    }
}

/// The parts of a text that are made of tokens each by itself: runs of letters, of digits, and of other marks, each with the space before it.
fn pretokens(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let length =
            CLITICS.iter().find(|clitic| rest.starts_with(**clitic)).map_or_else(|| run(rest), |clitic| clitic.len());
        let (part, after) = rest.split_at(length);
        parts.push(part);
        rest = after;
    }
    parts
}

/// How long the run of like characters is that a text begins with, the space before it included; always at least one character.
fn run(text: &str) -> usize {
    let space = usize::from(text.starts_with(' '));
    let kind = |c: char| match c {
        _ if c.is_whitespace() => 0,
        _ if c.is_alphabetic() => 1,
        _ if c.is_numeric() => 2,
        _ => 3,
    };
    let Some(first) = text[space..].chars().next() else { return text.len() };
    let ends = |(at, c): &(usize, char)| kind(*c) != kind(first) || *at >= LONGEST_RUN;
    text[space..].char_indices().find(ends).map_or(text.len(), |(end, _)| space + end)
}

/// The printable character that a vocabulary has for a byte.
fn printable(byte: u8) -> char {
    let is_printable = |byte: u8| matches!(byte, b'!'..=b'~' | 0xA1..=0xAC | 0xAE..=0xFF);
    if is_printable(byte) {
        return char::from(byte);
    }
    let place = (0..byte).filter(|before| !is_printable(*before)).count();
    u32::try_from(256 + place).ok().and_then(char::from_u32).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_runs_with_the_space_before_them() {
        let text = " don't put 12 mugs, the boss's... on £5 (é)";
        assert_eq!(
            pretokens(text),
            [" don", "'t", " put", " 12", " mugs", ",", " the", " boss", "'s", "...", " on", " £", "5", " (", "é", ")"]
        );
    }

    #[test]
    fn a_run_has_an_end() {
        let text = format!(" {}", "é".repeat(100));
        let parts = pretokens(&text);
        assert!(parts.len() > 2 && parts.iter().all(|part| part.len() <= 1 + LONGEST_RUN), "{parts:?}");
        assert_eq!(parts.concat(), text);
    }

    #[test]
    fn the_earliest_pairs_are_joined_first() {
        let vocabulary = "!\nĠ\n<|im_end|>\nc\nu\np\nĠc\nup\nĠcup\nĠcu";
        let tokens = Tokens::new(vocabulary);
        assert_eq!(tokens.of("CUP!"), [8, 0]);
        assert_eq!(tokens.of("cu"), [9]);
        assert_eq!(tokens.text(&[8, 9, 0]), "cup cu!");
        assert_eq!(tokens.of(" \n"), Vec::<usize>::new());
    }
}

//! Words of a text, and the word pieces that the network knows them by.

use std::{collections::HashMap, ops::Range};

use unicode_normalization::{UnicodeNormalization, char::is_combining_mark};

/// The most pieces of one word; the rest of a longer one is not read.
const MOST_PIECES: usize = 8;

const UNKNOWN: &str = "[UNK]";
/// Endings that are words of their own: `mug's`, `don't`.
const CLITICS: [&str; 7] = ["s", "t", "re", "ll", "ve", "d", "m"];

/// Where the words of a text stand: runs of letters and digits, endings after an apostrophe, and each mark by itself.
pub(crate) fn words(text: &str) -> Vec<Range<usize>> {
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = clitic(rest).unwrap_or_else(|| {
            if first.is_alphanumeric() {
                rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len())
            } else {
                first.len_utf8()
            }
        });
        if !first.is_whitespace() {
            words.push(at..at + length);
        }
        at += length;
    }
    words
}

/// How long the ending is that a text begins with, its apostrophe included.
fn clitic(text: &str) -> Option<usize> {
    let after = text.strip_prefix(['\'', '’'])?;
    let end = after.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(after.len());
    let is_clitic = CLITICS.iter().any(|clitic| clitic.eq_ignore_ascii_case(&after[..end]));
    is_clitic.then_some(text.len() - after.len() + end)
}

/// The pieces that words are made of, as numbers.
#[derive(Debug)]
pub(crate) struct Vocabulary {
    pieces: HashMap<&'static str, u32>,
}

impl Vocabulary {
    /// One piece a line; those that do not begin a word have `##` before them.
    pub(crate) fn new(text: &'static str) -> Self {
        Self { pieces: text.lines().zip(0..).collect() }
    }

    /// How many pieces there are.
    pub(crate) fn len(&self) -> usize {
        self.pieces.len()
    }

    /// The number of a piece that is part of the vocabulary.
    pub(crate) fn piece(&self, piece: &str) -> u32 {
        self.pieces.get(piece).copied().unwrap_or_default()
    }

    /// The pieces of a word: always the longest that fits.
    pub(crate) fn pieces(&self, word: &str) -> Vec<u32> {
        let word: String = word.to_lowercase().replace('’', "'").nfd().filter(|c| !is_combining_mark(*c)).collect();
        let (mark, rest) = word.split_at(usize::from(word.starts_with('\'') && word.len() > 1));
        let mut pieces: Vec<u32> = Vec::new();
        for part in [mark, rest].into_iter().filter(|part| !part.is_empty()) {
            pieces.extend(self.longest(part).unwrap_or_else(|| vec![self.piece(UNKNOWN)]).iter().take(MOST_PIECES));
        }
        if pieces.is_empty() { vec![self.piece(UNKNOWN)] } else { pieces }
    }

    fn longest(&self, part: &str) -> Option<Vec<u32>> {
        let mut pieces = Vec::new();
        let mut at = 0;
        while at < part.len() {
            let ends = part[at..].char_indices().map(|(offset, c)| at + offset + c.len_utf8());
            let (end, piece) = ends.rev().find_map(|end| {
                let known = if at == 0 {
                    self.pieces.get(&part[..end])
                } else {
                    self.pieces.get(format!("##{}", &part[at..end]).as_str())
                };
                known.map(|piece| (end, *piece))
            })?;
            pieces.push(piece);
            at = end;
        }
        Some(pieces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<&str> {
        words(text).into_iter().map(|word| &text[word]).collect()
    }

    #[test]
    fn words_are_letters_endings_and_marks() {
        assert_eq!(
            split("Don't touch Ann’s 2 mugs, ok?"),
            ["Don", "'t", "touch", "Ann", "’s", "2", "mugs", ",", "ok", "?"]
        );
        assert_eq!(split("rock 'n' roll_it"), ["rock", "'", "n", "'", "roll", "_", "it"]);
        assert_eq!(split("  "), Vec::<&str>::new());
    }

    #[test]
    fn words_are_made_of_the_longest_pieces() {
        let vocabulary = Vocabulary::new("[UNK]\nmic\n##ro\n##wave\nmicro\ncafe\n'\ns");
        assert_eq!(vocabulary.pieces("Microwave"), [4, 3]);
        assert_eq!(vocabulary.pieces("Café"), [5]);
        assert_eq!(vocabulary.pieces("’s"), [6, 7]);
        assert_eq!(vocabulary.pieces("mix"), [0]);
    }
}

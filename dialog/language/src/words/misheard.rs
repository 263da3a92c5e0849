//! What is easily misheard besides single words: names of several words, run together or parted elsewhere, `E5` and its like,
//! and the short words between others.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use crate::words::{
    sound::{self, Sounding},
    token::{self, NUMBERS},
};

/// How differently a name may sound, for each of its sounds: where a word heard is none, and where all are.
const NAME_EACH: f32 = 0.1;
const WORDS_EACH: f32 = 0.05;
/// The same of a letter and a number, of which little is to be heard.
const CODE_EACH: f32 = 0.2;
/// How much a short word differs from what it is taken for.
const SMALL: f32 = 0.4;
/// Names of more letters than this are told by their sound.
const SHORTEST_NAME: usize = 7;

/// The tables.
#[derive(Debug, Default)]
pub(crate) struct Misheard {
    small: BTreeMap<String, Vec<String>>,
    begins: BTreeMap<String, Vec<String>>,
    letters: BTreeMap<String, String>,
    names: Sounding,
    codes: Sounding,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HearingFile {
    small: BTreeMap<String, Vec<String>>,
    begins: BTreeMap<String, Vec<String>>,
    letters: BTreeMap<String, String>,
}

impl Misheard {
    /// Of what there is to speak of: names of several words.
    pub(crate) fn new<'a>(names: impl Iterator<Item = &'a [String]>) -> Self {
        let file: HearingFile = toml::from_str(include_str!("../../data/hearing.toml"))
            .expect("invariant: the built-in tables parse, the tests load them");
        let mut misheard = Self { small: file.small, begins: file.begins, letters: file.letters, ..Self::default() };
        let (mut plain, mut codes) = (BTreeSet::new(), BTreeSet::new());
        for name in names {
            match name {
                [letter, number] if is_letter(letter) && is_number(number) => {
                    codes.insert(name.join(" "));
                }
                _ if name.iter().all(|word| is_plain(word)) => {
                    plain.insert(name.join(" "));
                }
                _ => {}
            }
        }
        let words = |name: &str| name.split(' ').map(str::to_owned).collect::<Vec<_>>();
        misheard.names = Sounding::of(plain.into_iter().map(|name| (joined(&words(&name)), name)));
        misheard.codes = Sounding::of(
            codes
                .into_iter()
                .map(|code| (misheard.spelt(&words(&code)).unwrap_or_default(), code))
                .collect::<Vec<_>>()
                .into_iter(),
        );
        misheard
    }

    /// What a short word may have been, and how much that differs.
    pub(crate) fn small(&self, word: &str, begins: bool) -> impl Iterator<Item = (f32, &str)> {
        let verbs = self.begins.get(word).filter(|_| begins);
        let found = self.small.get(word).into_iter().chain(verbs).flatten();
        found.map(|meant| (SMALL, meant.as_str()))
    }

    /// The names of several words that what was heard may have been.
    pub(crate) fn names(&self, heard: &[String], is_odd: bool) -> Vec<(f32, &str)> {
        if heard.iter().map(String::len).sum::<usize>() < SHORTEST_NAME || !heard.iter().all(|word| is_plain(word)) {
            return Vec::new();
        }
        let sounds = joined(heard);
        near(&self.names, &sounds, if is_odd { NAME_EACH } else { WORDS_EACH })
    }

    /// The letters with a number, such as `e 5`, that what was heard may have been: as many digits sound the same.
    pub(crate) fn codes(&self, heard: &[String]) -> Vec<(f32, &str)> {
        let Some(sounds) = self.spelt(heard) else { return Vec::new() };
        near(&self.codes, &sounds, CODE_EACH)
    }

    /// `e 5`, `d5`, `t five` as sounds.
    fn spelt(&self, words: &[String]) -> Option<Vec<char>> {
        let (letter, number) = match words {
            [letter, number] if is_letter(letter) && is_number(number) => (letter.as_str(), number.as_str()),
            [code] => code.split_at_checked(1).filter(|(letter, number)| is_letter(letter) && digits(number))?,
            _ => return None,
        };
        let mut sounds = sound::sounds(self.letters.get(letter)?);
        sounds.extend(sound::sounds(
            NUMBERS.get(number.parse::<usize>().unwrap_or(usize::MAX)).copied().unwrap_or(number),
        ));
        Some(sounds)
    }
}

fn near<'a>(table: &'a Sounding, sounds: &[char], each: f32) -> Vec<(f32, &'a str)> {
    let limit = each * sounds.len() as f32;
    let mut found = table.alike(sounds);
    found.retain(|(cost, _)| *cost <= limit);
    found.sort_by(|(one, a), (other, b)| one.total_cmp(other).then(a.cmp(b)));
    found
}

fn joined(words: &[String]) -> Vec<char> {
    let mut sounds: Vec<char> = words.iter().flat_map(|word| sound::sounds(word)).collect();
    sounds.dedup();
    sounds
}

fn is_plain(word: &str) -> bool {
    word.chars().all(|letter| letter.is_ascii_alphabetic())
}

fn is_letter(word: &str) -> bool {
    word.len() == 1 && is_plain(word)
}

fn digits(word: &str) -> bool {
    word.len() == 1 && token::digits(word).is_some()
}

fn is_number(word: &str) -> bool {
    digits(word) || NUMBERS.contains(&word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_codes_are_told_by_their_sound() {
        let names =
            ["robotics lab", "vending machine", "e 5", "e five", "b 4", "m 8", "time machine"].map(token::words);
        let misheard = Misheard::new(names.iter().map(Vec::as_slice));
        let first = |found: Vec<(f32, &str)>| found.first().map(|(_, name)| (*name).to_owned());
        let name = |heard: &str| first(misheard.names(&token::words(heard), false));
        assert_eq!(name("robotic slab").as_deref(), Some("robotics lab"));
        assert_eq!(name("robotic slam").as_deref(), Some("robotics lab"));
        assert_eq!(name("bending machine").as_deref(), Some("vending machine"));
        assert_eq!(name("washing machine"), None);
        let code = |heard: &str| first(misheard.codes(&token::words(heard)));
        assert_eq!(code("d5").as_deref(), Some("e 5"));
        assert_eq!(code("t five").as_deref(), Some("e 5"));
        assert_eq!(code("n 8").as_deref(), Some("m 8"));
        assert_eq!(code("e 9"), None);
        assert_eq!(code("the five"), None);
    }
}

//! A recogniser's errors, made on purpose: words taken for others that sound like them, left out, and put in.

use std::collections::BTreeSet;

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

use crate::{Hypothesis, Recognition, bias};

/// Words that recognisers take for each other, a set a line; those of this domain first.
const ALIKE: &str = include_str!("../data/alike.txt");

/// Of a hundred errors, so many are words left out and so many words put in; the others are words taken for others. That
/// is about what recognisers of short requests do.
const DELETED: u32 = 18;
const INSERTED: u32 = 12;

/// Words that are put in.
const FILLERS: &[&str] = &["the", "a", "and", "it", "in", "uh", "to", "of"];

/// What an ending may be taken for.
const ENDINGS: &[(&str, &str)] =
    &[("ing", "in"), ("s", ""), ("ed", ""), ("t", "d"), ("d", "t"), ("n", "m"), ("m", "n")];

/// Makes a chosen share of words wrong; the same seed makes the same errors.
#[derive(Clone, Debug)]
pub struct Injector {
    rate: f32,
    random: ChaCha8Rng,
    alike: Vec<Vec<String>>,
}

impl Injector {
    /// One that makes errors in this share of words, from 0 to 1.
    #[must_use]
    pub fn new(word_error_rate: f32, seed: u64) -> Self {
        let rate = if word_error_rate.is_finite() { word_error_rate.clamp(0.0, 1.0) } else { 0.0 };
        let sets = ALIKE.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        let alike = sets.map(|line| line.split_whitespace().map(str::to_owned).collect()).collect();
        Self { rate, random: ChaCha8Rng::seed_from_u64(seed), alike }
    }

    /// A text as it might be heard.
    pub fn garble(&mut self, text: &str) -> String {
        let mut heard: Vec<String> = Vec::new();
        for word in text.split_whitespace() {
            if !self.chance(self.rate) {
                heard.push(word.to_owned());
                continue;
            }
            match self.below(100) {
                error if error < DELETED => {}
                error if error < DELETED + INSERTED => {
                    let filler = FILLERS[self.below(FILLERS.len() as u32) as usize];
                    heard.extend([word.to_owned(), filler.to_owned()]);
                }
                _ => heard.push(self.mistake(word)),
            }
        }
        heard.join(" ")
    }

    /// A recognition as it might have been: its readings are garbled alike, so that the best stays the best, and trusted less the
    /// more is wrong.
    pub fn garble_recognition(&mut self, recognition: &Recognition) -> Recognition {
        if self.rate == 0.0 || recognition.best().is_empty() {
            return recognition.clone();
        }
        let best = recognition.best().to_owned();
        let garbled = self.garble(&best);
        let (said, heard) = (bias::words(&best), bias::words(&garbled));
        let wrong = crate::distance::words(&said, &heard) as f32 / said.len().max(1) as f32;
        let first = Hypothesis { text: garbled.clone(), ..recognition.hypotheses[0] };
        let others = recognition.hypotheses[1..].iter();
        let others: Vec<Hypothesis> =
            others.map(|other| Hypothesis { text: self.garble(&other.text), ..*other }).collect();
        let mut texts = BTreeSet::new();
        let mut hypotheses: Vec<Hypothesis> = std::iter::once(first)
            .chain(others)
            .filter(|hypothesis| !hypothesis.text.is_empty() && texts.insert(hypothesis.text.clone()))
            .collect();
        hypotheses.iter_mut().for_each(|hypothesis| hypothesis.confidence *= 1.0 - 0.5 * wrong.min(1.0));
        Recognition { hypotheses, raw: garbled }
    }

    /// Another word that sounds like this one, with the punctuation that stood around it.
    fn mistake(&mut self, word: &str) -> String {
        let plain = word.to_lowercase();
        let plain = plain.trim_matches(|c: char| !c.is_alphanumeric());
        let marks = word.trim_start_matches(|c: char| c.is_alphanumeric() || c == '\'' || c == '-');
        let others: Vec<String> = self
            .alike
            .iter()
            .filter(|set| set.iter().any(|other| other == plain))
            .flatten()
            .filter(|other| *other != plain)
            .cloned()
            .collect();
        let other = match others.len() {
            0 => self.slip(plain),
            count => others[self.below(count as u32) as usize].replace('_', " "),
        };
        other + marks
    }

    /// A word with another ending or vowel, where no other word is known that sounds like it.
    fn slip(&mut self, word: &str) -> String {
        let stem = |(ending, other): &(&str, &str)| {
            word.strip_suffix(ending).filter(|stem| stem.len() > 1).map(|stem| format!("{stem}{other}"))
        };
        let mut slips: Vec<String> = ENDINGS.iter().filter_map(stem).collect();
        for (at, vowel) in word.char_indices().filter(|(_, c)| "aeiou".contains(*c)) {
            let others = "aeiou".chars().filter(|other| *other != vowel);
            slips.extend(others.map(|other| format!("{}{other}{}", &word[..at], &word[at + 1..])));
        }
        match slips.len() {
            0 => FILLERS[self.below(FILLERS.len() as u32) as usize].to_owned(),
            count => slips.swap_remove(self.below(count as u32) as usize),
        }
    }

    fn chance(&mut self, probability: f32) -> bool {
        ((self.random.next_u32() >> 8) as f32) < probability * (1u32 << 24) as f32
    }

    /// A number below another one, which is not 0.
    fn below(&mut self, end: u32) -> u32 {
        ((u64::from(self.random.next_u32()) * u64::from(end)) >> 32) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAID: &str = "turn right at the light, pour the milk and put the four bowls there";

    #[test]
    fn the_chosen_share_of_words_is_wrong() {
        for rate in [0.0, 0.05, 0.2, 0.5] {
            let mut injector = Injector::new(rate, 7);
            let said = bias::words(SAID);
            let wrong: usize =
                (0..400).map(|_| crate::distance::words(&said, &bias::words(&injector.garble(SAID)))).sum();
            let share = wrong as f32 / (400 * said.len()) as f32;
            assert!((share - rate).abs() < 0.02 + rate * 0.1, "{share} of {rate}");
        }
    }

    #[test]
    fn a_seed_makes_the_same_errors() {
        let garbled = |seed| {
            let mut injector = Injector::new(0.3, seed);
            (0..5).map(|_| injector.garble(SAID)).collect::<Vec<_>>()
        };
        assert_eq!(garbled(1), garbled(1));
        assert_ne!(garbled(1), garbled(2));
    }

    #[test]
    fn words_are_taken_for_others_that_sound_like_them() {
        let mut injector = Injector::new(1.0, 3);
        let heard: BTreeSet<String> = (0..200).map(|_| injector.mistake("Right,")).collect();
        assert!(heard.contains("light,") && heard.contains("write,"), "{heard:?}");
        assert!(!heard.contains("right,"), "{heard:?}");
        for word in ["xyzzy", "b", "…", "schön"] {
            assert_ne!(injector.mistake(word), word);
        }
    }

    #[test]
    fn a_garbled_recognition_is_trusted_less() {
        let recognition = Recognition::sure(SAID);
        assert_eq!(Injector::new(0.0, 1).garble_recognition(&recognition), recognition);
        let garbled = Injector::new(0.5, 1).garble_recognition(&recognition);
        assert!(garbled.confidence() < 1.0 && garbled.best() == garbled.raw && garbled.best() != SAID);
        assert_eq!(Injector::new(f32::NAN, 1).garble(SAID), SAID);
    }
}

//! A small language model of what is likely to be said: how likely a word is after the two before it.
//!
//! Trigrams, bigrams and single words, each mixed with the next simpler one by how many different words followed
//! (Witten and Bell, "The zero-frequency problem", 1991).

use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    ops::Range,
    sync::Arc,
};

use crate::{Bias, bias};

/// What stands for a word in counts. Words that are not known have none.
type Word = u32;

/// What stands before the first word, and after the last.
const EDGE: Word = 0;
/// Chance of a word that is not known, at all.
const UNKNOWN: f32 = 1e-3;
/// And for each of its letters, so that nothing is gained by writing two words as one.
const LETTER: f32 = 0.15;
/// Of single words, so much of the chance goes to all that are known alike.
const EVEN: f32 = 0.1;

/// How often words followed, and how many different ones.
#[derive(Default)]
struct Follows {
    total: u32,
    of: BTreeMap<Word, u32>,
}

/// The model.
pub(crate) struct NGram {
    /// Known words in order; the word at `index` is `index + 1`.
    words: Vec<String>,
    single: Follows,
    after_one: HashMap<Word, Follows>,
    after_two: HashMap<[Word; 2], Follows>,
    /// Words that are not known here, but to who hears them.
    understood: Arc<BTreeSet<String>>,
}

/// Where in a sentence one is: the two words before, and how a word begins that is not complete.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Place {
    before: [Word; 2],
    prefix: String,
    /// Logarithm of how likely the complete words are.
    complete: f32,
    /// All words, for telling those apart that differ in more than marks.
    words: String,
}

impl Place {
    /// The words so far, and the letters of the one that is not complete.
    pub(crate) fn words(&self) -> &str {
        &self.words
    }
}

impl NGram {
    /// The model of a bias, unless that says nothing.
    pub(crate) fn of(bias: &Bias) -> Option<Self> {
        if bias.is_empty() {
            return None;
        }
        let sentences: Vec<Vec<String>> = bias.sentences.iter().map(|sentence| bias::words(sentence)).collect();
        let mut known: Vec<String> = sentences.iter().flatten().chain(&bias.words).cloned().collect();
        known.sort_unstable();
        known.dedup();
        let mut model = Self {
            words: known,
            single: Follows::default(),
            after_one: HashMap::new(),
            after_two: HashMap::new(),
            understood: Arc::clone(&bias.known),
        };
        for sentence in &sentences {
            model.count(sentence);
        }
        Some(model)
    }

    fn count(&mut self, sentence: &[String]) {
        let mut before = [EDGE; 2];
        let words: Vec<Word> = sentence.iter().filter_map(|word| self.word(word)).collect();
        for word in words.into_iter().chain([EDGE]) {
            self.single.note(word);
            self.after_one.entry(before[1]).or_default().note(word);
            self.after_two.entry(before).or_default().note(word);
            before = [before[1], word];
        }
    }

    fn word(&self, word: &str) -> Option<Word> {
        self.words.binary_search_by(|known| known.as_str().cmp(word)).ok().map(|at| at as Word + 1)
    }

    /// How many words of a text nobody knows; numbers are known.
    pub(crate) fn strange(&self, text: &str) -> usize {
        let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit());
        let is_known = |word: &String| self.word(word).is_some() || self.understood.contains(word) || is_number(word);
        bias::words(text).iter().filter(|word| !is_known(word)).count()
    }

    fn chance(&self, before: [Word; 2], word: Word) -> f32 {
        let even = 1.0 / (self.words.len() + 1) as f32;
        let single = EVEN * even + (1.0 - EVEN) * self.single.share(word, even);
        let one = self.after_one.get(&before[1]).map_or(single, |follows| follows.share(word, single));
        self.after_two.get(&before).map_or(one, |follows| follows.share(word, one))
    }

    /// The words that begin so, as a range.
    fn beginning(&self, prefix: &str) -> Range<usize> {
        let from = self.words.partition_point(|word| word.as_str() < prefix);
        let length = self.words[from..].partition_point(|word| word.starts_with(prefix));
        from..from + length
    }

    /// Logarithm of how likely what was said so far is, where the word that is not complete becomes the likeliest.
    pub(crate) fn so_far(&self, place: &Place) -> f32 {
        if place.prefix.is_empty() {
            return place.complete;
        }
        let words = self.beginning(&place.prefix).map(|at| self.chance(place.before, at as Word + 1));
        words.reduce(f32::max).map_or_else(|| strange(&place.prefix), f32::ln) + place.complete
    }

    /// What is said goes on with letters.
    pub(crate) fn spell(&self, place: &mut Place, begins_word: bool, letters: &str, ends_word: bool) {
        if begins_word {
            self.complete(place);
        }
        if place.prefix.is_empty() && !letters.is_empty() {
            place.words.push(' ');
        }
        place.words.push_str(letters);
        place.prefix.push_str(letters);
        if ends_word {
            self.complete(place);
        }
    }

    /// The word that is spelt is complete.
    fn complete(&self, place: &mut Place) {
        if place.prefix.is_empty() {
            return;
        }
        let prefix = std::mem::take(&mut place.prefix);
        let word = self.word(prefix.trim_matches('\''));
        place.complete += word.map_or_else(|| strange(&prefix), |word| self.chance(place.before, word).ln());
        // After a word that is not known, what comes is judged by itself.
        place.before = [place.before[1], word.unwrap_or(Word::MAX)];
    }

    /// Nothing more is said: logarithm of how likely all of it is.
    pub(crate) fn end(&self, place: &mut Place) -> f32 {
        self.complete(place);
        place.complete + self.chance(place.before, EDGE).ln()
    }
}

/// Logarithm of the chance of a word that is not known.
fn strange(word: &str) -> f32 {
    UNKNOWN.ln() + word.chars().count() as f32 * LETTER.ln()
}

impl Follows {
    fn note(&mut self, word: Word) {
        self.total += 1;
        *self.of.entry(word).or_default() += 1;
    }

    /// Share of a word, mixed with what a simpler model says.
    fn share(&self, word: Word, simpler: f32) -> f32 {
        let (seen, different) = (self.of.get(&word).copied().unwrap_or(0) as f32, self.of.len() as f32);
        (seen + different * simpler) / (self.total as f32 + different)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn model() -> NGram {
        let sentences = ["pick up the mug", "pick up the bowl", "put the mug on the table", "go to the table"];
        let mut bias = Bias::of(sentences);
        bias.words.insert("fridge".into());
        NGram::of(&bias).unwrap()
    }

    fn of(model: &NGram, text: &str) -> f32 {
        let mut place = Place::default();
        for word in text.split(' ') {
            model.spell(&mut place, true, word, false);
        }
        model.end(&mut place)
    }

    #[test]
    fn chances_sum_to_one() {
        let model = model();
        for before in [[0, 0], [1, 2], [3, 4], [7, 7], [Word::MAX; 2]] {
            let sum: f32 = (0..=model.words.len() as Word).map(|word| model.chance(before, word)).sum();
            assert!((sum - 1.0).abs() < 1e-4, "{sum} after {before:?}");
        }
    }

    #[test]
    fn what_is_like_the_sentences_is_likelier() {
        let model = model();
        let less = |one: &str, other: &str| {
            assert!(of(&model, one) < of(&model, other), "{one}: {} {other}: {}", of(&model, one), of(&model, other));
        };
        less("pick up the table", "pick up the mug");
        less("up pick mug the", "pick up the mug");
        less("pick up the zebra", "pick up the fridge");
        less("pick up the fridge", "pick up the bowl");
    }

    #[test]
    fn the_beginning_of_a_word_is_as_likely_as_the_best_that_begins_so() {
        let model = model();
        let mut place = Place::default();
        for (begins, letters) in [(true, "pick"), (true, "up"), (true, "the"), (true, "b")] {
            model.spell(&mut place, begins, letters, false);
        }
        let before = model.so_far(&place);
        model.spell(&mut place, false, "owl", true);
        assert_eq!((model.so_far(&place), place.words()), (before, " pick up the bowl"));
        model.spell(&mut place, true, "xy", false);
        assert!((model.so_far(&place) - before - strange("xy")).abs() < 1e-3);
    }

    #[test]
    fn strange_words_are_counted() {
        let check = |text: &str, expected: usize| assert_eq!(model().strange(text), expected, "{text}");
        check("Pick up the fridge.", 0);
        check("Pick up the pole, 30 zebras", 2);
        let bias = Bias { known: Arc::new(["pole".to_owned()].into()), ..Bias::of(["pick up the mug"]) };
        assert_eq!(NGram::of(&bias).unwrap().strange("Pick up the pole, 30 zebras"), 1);
    }

    #[test]
    fn no_sentences_make_no_model() {
        assert!(NGram::of(&Bias::default()).is_none());
        assert!(NGram::of(&Bias::of(["…"])).is_some_and(|model| model.word("the").is_none()));
    }
}

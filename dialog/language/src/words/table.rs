//! A table from phrases of one or more words to meanings, asked for the longest phrase at the start of some words.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer};

use crate::words::token;

/// Phrases and what each means.
#[derive(Clone, Debug)]
pub(crate) struct PhraseTable<T> {
    meanings: BTreeMap<Vec<String>, T>,
    longest: usize,
}

impl<T> Default for PhraseTable<T> {
    fn default() -> Self {
        Self { meanings: BTreeMap::new(), longest: 0 }
    }
}

impl<'de> Deserialize<'de> for PhraseTable<()> {
    /// From a list of phrases.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut table = Self::default();
        Vec::<String>::deserialize(deserializer)?.iter().for_each(|phrase| table.insert(phrase, ()));
        Ok(table)
    }
}

/// A table from phrases, each with its meaning: for serde's `deserialize_with`.
pub(crate) fn of_meanings<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<PhraseTable<T>, D::Error> {
    let mut table = PhraseTable::default();
    let meanings = BTreeMap::<String, T>::deserialize(deserializer)?;
    meanings.into_iter().for_each(|(phrase, meaning)| table.insert(&phrase, meaning));
    Ok(table)
}

impl<T> PhraseTable<T> {
    /// Gives `phrase` a meaning, in place of an earlier one.
    pub(crate) fn insert(&mut self, phrase: &str, meaning: T) {
        let words = token::words(phrase);
        self.longest = self.longest.max(words.len());
        if !words.is_empty() {
            self.meanings.insert(words, meaning);
        }
    }

    /// The meaning of `phrase`, to be changed; `T::default()` if it had none.
    pub(crate) fn entry(&mut self, phrase: &str) -> &mut T
    where
        T: Default,
    {
        let words = token::words(phrase);
        self.longest = self.longest.max(words.len());
        self.meanings.entry(words).or_default()
    }

    /// The longest phrase that `words` begin with: its length and meaning.
    pub(crate) fn longest(&self, words: &[String]) -> Option<(usize, &T)> {
        (1..=self.longest.min(words.len()))
            .rev()
            .find_map(|length| self.meanings.get(&words[..length]).map(|meaning| (length, meaning)))
    }

    /// Whether any of the phrases stands somewhere in `words`.
    pub(crate) fn occurs_in(&self, words: &[String]) -> bool {
        (0..words.len()).any(|at| self.longest(&words[at..]).is_some())
    }

    /// How many words the longest phrase has.
    pub(crate) const fn longest_phrase(&self) -> usize {
        self.longest
    }

    /// Whether it has no phrase.
    pub(crate) fn is_empty(&self) -> bool {
        self.meanings.is_empty()
    }

    /// All phrases.
    pub(crate) fn phrases(&self) -> impl Iterator<Item = &[String]> {
        self.meanings.keys().map(Vec::as_slice)
    }

    /// The meaning of exactly these words.
    pub(crate) fn exact(&self, words: &[String]) -> Option<&T> {
        self.meanings.get(words)
    }

    /// The meanings of all phrases that have this word.
    pub(crate) fn with_word(&self, word: &String) -> impl Iterator<Item = &T> {
        self.meanings.iter().filter(move |(words, _)| words.contains(word)).map(|(_, meaning)| meaning)
    }

    /// All words of all phrases.
    pub(crate) fn words(&self) -> impl Iterator<Item = &String> {
        self.meanings.keys().flatten()
    }
}

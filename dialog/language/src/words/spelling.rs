//! The vocabulary, and the repair of words that are not in it.

use std::{
    collections::{BTreeSet, HashSet},
    sync::LazyLock,
};

/// All words that mean something here, and plain English ones that must not be bent into those.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vocabulary {
    meaningful: BTreeSet<String>,
    plain: BTreeSet<String>,
    ordinary: BTreeSet<String>,
    talk: BTreeSet<String>,
    verbs: BTreeSet<String>,
    risky_verbs: BTreeSet<String>,
}

/// Fewest letters of a word that is common enough to be no slip of another.
const SHORTEST_COMMON: usize = 4;

impl Vocabulary {
    /// Adds a word that the robot understands.
    pub(crate) fn learn(&mut self, word: &str) {
        self.meaningful.insert(word.to_owned());
    }

    /// Adds a word that is said around requests: it is known, but nobody is taken to have meant it by another.
    pub(crate) fn learn_talk(&mut self, word: &str) {
        if self.meaningful.insert(word.to_owned()) {
            self.talk.insert(word.to_owned());
        }
    }

    /// Adds an ordinary word that it does not, so that nobody takes it for a slip.
    pub(crate) fn learn_plain(&mut self, word: &str) {
        self.plain.insert(word.to_owned());
    }

    /// Adds an ordinary word that nobody misspells for another, but a recogniser of speech may hear for one.
    pub(crate) fn learn_ordinary(&mut self, word: &str) {
        self.ordinary.insert(word.to_owned());
    }

    /// Notes that a word is a verb and nothing else: only a clear slip is taken for it, and none is for one that changes things.
    pub(crate) fn learn_verb(&mut self, word: &str, changes: bool) {
        if changes { &mut self.risky_verbs } else { &mut self.verbs }.insert(word.to_owned());
    }

    /// All words that were learnt.
    pub(crate) fn words(&self) -> impl Iterator<Item = &String> {
        self.meaningful.iter().chain(&self.plain).chain(&self.ordinary)
    }

    /// Whether the robot understands the word.
    pub(crate) fn has(&self, word: &str) -> bool {
        self.meaningful.contains(word)
    }

    /// Whether it is a word at all, as far as is known.
    pub(crate) fn is_word(&self, word: &str) -> bool {
        self.has(word) || self.is_plain(word) || self.is_ordinary(word) || self.singular(word).is_some()
    }

    /// Whether it is one of those.
    pub(crate) fn is_ordinary(&self, word: &str) -> bool {
        self.ordinary.contains(word)
    }

    /// Whether it is an ordinary word that means nothing here.
    pub(crate) fn is_plain(&self, word: &str) -> bool {
        self.plain.contains(word)
    }

    /// The words meant by one that is perhaps misspelt: itself, its singular, two words run together, or the nearest word.
    pub(crate) fn correct(&self, word: &str) -> Vec<String> {
        let keep = || vec![word.to_owned()];
        if self.has(word) || !word.chars().all(|character| character.is_ascii_alphabetic()) {
            return keep();
        }
        if let Some(singular) = self.singular(word) {
            return vec![singular];
        }
        if self.is_plain(word) || self.is_ordinary(word) {
            return keep();
        }
        if let Some(parts) = self.parts(word).or_else(|| self.run_together(word)) {
            return parts;
        }
        let drawn = drawn_out(word);
        if drawn != word {
            return self.correct(&drawn);
        }
        let mut single: Vec<char> = word.chars().collect();
        single.dedup();
        let single: String = single.into_iter().collect();
        if word.len() == 3 && self.has(&single) {
            return vec![single];
        }
        if is_common(word) {
            return keep();
        }
        self.nearest(word).map_or_else(keep, |found| vec![found.clone()])
    }

    /// The word of which it is the plural.
    pub(crate) fn singular(&self, word: &str) -> Option<String> {
        ["ies", "es", "s"].into_iter().find_map(|ending| {
            let stem = word.strip_suffix(ending)?;
            let singular = if ending == "ies" { format!("{stem}y") } else { stem.to_owned() };
            (singular.len() > 2 && self.has(&singular)).then_some(singular)
        })
    }

    fn parts(&self, word: &str) -> Option<Vec<String>> {
        (3..word.len().saturating_sub(2)).find_map(|at| {
            let (first, second) = word.split_at(at);
            (self.has(first) && self.has(second)).then(|| vec![first.to_owned(), second.to_owned()])
        })
    }

    /// `grabtheknife`: several words, the fewest and longest that there are.
    fn run_together(&self, word: &str) -> Option<Vec<String>> {
        if word.len() < 5 || word.len() > 40 {
            return None;
        }
        // The fewest words up to each letter, and where the last of them begins.
        let mut best: Vec<Option<(usize, usize)>> = vec![None; word.len() + 1];
        best[0] = Some((0, 0));
        for end in 1..=word.len() {
            for start in 0..end {
                let Some((count, _)) = best[start] else { continue };
                let part = &word[start..end];
                let is_part = if part.len() < 3 { SHORT.contains(&part) } else { self.has(part) };
                if is_part && best[end].is_none_or(|(least, _)| count + 1 < least) {
                    best[end] = Some((count + 1, start));
                }
            }
        }
        let (count, _) = best[word.len()].filter(|(count, _)| *count > 1 && word.len() >= 3 * count)?;
        let mut parts = Vec::with_capacity(count);
        let mut end = word.len();
        while end > 0 {
            let (_, start) = best[end]?;
            parts.push(word[start..end].to_owned());
            end = start;
        }
        parts.reverse();
        Some(parts)
    }

    /// `tot he`, `pic kup`: a letter on the wrong side of the space, or a space too many.
    pub(crate) fn respaced(&self, words: Vec<String>) -> Vec<String> {
        let mut result: Vec<String> = Vec::with_capacity(words.len());
        for word in words {
            let is_known = |word: &str| self.is_word(word);
            let is_spelt = |word: &str| word.chars().all(|letter| letter.is_ascii_alphabetic());
            let pair =
                result.last().filter(|last| is_spelt(last) && is_spelt(&word) && !(is_known(last) && is_known(&word)));
            match pair.and_then(|last| self.moved(last, &word)) {
                Some(moved) => {
                    result.pop();
                    result.extend(moved);
                }
                None => result.push(word),
            }
        }
        result
    }

    fn moved(&self, one: &str, other: &str) -> Option<Vec<String>> {
        let whole = format!("{one}{other}");
        if self.has(&whole) && whole.len() > 3 {
            return Some(vec![whole]);
        }
        [one.len().checked_sub(1)?, one.len() + 1].into_iter().filter(|at| *at > 1 && *at + 1 < whole.len()).find_map(
            |at| {
                let (first, second) = whole.split_at(at);
                (self.has(first) && self.has(second)).then(|| vec![first.to_owned(), second.to_owned()])
            },
        )
    }

    /// The word of which it may be a slip.
    pub(crate) fn nearest(&self, word: &str) -> Option<&String> {
        let limit = match word.len() {
            0..=2 => return None,
            3 => {
                return self.meaningful.iter().find(|known| {
                    known.len() == 3
                        && !self.risky_verbs.contains(*known)
                        && !self.talk.contains(*known)
                        && is_swapped(word, known)
                });
            }
            4..=6 => 1,
            _ => 2,
        };
        self.meaningful
            .iter()
            .filter(|known| !self.risky_verbs.contains(*known))
            .filter(|known| !self.talk.contains(*known) && known.len() > 2 && known.len().abs_diff(word.len()) <= limit)
            .map(|known| (distance(word.as_bytes(), known.as_bytes()), known))
            .filter(|(distance, known)| *distance <= if self.verbs.contains(*known) { 1 } else { limit })
            .min_by_key(|(distance, known)| {
                (*distance, !is_swapped(word, known), word.as_bytes().first() != known.as_bytes().first(), *known)
            })
            .map(|(_, known)| known)
    }
}

/// Words of one or two letters that people run together with others.
const SHORT: &[&str] = &["a", "go", "to", "up", "on", "in", "it", "at", "of", "my", "me", "is"];

/// Whether English texts are full of a word.
pub(crate) fn is_english(word: &str) -> bool {
    static WORDS: LazyLock<HashSet<&str>> = LazyLock::new(|| include_str!("../../data/english.txt").lines().collect());
    WORDS.contains(word)
}

/// The same of a word that is too long to be a slip of something else.
pub(crate) fn is_common(word: &str) -> bool {
    word.len() >= SHORTEST_COMMON && is_english(word)
}

/// Whether it has the same letters in another order.
fn is_swapped(one: &str, other: &str) -> bool {
    let sorted = |word: &str| {
        let mut letters = word.as_bytes().to_vec();
        letters.sort_unstable();
        letters
    };
    one.len() == other.len() && sorted(one) == sorted(other)
}

/// `pleeease`, `noooo`: three of the same letter are one or two.
fn drawn_out(word: &str) -> String {
    let letters: Vec<char> = word.chars().collect();
    let is_third = |at: usize| at > 1 && letters[at] == letters[at - 1] && letters[at] == letters[at - 2];
    if !(0..letters.len()).any(is_third) {
        return word.to_owned();
    }
    let is_second = |at: usize| at > 0 && letters[at] == letters[at - 1];
    letters.iter().enumerate().filter(|(at, _)| !is_second(*at)).map(|(_, letter)| *letter).collect()
}

/// Edits (insertion, deletion, change, swap of neighbours) from one word to the other: optimal string alignment.
pub(crate) fn distance(one: &[u8], other: &[u8]) -> usize {
    let width = other.len() + 1;
    let mut table = vec![0; (one.len() + 1) * width];
    for row in 0..=one.len() {
        for column in 0..=other.len() {
            let at = row * width + column;
            table[at] = if row == 0 || column == 0 {
                row + column
            } else {
                let change = usize::from(one[row - 1] != other[column - 1]);
                let mut best = (table[at - 1] + 1).min(table[at - width] + 1).min(table[at - width - 1] + change);
                let swapped =
                    row > 1 && column > 1 && one[row - 1] == other[column - 2] && one[row - 2] == other[column - 1];
                if swapped {
                    best = best.min(table[at - 2 * width - 2] + 1);
                }
                best
            };
        }
    }
    table[table.len() - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_repaired_and_plain_words_kept() {
        let mut vocabulary = Vocabulary::default();
        for word in ["microwave", "pick", "coffee", "maker", "walk", "fridge", "mug", "battery"] {
            vocabulary.learn(word);
        }
        vocabulary.learn_plain("wall");
        vocabulary.learn("heal");
        vocabulary.learn_verb("heal", true);
        vocabulary.learn("examine");
        vocabulary.learn_verb("examine", false);
        let check = |word: &str, expected: &[&str]| assert_eq!(vocabulary.correct(word), expected, "{word:?}");
        check("micorwave", &["microwave"]);
        check("mircowave", &["microwave"]);
        check("frigde", &["fridge"]);
        check("coffeemaker", &["coffee", "maker"]);
        check("mugs", &["mug"]);
        check("batteries", &["battery"]);
        check("wall", &["wall"]);
        check("pik", &["pik"]);
        check("zebra", &["zebra"]);
        check("haul", &["haul"]);
        check("heall", &["heall"]);
        check("exmaine", &["examine"]);
        check("eksamine", &["eksamine"]);
        check("öffne", &["öffne"]);
    }
}

//! The vocabulary, and the repair of words that are not in it.

use std::collections::BTreeSet;

/// All words that mean something here, and plain English ones that must not be bent into those.
#[derive(Clone, Debug, Default)]
pub(crate) struct Vocabulary {
    meaningful: BTreeSet<String>,
    plain: BTreeSet<String>,
}

impl Vocabulary {
    /// Adds a word that the robot understands.
    pub(crate) fn learn(&mut self, word: &str) {
        self.meaningful.insert(word.to_owned());
    }

    /// Adds an ordinary word that it does not, so that nobody takes it for a slip.
    pub(crate) fn learn_plain(&mut self, word: &str) {
        self.plain.insert(word.to_owned());
    }

    /// Whether the robot understands the word.
    pub(crate) fn has(&self, word: &str) -> bool {
        self.meaningful.contains(word)
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
        if self.plain.contains(word) {
            return keep();
        }
        if let Some(parts) = self.parts(word) {
            return parts;
        }
        self.nearest(word).map_or_else(keep, |found| vec![found.clone()])
    }

    fn singular(&self, word: &str) -> Option<String> {
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

    fn nearest(&self, word: &str) -> Option<&String> {
        let limit = match word.len() {
            0..=3 => return None,
            4..=6 => 1,
            _ => 2,
        };
        self.meaningful
            .iter()
            .filter(|known| known.len() > 2 && known.len().abs_diff(word.len()) <= limit)
            .map(|known| (distance(word.as_bytes(), known.as_bytes()), known))
            .filter(|(distance, _)| *distance <= limit)
            .min_by_key(|(distance, known)| (*distance, word.as_bytes().first() != known.as_bytes().first(), *known))
            .map(|(_, known)| known)
    }
}

/// Edits (insertion, deletion, change, swap of neighbours) from one word to the other: optimal string alignment.
fn distance(one: &[u8], other: &[u8]) -> usize {
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
        check("öffne", &["öffne"]);
    }
}

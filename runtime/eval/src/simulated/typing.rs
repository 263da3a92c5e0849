//! Slips of the fingers.

use cohabit_generate::Chance;

/// Words of fewer letters are typed right.
const SHORTEST: usize = 4;

/// The text with that share of its longer words mistyped: a letter left out, doubled, or swapped with the next.
pub(super) fn mistyped(text: &str, share: f64, chance: &mut Chance) -> String {
    let word = |word: &str| {
        let letters: Vec<char> = word.chars().collect();
        if letters.len() < SHORTEST || !chance.is(share) { word.to_owned() } else { slip(letters, chance) }
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

fn slip(mut letters: Vec<char>, chance: &mut Chance) -> String {
    // The first letter is right: people look at it.
    let at = 1 + chance.below(letters.len() - 2);
    match chance.below(3) {
        0 => {
            letters.remove(at);
        }
        1 => letters.insert(at, letters[at]),
        _ => letters.swap(at, at + 1),
    }
    letters.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_words_are_mistyped_as_asked_and_short_ones_never() {
        let mut chance = Chance::new(3, 0);
        let text = "please put the yellow mug on the table next to the window";
        assert_eq!(mistyped(text, 0.0, &mut chance), text);
        let all = mistyped(text, 1.0, &mut chance);
        let changed = text.split(' ').zip(all.split(' ')).filter(|(right, typed)| right != typed);
        let changed: Vec<&str> = changed.map(|(right, _)| right).collect();
        // Two equal letters that are swapped are the same word.
        assert!(changed.len() >= 5 && changed.iter().all(|word| word.len() >= SHORTEST), "{all}");
    }
}

//! How far texts are from each other.

/// The fewest words to replace, leave out or put in that make one list of words the other.
#[must_use]
pub fn words<W: PartialEq>(one: &[W], other: &[W]) -> usize {
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (at, word) in one.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], at + 1);
        for (to, candidate) in other.iter().enumerate() {
            let replaced = diagonal + usize::from(word != candidate);
            diagonal = row[to + 1];
            row[to + 1] = replaced.min(diagonal + 1).min(row[to] + 1);
        }
    }
    row[other.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_counted() {
        let check = |one: &str, other: &str, expected: usize| {
            let (one, other): (Vec<_>, Vec<_>) = (one.split(' ').collect(), other.split(' ').collect());
            assert_eq!(words(&one, &other), expected);
            assert_eq!(words(&other, &one), expected);
        };
        check("open the fridge", "open the fridge", 0);
        check("open the fridge", "open fridge", 1);
        check("open the fridge", "close a bridge now", 4);
        assert_eq!(words::<u8>(&[], &[1, 2]), 2);
    }
}

//! Latin squares: orders of conditions in which each condition stands at each position equally often.

/// The cyclic Latin square of `count` conditions: a row an order, so many rows. Condition `(row + position) mod count`.
#[must_use]
pub fn latin(count: usize) -> Vec<Vec<usize>> {
    (0..count).map(|row| (0..count).map(|position| (row + position) % count).collect()).collect()
}

/// A balanced Latin square of `count` conditions: besides, each condition follows each other one equally often.
///
/// By E. J. Williams: Experimental designs balanced for the estimation of residual effects of treatments, Australian
/// Journal of Scientific Research A 2, 1949. `count` rows if that is even; if it is odd, twice as many, the second half
/// being the first one read backwards.
#[must_use]
pub fn balanced(count: usize) -> Vec<Vec<usize>> {
    // 0, 1, n - 1, 2, n - 2, …: the differences of neighbours are all different.
    let first = (0..count).map(|position| match position {
        0 => 0,
        odd if odd % 2 == 1 => odd.div_ceil(2),
        even => count - even / 2,
    });
    let first: Vec<usize> = first.collect();
    let rows = (0..count).map(|row| first.iter().map(|condition| (condition + row) % count).collect::<Vec<_>>());
    let rows: Vec<Vec<usize>> = rows.collect();
    if count.is_multiple_of(2) || count == 1 {
        return rows;
    }
    let backwards = rows.iter().map(|row| row.iter().rev().copied().collect());
    rows.iter().cloned().chain(backwards).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    /// How often each condition stands at each position.
    fn positions(rows: &[Vec<usize>]) -> BTreeMap<(usize, usize), usize> {
        let mut counts = BTreeMap::new();
        for (position, condition) in rows.iter().flat_map(|row| row.iter().copied().enumerate()) {
            *counts.entry((position, condition)).or_default() += 1;
        }
        counts
    }

    fn all_are(counts: &BTreeMap<(usize, usize), usize>, entries: usize, count: usize) -> bool {
        counts.len() == entries && counts.values().all(|found| *found == count)
    }

    proptest! {
        #[test]
        fn squares_are_latin(count in 1_usize..14) {
            for rows in [latin(count), balanced(count)] {
                for row in &rows {
                    let mut sorted = row.clone();
                    sorted.sort_unstable();
                    prop_assert_eq!(sorted, (0..count).collect::<Vec<_>>());
                }
                prop_assert!(all_are(&positions(&rows), count * count, rows.len() / count));
            }
        }

        #[test]
        fn balanced_ones_are_balanced_for_what_comes_before(count in 2_usize..14) {
            let rows = balanced(count);
            let mut follows = BTreeMap::new();
            for pair in rows.iter().flat_map(|row| row.windows(2)) {
                *follows.entry((pair[0], pair[1])).or_default() += 1;
            }
            prop_assert!(all_are(&follows, count * (count - 1), rows.len() / count), "{follows:?}");
        }
    }

    #[test]
    fn the_square_of_four_is_the_one_in_textbooks() {
        assert_eq!(balanced(4), [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]);
        assert_eq!((balanced(3).len(), balanced(1).len(), balanced(0).len()), (6, 1, 0));
    }
}

//! Differences of shares: Newcombe's hybrid score intervals.

use super::{EffectSize, Measure};
use crate::interval::wilson_95;

/// The difference of two independent shares, each `[good, all]`, with Newcombe's interval (1998a, method 10: of Wilson's scores
/// without continuity correction). `None` where a share is of nothing.
#[must_use]
pub fn share_difference(level: [usize; 2], reference: [usize; 2]) -> Option<EffectSize> {
    let (one, other) = (Score::of(level)?, Score::of(reference)?);
    Some(hybrid(&one, &other, 0.0))
}

/// The difference of two shares of the same participants, with Newcombe's interval (1998b, method 10: of Wilson's scores, with
/// the correlation φ of the pairs, corrected for continuity). `None` of no pairs.
///
/// `counts` are participants: good at both; good at the level alone; good at the reference alone; good at neither.
#[must_use]
pub fn paired_share_difference(counts: [usize; 4]) -> Option<EffectSize> {
    let [both, level, reference, neither] = counts;
    let all = counts.iter().sum();
    let (one, other) = (Score::of([both + level, all])?, Score::of([both + reference, all])?);
    Some(hybrid(&one, &other, correlation([both, level, reference, neither])))
}

/// A share, and how far Wilson's limits are below and above it.
struct Score {
    share: f64,
    below: f64,
    above: f64,
}

impl Score {
    fn of([good, all]: [usize; 2]) -> Option<Self> {
        let share = good as f64 / all as f64;
        let [low, high] = wilson_95(good, all);
        (good <= all && all > 0).then_some(Self { share, below: share - low, above: high - share })
    }
}

fn hybrid(one: &Score, other: &Score, correlation: f64) -> EffectSize {
    let value = one.share - other.share;
    let half = |a: f64, b: f64| (a * a - 2.0 * correlation * a * b + b * b).max(0.0).sqrt();
    let interval_95 = [value - half(one.below, other.above), value + half(one.above, other.below)];
    EffectSize { measure: Measure::ShareDifference, value, interval_95 }
}

/// φ of the fourfold table, nearer to 0 by the correction for continuity if it is positive; 0 where it is undefined.
fn correlation(counts: [usize; 4]) -> f64 {
    let [both, level, reference, neither] = counts.map(|count| count as f64);
    let margins = (both + level) * (reference + neither) * (both + reference) * (level + neither);
    if margins == 0.0 {
        return 0.0;
    }
    let product = both * neither - level * reference;
    let half = (both + level + reference + neither) / 2.0;
    let corrected = if product > 0.0 { (product - half).max(0.0) } else { product };
    corrected / margins.sqrt()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn check(found: Option<EffectSize>, wanted: [f64; 3]) {
        let found = found.unwrap();
        for (found, wanted) in [found.value, found.interval_95[0], found.interval_95[1]].into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 5e-5, "{found} is not {wanted}");
        }
    }

    #[test]
    fn intervals_of_independent_shares_are_those_of_the_paper() {
        // Newcombe 1998a, table II, method 10.
        check(share_difference([56, 70], [48, 80]), [0.2, 0.0524, 0.3339]);
        check(share_difference([9, 10], [3, 10]), [0.6, 0.1705, 0.8090]);
        check(share_difference([5, 56], [0, 29]), [0.0893, -0.0381, 0.1926]);
        check(share_difference([0, 10], [0, 10]), [0.0, -0.2775, 0.2775]);
        assert_eq!(share_difference([0, 0], [1, 2]), None);
    }

    #[test]
    fn intervals_of_paired_shares_are_by_its_definition() {
        // By tests/mixed/fixtures.py, which spells out method 10 of Newcombe 1998b.
        for (counts, wanted) in PAIRED {
            check(paired_share_difference(counts), wanted);
        }
        assert_eq!(paired_share_difference([0; 4]), None);
    }

    const PAIRED: [([usize; 4], [f64; 3]); 6] = [
        ([36, 12, 2, 0], [0.2, 0.056_930, 0.340_428]),
        ([1, 1, 7, 12], [-0.285_714, -0.506_920, -0.025_559]),
        ([53, 16, 8, 9], [0.093_023, -0.020_104, 0.203_916]),
        ([10, 0, 0, 10], [0.0, -0.089_757, 0.089_757]),
        ([0, 0, 5, 5], [-0.5, -0.763_407, -0.117_367]),
        ([2, 9, 8, 1], [0.05, -0.327_127, 0.412_262]),
    ];
}

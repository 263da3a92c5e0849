//! The minimum of the profile over θ ≥ 0.
//!
//! The profile may have more than one minimum, so its derivative is evaluated on a grid of half decades; each change from
//! falling to rising brackets a minimum, which is refined to rounding by regula falsi in its Illinois form (Dowell and Jarratt
//! 1971). The boundary θ = 0 is a minimum where the derivative there is not negative. The lowest of all counts.

use super::{
    MixedError, Ratio,
    profile::{Point, Profile},
};

/// Half decades of θ: from where an intraclass correlation is as good as 0 to where one is as good as 1.
const HALF_DECADES: std::ops::RangeInclusive<i32> = -10..=16;

/// Steps that a refinement may take. It takes about ten.
const STEPS: usize = 100;

/// A refinement ends where θ changes by no more than this share.
const PRECISION: f64 = 1e-13;

/// The lowest point of the profile.
///
/// # Errors
/// [`MixedError::NoResidual`] where the profile falls to the largest θ, [`MixedError::Collinear`] where it has no value.
pub(super) fn minimise(profile: &Profile) -> Result<(Point, Ratio), MixedError> {
    let at = |ratio: f64| profile.at(ratio).ok_or(MixedError::Collinear);
    let mut left = at(0.0)?;
    let mut best = (left.slope >= 0.0).then(|| (left.clone(), Ratio::Boundary));
    for half_decade in HALF_DECADES {
        let right = at(10_f64.powf(f64::from(half_decade) / 2.0))?;
        if left.slope < 0.0 && right.slope >= 0.0 {
            let found = refine(profile, &left, &right)?;
            if best.as_ref().is_none_or(|(best, _)| found.0.criterion < best.criterion) {
                best = Some(found);
            }
        }
        left = right;
    }
    best.filter(|(best, _)| left.slope >= 0.0 || best.criterion <= left.criterion).ok_or(MixedError::NoResidual)
}

/// The zero of the derivative between two points: negative at the left, positive at the right.
fn refine(profile: &Profile, left: &Point, right: &Point) -> Result<(Point, Ratio), MixedError> {
    let (mut low, mut high) = ((left.ratio, left.slope), (right.ratio, right.slope));
    let mut last = f64::NAN;
    let mut point = left.clone();
    let mut kept_low = None;
    for _ in 0..STEPS {
        let ratio = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        point = profile.at(ratio).ok_or(MixedError::Collinear)?;
        let is_done = (ratio - last).abs() <= PRECISION * ratio || high.0 - low.0 <= PRECISION * high.0;
        if is_done || point.slope == 0.0 {
            return Ok((point, Ratio::Interior));
        }
        last = ratio;
        // An end that stays for a second time counts half, or it would stay for ever.
        if point.slope < 0.0 {
            low = (ratio, point.slope);
            high.1 *= if kept_low == Some(false) { 0.5 } else { 1.0 };
            kept_low = Some(false);
        } else {
            high = (ratio, point.slope);
            low.1 *= if kept_low == Some(true) { 0.5 } else { 1.0 };
            kept_low = Some(true);
        }
    }
    Ok((point, Ratio::NotConverged))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use faer::Mat;
    use proptest::prelude::*;

    use super::*;

    /// The profile of these values, of three participants or more in turn, on an intercept alone.
    fn profile(values: &[f64], participants: usize) -> Profile {
        let rows = values.len();
        let mean = values.iter().sum::<f64>() / rows as f64;
        let basis = Mat::from_fn(rows, 1, |_, _| (rows as f64).sqrt().recip());
        let residuals = Mat::from_fn(rows, 1, |row, _| values[row] - mean);
        let numbers: Vec<usize> = (0..rows).map(|row| row % participants).collect();
        Profile::new(&basis, &residuals, residuals.norm_l2(), &numbers)
    }

    proptest! {
        #[test]
        fn no_point_is_lower(values in prop::collection::vec(-10.0..10.0, 8..30), participants in 3_usize..6) {
            let profile = profile(&values, participants);
            let (found, ratio) = minimise(&profile).unwrap();
            prop_assert!(ratio != Ratio::NotConverged);
            for tenth in -60..60 {
                let other = profile.at(10_f64.powf(f64::from(tenth) / 10.0)).unwrap();
                prop_assert!(found.criterion <= other.criterion + 1e-9, "{found:?} is above {other:?}");
            }
        }

        #[test]
        fn the_slope_is_that_of_the_criterion(values in prop::collection::vec(-10.0..10.0, 8..30), ratio in 0.1..10.0) {
            let profile = profile(&values, 4);
            let step = 1e-5 * ratio;
            let [low, high] = [ratio - step, ratio + step].map(|ratio| profile.at(ratio).unwrap().criterion);
            let slope = profile.at(ratio).unwrap().slope;
            prop_assert!(((high - low) / (2.0 * step) - slope).abs() < 1e-5 * slope.abs().max(1.0));
        }
    }
}

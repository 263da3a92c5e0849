//! Effect sizes: how far two levels of a condition are apart, with 95 % intervals.
//!
//! Each function compares a level with a reference, in that order of its arguments: a positive size means more at the level.
//! Standardised differences have intervals by the noncentral t distribution, shares by Newcombe's hybrid score methods.
//!
//! # References
//! - Algina and Keselman (2003). Approximate confidence intervals for effect sizes. Educ. Psychol. Meas. 63, 537–553.
//! - Cumming (2012). Understanding the new statistics. Routledge, chapter 11.
//! - Hedges (1981). Distribution theory for Glass's estimator of effect size. J. Educ. Stat. 6, 107–128.
//! - Lakens (2013). Calculating and reporting effect sizes. Front. Psychol. 4:863.
//! - Newcombe (1998a). Interval estimation for the difference between independent proportions. Stat. Med. 17, 873–890.
//! - Newcombe (1998b). Improved confidence intervals for the difference between binomial proportions based on paired data.
//!   Stat. Med. 17, 2635–2650.
//! - Steiger and Fouladi (1997). Noncentrality interval estimation. In: What if there were no significance tests?
//! - Welch (1947). The generalization of Student's problem. Biometrika 34, 28–35.

mod noncentral;
mod shares;

use noncentral::noncentrality_95;
use serde::Serialize;
use statrs::function::gamma::ln_gamma;

pub use shares::{paired_share_difference, share_difference};

use crate::interval::t_95;

/// The size of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EffectSize {
    /// What it is.
    pub measure: Measure,
    /// Its estimate.
    pub value: f64,
    /// Its 95 % interval.
    pub interval_95: [f64; 2],
}

/// Which size of an effect.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Between participants: the difference of means by the pooled standard deviation, without its bias in small samples.
    HedgesG,
    /// Within participants: the mean difference by the standard deviation of the differences. It belongs to the paired t test.
    CohenDz,
    /// Within participants: the mean difference by the root of the mean of both levels' variances. It compares with sizes from
    /// between participants.
    CohenDav,
    /// The difference of two shares.
    ShareDifference,
    /// The difference of participants' mean shares, where a share is of several sessions.
    MeanShareDifference,
}

impl Measure {
    /// As papers write it.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::HedgesG => "g",
            Self::CohenDz => "d_z",
            Self::CohenDav => "d_av",
            Self::ShareDifference | Self::MeanShareDifference => "difference",
        }
    }
}

/// Hedges' g of two independent samples, one value a participant (Hedges 1981, with the exact correction). The interval is
/// that of the population's standardised difference (Steiger and Fouladi 1997). `None` where a sample has fewer than two values or neither varies.
#[must_use]
pub fn hedges_g(level: &[f64], reference: &[f64]) -> Option<EffectSize> {
    let (one, other) = (Moments::of(level)?, Moments::of(reference)?);
    let freedom = one.count + other.count - 2.0;
    let pooled = ((one.count - 1.0) * one.variance + (other.count - 1.0) * other.variance) / freedom;
    let d = standardised(one.mean - other.mean, pooled)?;
    // t = d / unit, and its noncentrality is that of the population's difference / unit.
    let unit = (1.0 / one.count + 1.0 / other.count).sqrt();
    let interval_95 = noncentrality_95(d / unit, freedom).map(|limit| limit * unit);
    Some(EffectSize { measure: Measure::HedgesG, value: small_sample(freedom) * d, interval_95 })
}

/// d_z of pairs (level, reference), one pair a participant (Lakens 2013); its interval is exact if differences are normal.
/// `None` of fewer than two pairs, or where the differences do not vary.
#[must_use]
pub fn d_z(pairs: &[[f64; 2]]) -> Option<EffectSize> {
    let differences = Moments::of(&differences(pairs))?;
    let value = standardised(differences.mean, differences.variance)?;
    let unit = differences.count.sqrt().recip();
    let interval_95 = noncentrality_95(value / unit, differences.count - 1.0).map(|limit| limit * unit);
    Some(EffectSize { measure: Measure::CohenDz, value, interval_95 })
}

/// d_av of pairs (level, reference), one pair a participant, with the root of the mean variance as unit (Cumming 2012, equation
/// 11.9); its interval is that of Algina and Keselman (2003). `None` of fewer than two pairs, or where the differences do not vary.
#[must_use]
pub fn d_av(pairs: &[[f64; 2]]) -> Option<EffectSize> {
    let column = |place: usize| Moments::of(&pairs.iter().map(|pair| pair[place]).collect::<Vec<_>>());
    let (one, other, differences) = (column(0)?, column(1)?, Moments::of(&differences(pairs))?);
    let average = f64::midpoint(one.variance, other.variance);
    let value = standardised(differences.mean, average)?;
    let t = standardised(differences.mean, differences.variance)? * differences.count.sqrt();
    let unit = (differences.variance / (differences.count * average)).sqrt();
    let interval_95 = noncentrality_95(t, differences.count - 1.0).map(|limit| limit * unit);
    Some(EffectSize { measure: Measure::CohenDav, value, interval_95 })
}

/// The mean difference of participants' shares in pairs (level, reference), by Student's t. `None` of fewer than two pairs, or
/// where the differences do not vary.
#[must_use]
pub fn paired_mean_share_difference(pairs: &[[f64; 2]]) -> Option<EffectSize> {
    let differences = Moments::of(&differences(pairs))?;
    let half = t_95(differences.count - 1.0)? * (differences.variance / differences.count).sqrt();
    (half > 0.0).then(|| mean_share(differences.mean, half))
}

/// The difference of participants' mean shares in two independent samples, by Welch's t (1947). `None` where a sample has
/// fewer than two values, or neither varies.
#[must_use]
pub fn mean_share_difference(level: &[f64], reference: &[f64]) -> Option<EffectSize> {
    let (one, other) = (Moments::of(level)?, Moments::of(reference)?);
    let errors = [one.variance / one.count, other.variance / other.count];
    let error = errors[0] + errors[1];
    let freedom = error.powi(2) / (errors[0].powi(2) / (one.count - 1.0) + errors[1].powi(2) / (other.count - 1.0));
    (error > 0.0).then_some(mean_share(one.mean - other.mean, t_95(freedom)? * error.sqrt()))
}

fn mean_share(value: f64, half: f64) -> EffectSize {
    let interval_95 = [(value - half).max(-1.0), (value + half).min(1.0)];
    EffectSize { measure: Measure::MeanShareDifference, value, interval_95 }
}

/// What is known of a sample of two values or more.
struct Moments {
    count: f64,
    mean: f64,
    variance: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (values.len() > 1).then(|| Self { count, mean, variance: squares / (count - 1.0) })
    }
}

fn differences(pairs: &[[f64; 2]]) -> Vec<f64> {
    pairs.iter().map(|[level, reference]| level - reference).collect()
}

/// A difference by the root of a variance; `None` where that is 0, or no more than rounding beside the difference.
fn standardised(difference: f64, variance: f64) -> Option<f64> {
    /// Beyond this, samples do not overlap to any purpose, and differ by rounding alone.
    const LARGEST: f64 = 1e6;
    let size = difference / variance.sqrt();
    (size.abs() < LARGEST).then_some(size)
}

/// The factor that takes the bias away, J(ν) = Γ(ν/2) / (√(ν/2) Γ((ν − 1)/2)) (Hedges 1981, equation 6e); 0 for ν = 1, where
/// the expectation does not exist.
fn small_sample(freedom: f64) -> f64 {
    let half = freedom / 2.0;
    if freedom > 1.0 { (ln_gamma(half) - ln_gamma(half - 0.5)).exp() / half.sqrt() } else { 0.0 }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Student's data on sleep (1908, after Cushny and Peebles 1905): hours gained by ten patients with two drugs.
    const SLEEP: [[f64; 2]; 10] = [
        [1.9, 0.7],
        [0.8, -1.6],
        [1.1, -0.2],
        [0.1, -1.2],
        [-0.1, -0.1],
        [4.4, 3.4],
        [5.5, 3.7],
        [1.6, 0.8],
        [4.6, 0.0],
        [3.4, 2.0],
    ];

    fn check(found: Option<EffectSize>, measure: Measure, wanted: [f64; 3]) {
        let found = found.unwrap();
        assert_eq!(found.measure, measure);
        for (found, wanted) in [found.value, found.interval_95[0], found.interval_95[1]].into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-6, "{measure:?}: {found} is not {wanted}");
        }
    }

    #[test]
    fn standardised_differences_are_those_of_scipy() {
        // By tests/mixed/fixtures.py, with scipy.stats.nct.
        let [level, reference] = [0, 1].map(|place| SLEEP.map(|pair| pair[place]));
        check(hedges_g(&level, &reference), Measure::HedgesG, HEDGES);
        check(d_z(&SLEEP), Measure::CohenDz, DZ);
        check(d_av(&SLEEP), Measure::CohenDav, DAV);
        check(mean_share_difference(&[1.0, 0.5, 0.5], &[0.0, 0.25, 0.5, 0.0]), Measure::MeanShareDifference, WELCH);
    }

    const HEDGES: [f64; 3] = [0.796_935_239, -0.095_450_398, 1.738_816_899];
    const DZ: [f64; 3] = [1.284_557_563, 0.414_627_756, 2.118_016_514];
    const DAV: [f64; 3] = [0.832_181_081, 0.268_610_286, 1.372_124_788];
    /// Its upper limit is above 1, where no difference of shares is.
    const WELCH: [f64; 3] = [0.479_166_667, -0.096_172_477, 1.0];

    #[test]
    fn what_does_not_vary_has_no_standardised_size() {
        assert_eq!(hedges_g(&[1.0, 1.0], &[2.0, 2.0]), None);
        assert_eq!(hedges_g(&[1.0], &[2.0, 3.0]), None);
        assert_eq!(d_z(&[[1.0, 0.0], [2.0, 1.0]]), None);
        assert_eq!(d_av(&[[1.0, 0.0]]), None);
        assert_eq!(paired_mean_share_difference(&[[1.0, 0.5], [1.0, 0.5]]), None);
        assert_eq!(mean_share_difference(&[1.0, 1.0], &[0.5, 0.5]), None);
    }
}

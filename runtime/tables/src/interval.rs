//! How sure a share is, and a mean.

use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// The standard normal distribution's 97.5th percentile.
const Z: f64 = 1.959_963_984_540_054;

/// The 95 % interval of a share of which `good` of `all` were seen: Wilson's score interval, which keeps within 0 and 1
/// and holds for few trials too (Wilson 1927).
#[must_use]
pub fn wilson_95(good: usize, all: usize) -> [f64; 2] {
    if all == 0 {
        return [0.0, 1.0];
    }
    let (good, all) = (good as f64, all as f64);
    let share = good / all;
    let middle = share + Z * Z / (2.0 * all);
    let half = Z * (share * (1.0 - share) / all + Z * Z / (4.0 * all * all)).sqrt();
    let scale = 1.0 + Z * Z / all;
    [((middle - half) / scale).max(0.0), ((middle + half) / scale).min(1.0)]
}

/// The 95 % interval of the mean of what these are a sample of, by Student's t; `None` for fewer than two.
#[must_use]
pub fn mean_95(values: &[f64]) -> Option<[f64; 2]> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let half = t_95(count - 1.0)? * (variance / count).sqrt();
    Some([mean - half, mean + half])
}

/// How probable it is that |t| is as large as this, by Student's t with so many degrees of freedom. Where an estimate has
/// no error, t is infinite, or undefined if the estimate is 0 too: then 0 and 1.
pub(crate) fn two_sided_p(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return if t.is_nan() { 1.0 } else { 0.0 };
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |distribution| 2.0 * distribution.sf(t.abs()))
}

/// The 97.5th percentile of Student's t with so many degrees of freedom; `None` for none.
pub(crate) fn t_95(freedom: f64) -> Option<f64> {
    Some(StudentsT::new(0.0, 1.0, freedom).ok()?.inverse_cdf(0.975))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn means_are_as_sure_as_students_t_has_it() {
        // Student's own data on sleep (1908): the difference of ten patients' gains.
        let gains = [1.2, 2.4, 1.3, 1.3, 0.0, 1.0, 1.8, 0.8, 4.6, 1.4];
        let [low, high] = mean_95(&gains).unwrap();
        assert!((low - 0.7001).abs() < 1e-4 && (high - 2.4599).abs() < 1e-4, "{low} {high}");
        assert_eq!((mean_95(&[]), mean_95(&[1.0])), (None, None));
    }

    #[test]
    fn quantiles_of_students_t_are_those_of_scipy() {
        // scipy.stats.t.ppf(0.975, freedom).
        for (freedom, quantile) in QUANTILES {
            let found = t_95(freedom).unwrap();
            assert!((found - quantile).abs() < 1e-6 * quantile, "{freedom}: {found} is not {quantile}");
        }
    }

    const QUANTILES: [(f64, f64); 5] = [
        (1.0, 12.706_204_736),
        (1.3, 7.500_529_326),
        (2.2564, 3.866_471_165),
        (22.8103, 2.069_609_979),
        (161.0, 1.974_808_092),
    ];

    #[test]
    fn intervals_are_those_of_the_literature() {
        // Figures of Newcombe 1998, table I, method 3.
        for (good, all, low, high) in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)] {
            let [lower, upper] = wilson_95(good, all);
            assert!((lower - low).abs() < 5e-5 && (upper - high).abs() < 5e-5, "{good}/{all}: {lower} {upper}");
        }
        assert_eq!(wilson_95(0, 0), [0.0, 1.0]);
    }
}

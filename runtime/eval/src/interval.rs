//! How sure a share is.

/// The 95 % interval of a share of which `good` of `all` were seen: Wilson's score interval, which keeps within 0 and 1
/// and holds for few trials too (Wilson 1927).
pub fn wilson_95(good: usize, all: usize) -> [f64; 2] {
    /// The standard normal distribution's 97.5th percentile.
    const Z: f64 = 1.959_963_984_540_054;
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

#[cfg(test)]
mod tests {
    use super::*;

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

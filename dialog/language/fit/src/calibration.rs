//! How well probabilities hold.

/// In bins of equal width, the mean distance between the probability that was said and how often it held, weighted by
/// how many fall into each (expected calibration error, Guo et al. 2017).
pub struct Calibration {
    pub error: f64,
    pub accuracy: f64,
    /// Of each bin: how many, mean probability, share that held.
    pub bins: Vec<(usize, f64, f64)>,
}

impl Calibration {
    /// Of probabilities, and whether what each was said of was so.
    pub fn new(said: &[(f64, bool)], bins: usize) -> Self {
        let mut sums = vec![(0_usize, 0.0, 0_usize); bins];
        for (probability, held) in said {
            let bin = &mut sums[((probability * bins as f64) as usize).min(bins - 1)];
            *bin = (bin.0 + 1, bin.1 + probability, bin.2 + usize::from(*held));
        }
        let all = said.len().max(1) as f64;
        let mean = |(count, sum, held): (usize, f64, usize)| {
            let of = |sum: f64| if count == 0 { 0.0 } else { sum / count as f64 };
            (count, of(sum), of(held as f64))
        };
        let bins: Vec<(usize, f64, f64)> = sums.into_iter().map(mean).collect();
        Self {
            error: bins.iter().map(|(count, mean, held)| *count as f64 / all * (mean - held).abs()).sum(),
            accuracy: said.iter().filter(|(_, held)| *held).count() as f64 / all,
            bins,
        }
    }
}

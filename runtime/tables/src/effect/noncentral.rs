//! Intervals of the noncentrality of Student's t, which are those of standardised differences.

use statrs::function::erf::erfc;

/// Nodes of the integral, an even number of steps apart.
const STEPS: usize = 2000;

/// Standard deviations of s beside its mean that the integral spans: what is beyond is less than 1e-15.
const SPAN: f64 = 9.0;

/// Halvings of the bracket of a limit: to rounding.
const HALVINGS: usize = 60;

/// The 95 % interval of the noncentrality λ of a t with so many degrees of freedom: the λ under which a t as large as this,
/// or as small, has the probability 2.5 % (Steiger and Fouladi 1997).
pub(super) fn noncentrality_95(t: f64, freedom: f64) -> [f64; 2] {
    let cdf = NoncentralT::new(freedom);
    [cdf.noncentrality(t, 0.975), cdf.noncentrality(t, 0.025)]
}

/// The noncentral t distribution: T = (Z + λ) / s, where Z is standard normal and s² is χ² with ν degrees of freedom by ν, so
/// that P(T ≤ t) = E Φ(t s − λ). The expectation is Simpson's sum over s, which has neither overflow nor cancellation for
/// large λ, as the series of Lenth (1989) has.
struct NoncentralT {
    /// Values of s, and their probabilities.
    nodes: Vec<(f64, f64)>,
}

impl NoncentralT {
    fn new(freedom: f64) -> Self {
        let spread = SPAN / (2.0 * freedom).sqrt();
        let (low, high) = ((1.0 - spread).max(0.0), 1.0 + spread);
        let node = |step: usize| {
            let s = low + (high - low) * step as f64 / STEPS as f64;
            let simpson = if step == 0 || step == STEPS {
                1.0
            } else if step % 2 == 1 {
                4.0
            } else {
                2.0
            };
            // The density of s but for a factor, 1 at its largest to rounding: s^(ν − 1) exp(−ν (s² − 1) / 2).
            let power = if freedom == 1.0 { 0.0 } else { (freedom - 1.0) * s.ln() };
            (s, simpson * (power - freedom * (s * s - 1.0) / 2.0).exp())
        };
        let mut nodes: Vec<(f64, f64)> = (0..=STEPS).map(node).collect();
        let whole: f64 = nodes.iter().map(|(_, weight)| weight).sum();
        nodes.iter_mut().for_each(|(_, weight)| *weight /= whole);
        Self { nodes }
    }

    fn cdf(&self, t: f64, noncentrality: f64) -> f64 {
        let normal = |x: f64| 0.5 * erfc(-x / std::f64::consts::SQRT_2);
        self.nodes.iter().map(|(s, weight)| weight * normal(t * s - noncentrality)).sum()
    }

    /// The λ with P(T ≤ t) = `probability`, which falls with λ.
    fn noncentrality(&self, t: f64, probability: f64) -> f64 {
        let widest = self.nodes.last().map_or(1.0, |(s, _)| *s);
        let reach = t.abs() * widest + SPAN;
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.cdf(t, middle) > probability { low = middle } else { high = middle }
        }
        f64::midpoint(low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_scipy() {
        // scipy.stats.nct, as in tests/mixed/fixtures.py: t, ν, and the limits of λ.
        for [t, freedom, low, high] in LIMITS {
            let found = noncentrality_95(t, freedom);
            for (found, wanted) in found.into_iter().zip([low, high]) {
                assert!((found - wanted).abs() < 1e-6 * wanted.abs().max(1.0), "{t} {freedom}: {found}, not {wanted}");
            }
        }
    }

    const LIMITS: [[f64; 4]; 6] = [
        [0.0, 9.0, -1.959_963_985, 1.959_963_985],
        [-2.1, 4.0, -4.431_860_678, 0.389_371_390],
        [4.06, 9.0, 1.309_702_842, 6.694_966_949],
        [12.5, 1.0, -0.012_975_645, 28.107_047_212],
        [31.0, 20.0, 21.250_799_602, 40.705_368_834],
        [3.0, 300.0, 1.022_939_249, 4.972_132_889],
    ];
}

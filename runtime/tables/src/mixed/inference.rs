//! Standard errors, degrees of freedom and tests of a fitted model.

use faer::{Mat, Side};
use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

use super::{
    MixedModel,
    profile::{dot, quadratic},
    transposed_solve,
};
use crate::interval::{t_95, two_sided_p};

/// A linear combination of the fixed effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contrast {
    /// The estimate, in the outcome's unit.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Satterthwaite's degrees of freedom, 1 or more.
    pub freedom: f64,
    /// Estimate by standard error.
    pub t: f64,
    /// The 95 % interval.
    pub interval_95: [f64; 2],
    /// How probable it is that |t| is as large if the combination is 0.
    pub p: f64,
}

/// A joint test that several fixed effects are all 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaldTest {
    /// The statistic F.
    pub f: f64,
    /// Degrees of freedom of the numerator and of the denominator.
    pub freedom: [f64; 2],
    /// How probable it is that F is as large if all are 0.
    pub p: f64,
}

/// Degrees of freedom that differ by less than this count as equal.
const EQUAL_FREEDOM: f64 = 1e-8;

impl MixedModel {
    /// One fixed effect.
    #[must_use]
    pub fn effect(&self, place: usize) -> Contrast {
        let mut weights = vec![0.0; self.estimates.len()];
        weights[place] = 1.0;
        self.contrast(&weights)
    }

    /// The combination Σ weights × estimates, of as many weights as there are fixed effects.
    #[must_use]
    pub fn contrast(&self, weights: &[f64]) -> Contrast {
        let estimate = dot(weights, &self.estimates);
        let in_basis = transposed_solve(&self.triangle, weights);
        let standard_error = self.scale * (self.variance * quadratic(&self.point.inverse, &in_basis)).sqrt();
        let freedom = self.freedom(&in_basis);
        let t = estimate / standard_error;
        let half = t_95(freedom).unwrap_or(f64::INFINITY) * standard_error;
        let interval_95 = [estimate - half, estimate + half];
        Contrast { estimate, standard_error, freedom, t, interval_95, p: two_sided_p(t, freedom) }
    }

    /// Satterthwaite's degrees of freedom of the combination c of the coefficients of Q: 2 v² / var(v̂), where v is its
    /// variance σ² cᵀ (Qᵀ V⁻¹ Q)⁻¹ c and var(v̂) follows by the delta method from the covariance of the estimates of
    /// (θ, σ²).
    fn freedom(&self, in_basis: &[f64]) -> f64 {
        let Some(covariance) = self.variance_covariance else { return self.plain_freedom };
        let solved: Vec<f64> = (0..in_basis.len())
            .map(|row| (0..in_basis.len()).map(|column| self.point.inverse[(row, column)] * in_basis[column]).sum())
            .collect();
        let relative = dot(in_basis, &solved);
        let gradient = [self.variance * quadratic(&self.between, &solved), relative];
        let spread: f64 = (0..2)
            .flat_map(|row| (0..2).map(move |column| (row, column)))
            .map(|(row, column)| gradient[row] * covariance[row][column] * gradient[column])
            .sum();
        (2.0 * (self.variance * relative).powi(2) / spread).max(1.0)
    }

    /// The test that these fixed effects are all 0; `None` if none are named. Its denominator's degrees of freedom are those
    /// of Fai and Cornelius (1996): the effects are turned into uncorrelated combinations, each with Satterthwaite's ν, and
    /// with E = Σ ν / (ν − 2) they are 2 E / (E − q).
    #[must_use]
    pub fn test(&self, places: &[usize]) -> Option<WaldTest> {
        if places.is_empty() {
            return None;
        }
        let covariance = self.covariance(places);
        let eigen = covariance.self_adjoint_eigen(Side::Lower).ok()?;
        let combination = |number: usize| {
            let mut weights = vec![0.0; self.estimates.len()];
            for (row, place) in places.iter().enumerate() {
                weights[*place] = eigen.U()[(row, number)];
            }
            self.contrast(&weights)
        };
        let each: Vec<Contrast> = (0..places.len()).map(combination).collect();
        let count = places.len() as f64;
        let f = each.iter().map(|one| one.t * one.t).sum::<f64>() / count;
        let denominator = fai_cornelius(&each.iter().map(|one| one.freedom).collect::<Vec<_>>())?;
        let p = FisherSnedecor::new(count, denominator).ok()?.sf(f);
        Some(WaldTest { f, freedom: [count, denominator], p })
    }

    /// The covariance of these fixed effects.
    fn covariance(&self, places: &[usize]) -> Mat<f64> {
        let in_basis = |place: &usize| {
            let mut unit = vec![0.0; self.estimates.len()];
            unit[*place] = 1.0;
            transposed_solve(&self.triangle, &unit)
        };
        let all: Vec<Vec<f64>> = places.iter().map(in_basis).collect();
        let inverse = &self.point.inverse;
        let product = |a: &[f64], b: &[f64]| -> f64 {
            let of_row =
                |row: usize| a[row] * (0..b.len()).map(|column| inverse[(row, column)] * b[column]).sum::<f64>();
            (0..a.len()).map(of_row).sum()
        };
        let variance = self.scale.powi(2) * self.variance;
        Mat::from_fn(places.len(), places.len(), |row, column| variance * product(&all[row], &all[column]))
    }
}

/// The denominator's degrees of freedom of an F test of uncorrelated combinations with these; `None` of none.
fn fai_cornelius(freedoms: &[f64]) -> Option<f64> {
    let (first, count) = (*freedoms.first()?, freedoms.len() as f64);
    if freedoms.iter().all(|freedom| (freedom - first).abs() < EQUAL_FREEDOM * first) {
        return Some(first);
    }
    if freedoms.iter().any(|freedom| *freedom <= 2.0) {
        return Some(2.0);
    }
    let expected: f64 = freedoms.iter().map(|freedom| freedom / (freedom - 2.0)).sum();
    Some(2.0 * expected / (expected - count))
}

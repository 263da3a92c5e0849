//! The restricted likelihood as a function of the ratio of variances θ alone, with its derivatives.
//!
//! A random intercept gives each participant with n observations the block V = I + θ 1 1ᵀ, whose inverse is
//! I − θ / (1 + n θ) 1 1ᵀ and whose determinant is 1 + n θ. So with ā the mean of a participant's rows a,
//!
//! Σ aᵀ V⁻¹ a = Σ (a − ā)ᵀ (a − ā) + Σ n / (1 + n θ) āᵀ ā,
//!
//! a sum of positive parts (within and between participants), which is evaluated in O(participants × terms²) without
//! cancellation, even for very large θ. The rows a are those of Q, from X = Q R, with the residuals of ordinary least
//! squares, scaled to length 1, as last column.

use std::collections::BTreeMap;

use faer::{Mat, Side};

use super::{DIMENSION, inverse};

/// The sums that the likelihood depends on.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    rows: usize,
    terms: usize,
    /// Crossproducts within participants, `[terms + 1, terms + 1]`.
    within: Mat<f64>,
    /// Each participant.
    groups: Vec<Group>,
    /// Dimensions of the columns of X within participants.
    within_terms: usize,
}

/// A participant's number of observations, and the mean of their rows, `[terms + 1]`.
#[derive(Clone, Debug)]
struct Group {
    count: f64,
    mean: Vec<f64>,
}

/// The profile at one θ. Lengths are in units of the residuals' norm.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// θ.
    pub ratio: f64,
    /// The estimates of the coefficients of Q, less those of ordinary least squares.
    pub solution: Vec<f64>,
    /// yᵀ P y.
    pub residual: f64,
    /// ln |V| + ln |Qᵀ V⁻¹ Q|.
    pub log_determinants: f64,
    /// −2 ℓ but for constants.
    pub criterion: f64,
    /// Its derivative by θ.
    pub slope: f64,
    /// (Qᵀ V⁻¹ Q)⁻¹.
    pub inverse: Mat<f64>,
    /// Of each participant: d = n / (1 + n θ) = 1ᵀ V⁻¹ 1.
    weights: Vec<f64>,
    /// Of each participant: 1ᵀ V⁻¹ (y − X β).
    scores: Vec<f64>,
}

impl Profile {
    /// The sums of this basis Q `[rows, terms]` and these residuals `[rows, 1]` of norm `scale`.
    pub fn new(basis: &Mat<f64>, residuals: &Mat<f64>, scale: f64, participants: &[usize]) -> Self {
        let (rows, terms) = (basis.nrows(), basis.ncols());
        let mut members = BTreeMap::<usize, Vec<usize>>::new();
        for (row, participant) in participants.iter().enumerate() {
            members.entry(*participant).or_default().push(row);
        }
        let value = |row: usize, column: usize| {
            if column < terms { basis[(row, column)] } else { residuals[(row, 0)] / scale }
        };
        let mut within = Mat::<f64>::zeros(terms + 1, terms + 1);
        let mut group = |members: Vec<usize>| {
            let count = members.len() as f64;
            let sum = |column: usize| members.iter().map(|row| value(*row, column)).sum::<f64>();
            let mean: Vec<f64> = (0..=terms).map(|column| sum(column) / count).collect();
            for row in members {
                let rest: Vec<f64> = (0..=terms).map(|column| value(row, column) - mean[column]).collect();
                add_square(&mut within, 1.0, &rest);
            }
            Group { count, mean }
        };
        let groups = members.into_values().map(&mut group).collect();
        let eigenvalues = within.as_ref().submatrix(0, 0, terms, terms).self_adjoint_eigenvalues(Side::Lower);
        let counted = |values: Vec<f64>| values.into_iter().filter(|value| *value > DIMENSION).count();
        let within_terms = eigenvalues.map_or(terms, counted);
        Self { rows, terms, within, groups, within_terms }
    }

    pub const fn rows(&self) -> usize {
        self.rows
    }

    pub const fn participants(&self) -> usize {
        self.groups.len()
    }

    /// n − p.
    pub const fn residual_freedom(&self) -> f64 {
        (self.rows - self.terms) as f64
    }

    /// Dimensions of X that vary between participants alone, the intercept's included.
    pub const fn between_terms(&self) -> usize {
        self.terms - self.within_terms
    }

    /// Degrees of freedom between participants.
    pub const fn between_freedom(&self) -> usize {
        self.groups.len().saturating_sub(self.between_terms())
    }

    /// Degrees of freedom within participants.
    pub const fn within_freedom(&self) -> usize {
        self.rows.saturating_sub(self.groups.len() + self.within_terms)
    }

    /// The profile at this θ ≥ 0; `None` where Qᵀ V⁻¹ Q is singular to rounding.
    pub fn at(&self, ratio: f64) -> Option<Point> {
        let terms = self.terms;
        let weights: Vec<f64> = self.groups.iter().map(|group| group.count / (1.0 + group.count * ratio)).collect();
        let mut sums = self.within.clone();
        for (group, weight) in self.groups.iter().zip(&weights) {
            add_square(&mut sums, *weight, &group.mean);
        }
        let (inverse, log_det_fixed) = inverse(sums.as_ref().submatrix(0, 0, terms, terms))?;
        let solution: Vec<f64> = (0..terms)
            .map(|row| (0..terms).map(|column| inverse[(row, column)] * sums[(terms, column)]).sum())
            .collect();
        let explained: f64 = solution.iter().enumerate().map(|(column, value)| value * sums[(terms, column)]).sum();
        let residual = (sums[(terms, terms)] - explained).max(f64::MIN_POSITIVE);
        let log_det_v: f64 = self.groups.iter().map(|group| (group.count * ratio).ln_1p()).sum();
        let log_determinants = log_det_v + log_det_fixed;
        let freedom = self.residual_freedom();
        let score =
            |(group, weight): (&Group, &f64)| weight * (group.mean[terms] - dot(&group.mean[..terms], &solution));
        let scores: Vec<f64> = self.groups.iter().zip(&weights).map(score).collect();
        let mut point = Point {
            ratio,
            solution,
            residual,
            log_determinants,
            criterion: freedom * residual.ln() + log_determinants,
            slope: 0.0,
            inverse,
            weights,
            scores,
        };
        point.slope = self.trace(&point) - freedom * point.scores_squared() / residual;
        Some(point)
    }

    /// tr(Zᵀ P Z), the derivative of ln |V| + ln |Qᵀ V⁻¹ Q|.
    fn trace(&self, point: &Point) -> f64 {
        self.leverages(point).iter().zip(&point.weights).map(|(leverage, weight)| weight - leverage).sum()
    }

    /// Of each participant: kᵀ (Qᵀ V⁻¹ Q)⁻¹ k, with k = Qᵀ V⁻¹ 1 = d times the mean row.
    fn leverages(&self, point: &Point) -> Vec<f64> {
        let of =
            |(group, weight): (&Group, &f64)| weight * weight * quadratic(&point.inverse, &group.mean[..self.terms]);
        self.groups.iter().zip(&point.weights).map(of).collect()
    }

    /// Σ k kᵀ over participants, with k as above: minus the derivative of Qᵀ V⁻¹ Q by θ.
    pub fn between(&self, point: &Point) -> Mat<f64> {
        let mut sums = Mat::<f64>::zeros(self.terms, self.terms);
        for (group, weight) in self.groups.iter().zip(&point.weights) {
            add_square(&mut sums, weight * weight, &group.mean[..self.terms]);
        }
        sums
    }

    /// The covariance of the estimates of (θ, σ²): twice the inverse of the second derivatives of −2 ℓ(θ, σ²) =
    /// (n − p) ln σ² + yᵀ P y / σ² + ln |V| + ln |Qᵀ V⁻¹ Q|, the observed information; `None` where they are not positive
    /// definite.
    pub fn variance_covariance(&self, point: &Point) -> Option<[[f64; 2]; 2]> {
        let (freedom, leverages, between) = (self.residual_freedom(), self.leverages(point), self.between(point));
        let variance = point.residual / freedom;
        let mut carried = vec![0.0; self.terms];
        for ((group, weight), score) in self.groups.iter().zip(&point.weights).zip(&point.scores) {
            carried.iter_mut().zip(&group.mean).for_each(|(sum, mean)| *sum += weight * mean * score);
        }
        let weighted: f64 = point.weights.iter().zip(&point.scores).map(|(weight, score)| weight * score * score).sum();
        // d²(yᵀ P y)/dθ² = 2 zᵀ (Zᵀ P Z) z with z = Zᵀ P y; d²(ln |V| + ln |Qᵀ V⁻¹ Q|)/dθ² = −‖Zᵀ P Z‖².
        let residual_curvature = 2.0 * (weighted - quadratic(&point.inverse, &carried));
        let product = &point.inverse * &between;
        let squares: f64 = (0..self.terms)
            .flat_map(|row| (0..self.terms).map(move |column| (row, column)))
            .map(|(row, column)| product[(row, column)] * product[(column, row)])
            .sum();
        let of_groups =
            point.weights.iter().zip(&leverages).map(|(weight, leverage)| weight * (weight - 2.0 * leverage));
        let log_curvature = -(of_groups.sum::<f64>() + squares);
        let ratio_ratio = residual_curvature / variance + log_curvature;
        let ratio_variance = point.scores_squared() / variance.powi(2);
        let variance_variance = freedom / variance.powi(2);
        let determinant = ratio_ratio * variance_variance - ratio_variance.powi(2);
        let positive = ratio_ratio > 0.0 && determinant > 0.0 && determinant.is_finite();
        let half = |entry: f64| 2.0 * entry / determinant;
        positive.then(|| [[half(variance_variance), -half(ratio_variance)], [-half(ratio_variance), half(ratio_ratio)]])
    }
}

impl Point {
    fn scores_squared(&self) -> f64 {
        self.scores.iter().map(|score| score * score).sum()
    }
}

/// Adds weight × v vᵀ.
fn add_square(sums: &mut Mat<f64>, weight: f64, v: &[f64]) {
    for (column, right) in v.iter().enumerate() {
        for (row, left) in v.iter().enumerate() {
            sums[(row, column)] += weight * left * right;
        }
    }
}

/// vᵀ A v.
pub(super) fn quadratic(matrix: &Mat<f64>, v: &[f64]) -> f64 {
    let of_row = |row: usize| v[row] * (0..v.len()).map(|column| matrix[(row, column)] * v[column]).sum::<f64>();
    (0..v.len()).map(of_row).sum()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

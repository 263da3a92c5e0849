//! Ordinary least squares: each session is an observation of its own.

use faer::{
    Mat, Side,
    prelude::{Solve as _, SolveLstsq as _},
};
use statrs::distribution::{ContinuousCDF as _, FisherSnedecor};

use super::{Conditions, Fit, Observation, Term, condition_tests};
use crate::{
    design::{Column, Design, norm},
    interval::{t_95, two_sided_p},
    mixed::WaldTest,
};

/// What is left of the values beyond this share of them is no more than rounding, and counts as nothing.
const ROUNDING: f64 = 1e-12;

/// Estimates, and their covariance.
struct Solution {
    estimates: Mat<f64>,
    covariance: Mat<f64>,
    freedom: f64,
}

impl Fit {
    /// Fits by ordinary least squares; whose sessions they were does not matter.
    #[must_use]
    pub fn least_squares(
        outcome: &str,
        unit: &'static str,
        conditions: &[String],
        observed: &[Observation<'_>],
    ) -> Self {
        let own: Vec<&Conditions> = observed.iter().map(|one| one.conditions).collect();
        let design = Design::new(conditions, &own);
        let mut fit = Self::empty(outcome, unit, observed.len(), &design);
        let values: Vec<f64> = observed.iter().map(|one| one.value).collect();
        if values.len() <= design.columns.len() {
            let (count, terms) = (values.len(), design.columns.len());
            fit.reason = Some(format!("{count} sessions are too few for {terms} terms"));
            return fit;
        }
        match fit.solve(&design.columns, &values) {
            Some(solution) => fit.tests = condition_tests(&design, conditions, &own, |places| solution.test(places)),
            None => fit.reason = Some("the conditions cannot be told apart".to_owned()),
        }
        fit
    }

    fn solve(&mut self, columns: &[Column], values: &[f64]) -> Option<Solution> {
        let (rows, terms) = (values.len(), columns.len());
        let design = Mat::from_fn(rows, terms, |row, column| columns[column].values[row]);
        let target = Mat::from_fn(rows, 1, |row, _| values[row]);
        let estimates = design.qr().solve_lstsq(&target);
        let left = &target - &design * &estimates;
        let nothing = ROUNDING * target.norm_l2();
        let squares = if left.norm_l2() > nothing { left.squared_norm_l2() } else { 0.0 };
        let freedom = (rows - terms) as f64;
        let normal = (design.transpose() * &design).llt(Side::Lower).ok()?;
        let quantile = t_95(freedom)?;
        let inverse = normal.solve(Mat::<f64>::identity(terms, terms));
        let covariance = Mat::from_fn(terms, terms, |row, column| squares / freedom * inverse[(row, column)]);
        let mean = values.iter().sum::<f64>() / rows as f64;
        let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        self.r_squared = (spread > 0.0).then(|| 1.0 - squares / spread);
        let term = |(place, column): (usize, &Column)| {
            let contributed = estimates[(place, 0)] * norm(&column.values);
            let estimate = if contributed.abs() > nothing { estimates[(place, 0)] } else { 0.0 };
            let standard_error = covariance[(place, place)].max(0.0).sqrt();
            let (t, half) = (estimate / standard_error, quantile * standard_error);
            Term {
                name: column.name.clone(),
                estimate,
                standard_error,
                freedom,
                t: Some(t).filter(|t| t.is_finite()),
                interval_95: [estimate - half, estimate + half],
                p: two_sided_p(t, freedom),
            }
        };
        self.terms = columns.iter().enumerate().map(term).collect();
        Some(Solution { estimates, covariance, freedom })
    }
}

impl Solution {
    /// The test that these estimates are all 0: F = bᵀ C⁻¹ b / q; `None` where there is no error.
    fn test(&self, places: &[usize]) -> Option<WaldTest> {
        let count = Some(places.len()).filter(|count| *count > 0)?;
        let own = Mat::from_fn(count, count, |row, column| self.covariance[(places[row], places[column])]);
        let estimates = Mat::from_fn(count, 1, |row, _| self.estimates[(places[row], 0)]);
        let solved = own.llt(Side::Lower).ok()?.solve(&estimates);
        let f = (0..count).map(|row| estimates[(row, 0)] * solved[(row, 0)]).sum::<f64>() / count as f64;
        let p = FisherSnedecor::new(count as f64, self.freedom).ok()?.sf(f);
        f.is_finite().then_some(WaldTest { f, freedom: [count as f64, self.freedom], p })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn conditions(pairs: &[(&str, &str)]) -> Conditions {
        pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
    }

    fn fit(outcome: &str, names: &[&str], observed: &[(f64, &Conditions)]) -> Fit {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let observed: Vec<Observation<'_>> = observed
            .iter()
            .map(|(value, conditions)| Observation { value: *value, participant: "", conditions })
            .collect();
        Fit::least_squares(outcome, "", &names, &observed)
    }

    #[test]
    fn outcomes_without_an_error_are_certain() {
        let (one, two) = (conditions(&[("ask", "never")]), conditions(&[("ask", "always")]));
        for (values, p) in [([3.0, 3.0, 3.0, 3.0], 1.0), ([3.0, 3.0, 5.0, 5.0], 0.0)] {
            let observed = [(values[0], &one), (values[1], &one), (values[2], &two), (values[3], &two)];
            let fit = fit("actions", &["ask"], &observed);
            assert!((fit.terms[1].p - p).abs() < 1e-6, "{fit:?}");
            assert!(fit.tests.is_empty(), "{fit:?}");
        }
    }

    #[test]
    fn a_line_is_fitted_as_the_literature_has_it() {
        // Anscombe's first quartet (1973): intercept 3.0001 (standard error 1.1247), slope 0.5001 (0.1179), R² 0.6665.
        let data = [
            (8.04, "10"),
            (6.95, "8"),
            (7.58, "13"),
            (8.81, "9"),
            (8.33, "11"),
            (9.96, "14"),
            (7.24, "6"),
            (4.26, "4"),
            (10.84, "12"),
            (4.82, "7"),
            (5.68, "5"),
        ];
        let all: Vec<_> = data.iter().map(|(y, x)| (*y, conditions(&[("x", x)]))).collect();
        let fit = fit("y", &["x"], &all.iter().map(|(y, own)| (*y, own)).collect::<Vec<_>>());
        let found: Vec<[f64; 2]> = fit.terms.iter().map(|term| [term.estimate, term.standard_error]).collect();
        for (found, wanted) in found.iter().flatten().zip([3.0001, 1.1247, 0.5001, 0.1179]) {
            assert!((found - wanted).abs() < 1e-4, "{found} is not {wanted}");
        }
        assert!((fit.r_squared.unwrap() - 0.6665).abs() < 1e-4);
        assert!((fit.terms[1].p - 0.00217).abs() < 1e-5, "{}", fit.terms[1].p);
        let [low, high] = fit.terms[1].interval_95;
        assert!((low - 0.2333).abs() < 1e-3 && (high - 0.7668).abs() < 1e-3, "{low} {high}");
        // One column: F is t².
        assert!((fit.tests[0].f - fit.terms[1].t.unwrap().powi(2)).abs() < 1e-9);
        assert!((fit.tests[0].p - fit.terms[1].p).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_told_apart_is_left_out_and_too_few_are_not_fitted() {
        let own = [
            conditions(&[("ask", "never"), ("group", "a")]),
            conditions(&[("ask", "never"), ("group", "a")]),
            conditions(&[("ask", "unsure"), ("group", "b")]),
            conditions(&[("ask", "unsure"), ("group", "b")]),
        ];
        let observed: Vec<_> = [1.0, 3.0, 5.0, 7.0].into_iter().zip(&own).collect();
        let fitted = fit("actions", &["ask", "group"], &observed);
        assert_eq!(fitted.left_out, ["group b, not a"]);
        let estimates: Vec<f64> = fitted.terms.iter().map(|term| term.estimate).collect();
        assert!((estimates[0] - 2.0).abs() < 1e-12 && (estimates[1] - 4.0).abs() < 1e-12, "{estimates:?}");
        assert_eq!(fitted.terms[1].name, "ask unsure, not never");
        let few = fit("actions", &["ask", "group"], &observed[1..3]);
        assert!(few.terms.is_empty() && few.reason.unwrap().contains("2 sessions are too few for 2 terms"));
    }
}

//! A least-squares fit of an outcome on conditions.

use std::collections::BTreeMap;

use faer::{
    Mat, Side,
    prelude::{Solve as _, SolveLstsq as _},
};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

use crate::interval::t_95;

/// How an outcome depends on the conditions, as a sum of what each does by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The outcome.
    pub outcome: String,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Sessions that have it.
    pub sessions: usize,
    /// The share of its variance that the conditions explain; nothing where it does not vary.
    pub r_squared: Option<f64>,
    /// The outcome where all conditions are at their reference, then what each other value adds, or each unit of a number.
    pub terms: Vec<Term>,
    /// Conditions that these sessions do not tell apart from those before them.
    pub left_out: Vec<String>,
    /// Why there is none, if there is none.
    pub reason: Option<String>,
}

/// What a condition does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// Which condition, and which value, against which.
    pub name: String,
    /// The estimate, in the outcome's unit.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Its 95 % interval, by Student's t.
    pub interval_95: [f64; 2],
    /// How probable as large an estimate were if it did nothing.
    pub p: f64,
}

/// A column of the design: what it stands for, and its value in each observation.
struct Column {
    name: String,
    values: Vec<f64>,
}

/// A column counts as a sum of those before it if so little of it is left beside them.
const NOTHING_NEW: f64 = 1e-8;

/// What is left of the values beyond this share of them is no more than rounding, and counts as nothing.
const ROUNDING: f64 = 1e-12;

impl Fit {
    /// Fits `values`, one an observation, on the conditions that each was observed under.
    pub(crate) fn new(
        outcome: &str,
        unit: &'static str,
        conditions: &[String],
        observed: &[(f64, &BTreeMap<String, String>)],
    ) -> Self {
        let (columns, left_out) = independent(design(conditions, observed), observed.len());
        let mut fit = Self {
            outcome: outcome.to_owned(),
            unit,
            sessions: observed.len(),
            r_squared: None,
            terms: Vec::new(),
            left_out,
            reason: None,
        };
        let values: Vec<f64> = observed.iter().map(|(value, _)| *value).collect();
        if values.len() <= columns.len() {
            let (count, terms) = (values.len(), columns.len());
            fit.reason = Some(format!("{count} sessions are too few for {terms} terms"));
            return fit;
        }
        fit.solve(&columns, &values);
        fit
    }

    fn solve(&mut self, columns: &[Column], values: &[f64]) {
        let (rows, terms) = (values.len(), columns.len());
        let design = Mat::from_fn(rows, terms, |row, column| columns[column].values[row]);
        let target = Mat::from_fn(rows, 1, |row, _| values[row]);
        let estimates = design.qr().solve_lstsq(&target);
        let left = &target - &design * &estimates;
        let nothing = ROUNDING * target.norm_l2();
        let squares = if left.norm_l2() > nothing { left.squared_norm_l2() } else { 0.0 };
        let freedom = (rows - terms) as f64;
        let (Ok(normal), Some(quantile)) = ((design.transpose() * &design).llt(Side::Lower), t_95(freedom)) else {
            self.reason = Some("the conditions cannot be told apart".to_owned());
            return;
        };
        let covariance = normal.solve(Mat::<f64>::identity(terms, terms));
        let mean = values.iter().sum::<f64>() / rows as f64;
        let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        self.r_squared = (spread > 0.0).then(|| 1.0 - squares / spread);
        let term = |(place, column): (usize, &Column)| {
            let contributed = estimates[(place, 0)] * norm(&column.values);
            let estimate = if contributed.abs() > nothing { estimates[(place, 0)] } else { 0.0 };
            let standard_error = (squares / freedom * covariance[(place, place)]).max(0.0).sqrt();
            let half = quantile * standard_error;
            let interval_95 = [estimate - half, estimate + half];
            Term {
                name: column.name.clone(),
                estimate,
                standard_error,
                interval_95,
                p: p(estimate / standard_error, freedom),
            }
        };
        self.terms = columns.iter().enumerate().map(term).collect();
    }
}

/// How probable it is that Student's t is as far from 0, either way. Outcomes that fit without an error say for certain
/// whether a condition does anything.
fn p(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return if t.is_nan() { 1.0 } else { 0.0 };
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |distribution| 2.0 * distribution.sf(t.abs()))
}

/// A column of ones; for each condition that is a number one of its values; for each other one column for every value
/// but the commonest, its reference.
fn design(conditions: &[String], observed: &[(f64, &BTreeMap<String, String>)]) -> Vec<Column> {
    let ones = Column { name: "(at the references)".to_owned(), values: vec![1.0; observed.len()] };
    let mut columns = vec![ones];
    for condition in conditions {
        let values: Vec<&str> = observed.iter().map(|(_, own)| value(own, condition)).collect();
        let mut counts = BTreeMap::<&str, usize>::new();
        for value in &values {
            *counts.entry(value).or_default() += 1;
        }
        let numbers: Option<Vec<f64>> = values.iter().map(|value| value.parse().ok()).collect();
        match numbers.filter(|_| counts.len() > 2) {
            Some(numbers) => columns.push(Column { name: format!("{condition}, per 1"), values: numbers }),
            None => columns.extend(dummies(condition, &values, &counts)),
        }
    }
    columns
}

fn dummies(condition: &str, values: &[&str], counts: &BTreeMap<&str, usize>) -> Vec<Column> {
    let most = counts.values().copied().max().unwrap_or(0);
    let reference = counts.iter().find(|(_, count)| **count == most).map_or("", |(value, _)| value);
    let others = counts.keys().filter(|value| **value != reference);
    others
        .map(|other| Column {
            name: format!("{condition} {other}, not {reference}"),
            values: values.iter().map(|value| f64::from(u8::from(value == other))).collect(),
        })
        .collect()
}

/// What a session's condition is; a dash where it is not noted.
pub(crate) fn value<'a>(conditions: &'a BTreeMap<String, String>, name: &str) -> &'a str {
    conditions.get(name).map_or("–", String::as_str)
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// The columns that are no sums of those before them, and the names of the others (modified Gram–Schmidt).
fn independent(columns: Vec<Column>, rows: usize) -> (Vec<Column>, Vec<String>) {
    let (mut kept, mut left_out, mut basis) = (Vec::new(), Vec::new(), Vec::<Vec<f64>>::new());
    for column in columns {
        let mut rest = column.values.clone();
        for direction in &basis {
            let along: f64 = rest.iter().zip(direction).map(|(a, b)| a * b).sum();
            rest.iter_mut().zip(direction).for_each(|(value, direction)| *value -= along * direction);
        }
        let (whole, new) = (norm(&column.values), norm(&rest));
        if rows > 0 && new > NOTHING_NEW * whole {
            basis.push(rest.into_iter().map(|value| value / new).collect());
            kept.push(column);
        } else {
            left_out.push(column.name);
        }
    }
    (kept, left_out)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn conditions(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
        pairs.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
    }

    #[test]
    fn outcomes_without_an_error_are_certain() {
        let (one, two) = (conditions(&[("ask", "never")]), conditions(&[("ask", "always")]));
        for (values, p) in [([3.0, 3.0, 3.0, 3.0], 1.0), ([3.0, 3.0, 5.0, 5.0], 0.0)] {
            let observed = [(values[0], &one), (values[1], &one), (values[2], &two), (values[3], &two)];
            let fit = Fit::new("actions", "", &["ask".to_owned()], &observed);
            assert!((fit.terms[1].p - p).abs() < 1e-6, "{fit:?}");
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
        let observed: Vec<_> = all.iter().map(|(y, own)| (*y, own)).collect();
        let fit = Fit::new("y", "", &["x".to_owned()], &observed);
        let found: Vec<[f64; 2]> = fit.terms.iter().map(|term| [term.estimate, term.standard_error]).collect();
        for (found, wanted) in found.iter().flatten().zip([3.0001, 1.1247, 0.5001, 0.1179]) {
            assert!((found - wanted).abs() < 1e-4, "{found} is not {wanted}");
        }
        assert!((fit.r_squared.unwrap() - 0.6665).abs() < 1e-4);
        assert!((fit.terms[1].p - 0.00217).abs() < 1e-5, "{}", fit.terms[1].p);
        let [low, high] = fit.terms[1].interval_95;
        assert!((low - 0.2333).abs() < 1e-3 && (high - 0.7668).abs() < 1e-3, "{low} {high}");
    }

    #[test]
    fn what_cannot_be_told_apart_is_left_out_and_too_few_are_not_fitted() {
        let own = [
            conditions(&[("ask", "never"), ("group", "a")]),
            conditions(&[("ask", "never"), ("group", "a")]),
            conditions(&[("ask", "unsure"), ("group", "b")]),
            conditions(&[("ask", "unsure"), ("group", "b")]),
        ];
        let names = ["ask".to_owned(), "group".to_owned()];
        let observed: Vec<_> = [1.0, 3.0, 5.0, 7.0].into_iter().zip(&own).collect();
        let fit = Fit::new("actions", "", &names, &observed);
        assert_eq!(fit.left_out, ["group b, not a"]);
        let estimates: Vec<f64> = fit.terms.iter().map(|term| term.estimate).collect();
        assert!((estimates[0] - 2.0).abs() < 1e-12 && (estimates[1] - 4.0).abs() < 1e-12, "{estimates:?}");
        assert_eq!(fit.terms[1].name, "ask unsure, not never");
        let few = Fit::new("actions", "", &names, &observed[1..3]);
        assert!(few.terms.is_empty() && few.reason.unwrap().contains("2 sessions are too few for 2 terms"));
    }
}

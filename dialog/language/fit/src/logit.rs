//! The conditional logit: its likelihood, and Newton's method on it. With two alternatives, of which one has no
//! features, it is a logistic regression.

use faer::{Mat, Side, prelude::Solve as _};

/// One choice: the features of each alternative, which was chosen, and how much that counts.
pub struct Choice {
    pub weight: f64,
    pub alternatives: Vec<Vec<f64>>,
    pub chosen: usize,
}

/// How strongly weights are drawn to zero: the precision of their Gaussian prior.
const RIDGE: f64 = 1.0;
const MOST_STEPS: usize = 50;
const CONVERGED: f64 = 1e-9;

/// The probabilities of the alternatives.
pub fn probabilities(weights: &[f64], alternatives: &[Vec<f64>]) -> Vec<f64> {
    let utility = |one: &Vec<f64>| one.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>();
    let utilities: Vec<f64> = alternatives.iter().map(utility).collect();
    let highest = utilities.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let parts: Vec<f64> = utilities.iter().map(|utility| (utility - highest).exp()).collect();
    let whole: f64 = parts.iter().sum();
    parts.into_iter().map(|part| part / whole).collect()
}

/// The mean of minus the logarithm of what was chosen, nats.
pub fn loss(weights: &[f64], choices: &[Choice]) -> f64 {
    let of =
        |choice: &Choice| -choice.weight * probabilities(weights, &choice.alternatives)[choice.chosen].max(1e-300).ln();
    choices.iter().map(of).sum::<f64>() / choices.len().max(1) as f64
}

/// The weights of highest posterior probability, by Newton's method: the likelihood is concave, so it has one.
pub fn fit(choices: &[Choice], count: usize) -> Vec<f64> {
    let mut weights = vec![0.0; count];
    let objective = |weights: &[f64]| {
        let size: f64 = weights.iter().map(|weight| weight * weight).sum();
        loss(weights, choices) * choices.len() as f64 + RIDGE / 2.0 * size
    };
    for step in 0..MOST_STEPS {
        let (gradient, hessian) = derivatives(&weights, choices);
        let factor = hessian.llt(Side::Lower).expect("the ridge makes the curvature positive");
        let newton = factor.solve(&gradient);
        let before = objective(&weights);
        let mut scale = 1.0;
        let next = loop {
            let next: Vec<f64> = (0..count).map(|at| weights[at] - scale * newton[(at, 0)]).collect();
            if objective(&next) <= before || scale < 1e-6 {
                break next;
            }
            scale /= 2.0;
        };
        let gain = before - objective(&next);
        weights = next;
        eprintln!("step {step}: loss {:.5}", loss(&weights, choices));
        if gain < CONVERGED * before.abs() {
            break;
        }
    }
    weights
}

/// Gradient and Hessian of minus the logarithm of the posterior.
fn derivatives(weights: &[f64], choices: &[Choice]) -> (Mat<f64>, Mat<f64>) {
    let count = weights.len();
    let mut gradient = Mat::from_fn(count, 1, |at, _| RIDGE * weights[at]);
    let mut hessian = Mat::from_fn(count, count, |row, column| if row == column { RIDGE } else { 0.0 });
    for choice in choices {
        let shares = probabilities(weights, &choice.alternatives);
        let mut mean = vec![0.0; count];
        for (share, features) in shares.iter().zip(&choice.alternatives) {
            mean.iter_mut().zip(features).for_each(|(mean, value)| *mean += share * value);
        }
        for (at, (mean, chosen)) in mean.iter().zip(&choice.alternatives[choice.chosen]).enumerate() {
            gradient[(at, 0)] += choice.weight * (mean - chosen);
        }
        for (share, features) in shares.iter().zip(&choice.alternatives).filter(|(share, _)| **share > 1e-12) {
            for row in 0..count {
                let across = choice.weight * share * (features[row] - mean[row]);
                for column in 0..=row {
                    hessian[(row, column)] += across * (features[column] - mean[column]);
                }
            }
        }
    }
    (gradient, hessian)
}

//! How likely an utterance tells the robot to stop, by what it means: a logistic regression on the directions of the model of meaning,
//! fitted to the corpus by `dialog/language/fit`. It hears wordings that no list has; [`crate::stop`] hears those of the lists.

use std::sync::LazyLock;

use cohabit_parser::Direction;
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Weights {
    constant: f64,
    /// For each number of a direction of length 1.
    direction: Vec<f64>,
}

static WEIGHTS: LazyLock<Weights> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/stop_likeness.toml"))
        .expect("invariant: the built-in weights parse, which a test holds")
});

/// How likely an utterance of that direction tells the robot to stop, from 0 to 1.
pub(crate) fn probability(said: &Direction) -> f32 {
    let utility = unit(said).zip(&WEIGHTS.direction).map(|(number, weight)| number * weight).sum::<f64>();
    (1.0 / (1.0 + (-utility - WEIGHTS.constant).exp())) as f32
}

/// The numbers of a direction, with length 1.
fn unit(said: &Direction) -> impl Iterator<Item = f64> {
    let length = said.numbers().iter().map(|number| f64::from(*number).powi(2)).sum::<f64>().sqrt().max(1.0);
    said.numbers().iter().map(move |number| f64::from(*number) / length)
}

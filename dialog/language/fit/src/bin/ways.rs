//! Fits the weights of `dialog/language/data/ways.toml`: how likely each way to take an utterance is the one that is meant.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin ways -- SET…
//! ```
//!
//! The sets of `dialog/language/tests/utterances/writers` that are named have to be such as the rewriter has not read (`UNSEEN` in
//! `dialog/rewriter/train/fit.py`): it is surer of what it has. A sixth of the sets at a time is judged by weights that are
//! fitted to the others.

#[path = "../all_cores.rs"]
mod all_cores;
#[path = "../calibration.rs"]
mod calibration;
#[path = "../logit.rs"]
mod logit;
#[path = "../sets.rs"]
mod sets;
#[path = "../../../tests/support/mod.rs"]
mod support;

use std::{fmt::Write as _, fs};

use cohabit_language::Evidence;

use calibration::Calibration;
use logit::Choice;
use support::cases::{self, Case, Expected};

const BINS: usize = 10;
/// Of so many parts of the sets one is judged by weights fitted to the others.
const PARTS: usize = 6;

/// The ways to take an utterance, and which of them is right.
struct Ways {
    evidence: Vec<Vec<f64>>,
    right: Vec<bool>,
}

fn main() {
    let named: Vec<String> = std::env::args().skip(1).collect();
    assert!(
        !named.is_empty(),
        "name sets that the rewriter has not read: {}",
        sets::folder("../tests/utterances/writers").display()
    );
    let sets = sets::read("../tests/utterances/writers", &named);
    let sets: Vec<Vec<Ways>> =
        sets.iter().map(|(_, text)| all_cores::filter_map(&cases::cases(text), Ways::new)).collect();
    let mut said = Vec::new();
    for part in 0..PARTS {
        let of = |is_judged: bool| {
            sets.iter().enumerate().filter(move |(at, _)| (at % PARTS == part) == is_judged).flat_map(|(_, set)| set)
        };
        let weights = fitted(of(false));
        said.extend(of(true).map(|ways| ways.judged(&weights)));
    }
    let judged = Calibration::new(&said, BINS);
    for (count, mean, held) in &judged.bins {
        println!("{count:6} said {mean:.3}, held {held:.3}");
    }
    let first = sets.iter().flatten().filter(|ways| ways.right[0]).count();
    let any = sets.iter().flatten().filter(|ways| ways.right.contains(&true)).count();
    println!(
        "of {}: likeliest by the rewriter {first}, by these weights {:.0}, any {any}",
        said.len(),
        judged.accuracy * said.len() as f64
    );
    let weights = fitted(sets.iter().flatten());
    fs::write(sets::folder("../data/ways.toml"), file(&weights, &named, said.len(), &judged))
        .expect("the weights can be written");
}

impl Ways {
    fn new(case: &Case<'_>) -> Option<Self> {
        let talk = cases::before(case);
        let expected = Expected::new(case, &talk)?;
        let ways = talk.language.ways(case.said.last()?, &talk.scene, &talk.context);
        let wide = |evidence: &Evidence| evidence.values.iter().copied().map(f64::from).collect();
        (!ways.is_empty()).then(|| Self {
            evidence: ways.iter().map(|(_, _, evidence)| wide(evidence)).collect(),
            right: ways.iter().map(|(_, understanding, _)| expected.is_met(understanding, &talk)).collect(),
        })
    }

    /// The first that is right, or none of them: an alternative without evidence.
    fn choice(&self) -> Choice {
        let mut alternatives = self.evidence.clone();
        alternatives.push(vec![0.0; Evidence::COUNT]);
        let chosen = self.right.iter().position(|right| *right).unwrap_or(self.right.len());
        Choice { weight: 1.0, alternatives, chosen }
    }

    /// The probability of the likeliest way, and whether it is right.
    fn judged(&self, weights: &[f64]) -> (f64, bool) {
        let shares = logit::probabilities(weights, &self.choice().alternatives);
        let best = (0..self.right.len()).max_by(|one, other| shares[*one].total_cmp(&shares[*other]));
        best.map_or((0.0, false), |best| (shares[best], self.right[best]))
    }
}

fn fitted<'w>(ways: impl Iterator<Item = &'w Ways>) -> Vec<f64> {
    logit::fit(&ways.map(Ways::choice).collect::<Vec<_>>(), Evidence::COUNT)
}

fn file(weights: &[f64], sets: &[String], count: usize, judged: &Calibration) -> String {
    let Calibration { error, accuracy, .. } = judged;
    let mut text = format!(
        "# How much each piece of evidence counts, in nats per unit of it, for a way to take an utterance being the one that is meant.\n\
         # `src/talk/evidence.rs` says what it is. Written by\n\
         #\n\
         #     cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin ways -- {}\n\
         #\n\
         # Fitted, with a ridge of 1, to {count} utterances of people whose words the rewriter had not read. Judged on a sixth of the sets at\n\
         # a time, with weights fitted to the others: expected calibration error {error:.4} in {BINS} bins; the likeliest is right in {accuracy:.4}.\n\n",
        sets.join(" ")
    );
    for (name, weight) in Evidence::NAMES.iter().zip(weights) {
        let _ = writeln!(text, "{name} = {weight:.4}");
    }
    text
}

//! Fits the weights of `dialog/language/data/alternatives.toml` to labelled utterances, and says how well they hold.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin alternatives
//! ```
//!
//! What is fitted to are the sets of `dialog/language/tests/utterances` that may be looked at; what it is judged on is held out.

#[path = "../logit.rs"]
mod logit;
#[path = "../../../tests/support/mod.rs"]
mod support;

use std::{fmt::Write as _, fs, path::Path};

use cohabit_language::{Evidence, Understanding};
use support::{
    Talk,
    cases::{self, Case},
};

use crate::logit::Choice;

/// The sets that are fitted to, and how much each of their utterances counts: the grammar was written with some of them in sight, and
/// reads them better than what it has not met.
const FITTED: [(&str, f64); 7] = [
    ("newcomers", 1.0),
    ("first_contact", 1.0),
    ("first_contact_again", 1.0),
    ("seen", 0.3),
    ("voices", 0.3),
    ("manners", 0.3),
    ("spoken", 0.3),
];
const HELD_OUT: &str = "held_out";
/// What is no request: nothing that is done is right.
const OFF_DOMAIN: (&str, f64) = ("off_domain", 0.5);
/// How often the weights are fitted anew, each time to the ways that are right, by how likely they then are (expectation maximisation).
const ROUNDS: usize = 8;

/// What speaks for each way to understand an utterance, and which of them are right.
struct Ways {
    weight: f64,
    evidence: Vec<Vec<f64>>,
    right: Vec<usize>,
}

impl Ways {
    fn of_case(case: &Case<'_>, weight: f64) -> Option<Self> {
        let talk = cases::before(case);
        let is_right = |understanding: &Understanding| {
            let found = cases::found(understanding, &talk.scene);
            case.expected.iter().any(|expected| cases::is_as(expected, understanding, &found))
        };
        Self::new(&talk, case.said.last()?, is_right, weight)
    }

    fn off_domain(said: &str, weight: f64) -> Option<Self> {
        Self::new(&Talk::new(&[]), said, |understanding| !matches!(understanding, Understanding::Plan { .. }), weight)
    }

    fn new(talk: &Talk, said: &str, is_right: impl Fn(&Understanding) -> bool, weight: f64) -> Option<Self> {
        let ways = talk.language.alternatives(said, &talk.scene, &talk.context);
        // What speaks for itself is not weighed.
        if ways.len() == 1 {
            return None;
        }
        let mut right: Vec<usize> = (0..ways.len()).filter(|at| is_right(&ways[*at].understanding)).collect();
        let wide = |evidence: &Evidence| evidence.values.iter().copied().map(f64::from).chain([0.0]).collect();
        let mut evidence: Vec<Vec<f64>> = ways.iter().map(|way| wide(&way.evidence)).collect();
        // None of them.
        let mut none = vec![0.0; Evidence::COUNT + 1];
        none[Evidence::COUNT] = 1.0;
        if right.is_empty() {
            right.push(evidence.len());
        }
        evidence.push(none);
        Some(Self { weight, evidence, right })
    }

    /// Each of those that are right may be the one that is meant, as likely as it is among them.
    fn choices(&self, weights: &[f64]) -> impl Iterator<Item = Choice> {
        let shares = logit::probabilities(weights, &self.evidence);
        let whole: f64 = self.right.iter().map(|at| shares[*at]).sum();
        self.right.iter().map(move |at| Choice {
            weight: self.weight * shares[*at] / whole,
            alternatives: self.evidence.clone(),
            chosen: *at,
        })
    }

    /// Whether the likeliest of all is right.
    fn is_right(&self, weights: &[f64]) -> bool {
        let shares = logit::probabilities(weights, &self.evidence);
        let likeliest = (0..shares.len() - 1).max_by(|one, other| shares[*one].total_cmp(&shares[*other]));
        likeliest.is_some_and(|likeliest| self.right.contains(&likeliest))
    }
}

fn main() {
    let mut fitted: Vec<Ways> = FITTED.iter().flat_map(|(set, weight)| ways(set, *weight)).collect();
    let off_domain = read(OFF_DOMAIN.0);
    let no_requests = off_domain.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    fitted.extend(no_requests.filter_map(|said| Ways::off_domain(said, OFF_DOMAIN.1)));
    let mut weights = vec![0.0; Evidence::COUNT + 1];
    for _ in 0..ROUNDS {
        let choices: Vec<Choice> = fitted.iter().flat_map(|one| one.choices(&weights)).collect();
        weights = logit::fit(&choices, weights.len());
    }
    let held_out = ways(HELD_OUT, 1.0);
    let right = |ways: &[Ways]| ways.iter().filter(|one| one.is_right(&weights)).count();
    let judged = [right(&fitted), fitted.len(), right(&held_out), held_out.len()];
    println!("the likeliest way is right: {} of {}, held out {} of {}", judged[0], judged[1], judged[2], judged[3]);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/alternatives.toml");
    fs::write(path, head(judged) + &table(&weights)).expect("the weights can be written");
}

fn read(set: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/utterances/{set}.txt"));
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn ways(set: &str, weight: f64) -> Vec<Ways> {
    cases::cases(&read(set)).iter().filter_map(|case| Ways::of_case(case, weight)).collect()
}

fn head([right, fitted, right_held_out, held_out]: [usize; 4]) -> String {
    let sets: Vec<String> =
        FITTED.iter().chain([&OFF_DOMAIN]).map(|(set, weight)| format!("{set} ({weight})")).collect();
    format!(
        "# How much each evidence counts for a way to understand an utterance, in nats per unit of it, and the utility of none of the\n\
         # ways. `src/evidence.rs` says what the evidence is. Written by\n\
         #\n\
         #     cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin alternatives\n\
         #\n\
         # Fitted, with a ridge of 1, to {fitted} utterances of tests/utterances (and how much each counts):\n\
         # {}.\n\
         # The likeliest way is right for {right} of these, and for {right_held_out} of {held_out} in {HELD_OUT}.\n\n",
        sets.join(", ")
    )
}

fn table(weights: &[f64]) -> String {
    let mut text = format!("none = {:.4}\n\n[evidence]\n", weights[Evidence::COUNT]);
    for (name, weight) in Evidence::NAMES.iter().zip(weights) {
        let _ = writeln!(text, "{name} = {weight:.4}");
    }
    text
}

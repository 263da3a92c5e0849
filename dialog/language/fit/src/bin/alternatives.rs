//! Fits the weights of `dialog/language/data/alternatives.toml` to labelled utterances, and says how well they hold.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin ways
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin alternatives
//! ```
//!
//! With `-- first` only the first weights are fitted anew, as before a fit of the re-ranker; with `-- second` only the second, as after one.
//!
//! The first weights are fitted to the sets of `dialog/language/tests/utterances` that may be looked at, and to writers whom the re-ranker has
//! learnt from and the parser has not, as `ways` has written them; the second to writers whom neither has, so that they do not rely on a
//! re-ranker that knows the answers. What they are judged on is held out.

#[path = "../all_cores.rs"]
mod all_cores;
#[path = "../logit.rs"]
mod logit;
#[path = "../../../tests/support/mod.rs"]
mod support;

use std::{collections::BTreeMap, fmt::Write as _, fs, path::Path};

use cohabit_language::{Evidence, Fit, Understanding};
use serde::Deserialize;
use support::{
    Talk,
    cases::{self, Case, Expected},
};

use crate::logit::Choice;

/// The sets that the first weights are fitted to, and how much each of their utterances counts: the grammar was written with some of them
/// in sight, and reads them better than what it has not met.
const FIRST: [(&str, f64); 21] = [
    ("newcomers", 1.0),
    ("first_contact", 1.0),
    ("first_contact_again", 1.0),
    ("writers/aa", 1.0),
    ("writers/ac", 1.0),
    ("writers/ae", 1.0),
    ("writers/ag", 1.0),
    ("writers/ai", 1.0),
    ("writers/ak", 1.0),
    ("writers/ar", 1.0),
    ("writers/as", 1.0),
    ("writers/at", 1.0),
    ("writers/au", 1.0),
    ("writers/ax", 1.0),
    ("writers/ay", 1.0),
    ("writers/az", 1.0),
    ("writers/ba", 1.0),
    ("seen", 0.3),
    ("voices", 0.3),
    ("manners", 0.3),
    ("spoken", 0.3),
];
/// Those that the second weights are fitted to. Of those that the re-ranker has learnt from it has not met what the grammar reads to the last
/// word.
const SECOND: [(&str, f64); 15] = [
    ("writers/a", 1.0),
    ("writers/b", 1.0),
    ("writers/c", 1.0),
    ("writers/d", 1.0),
    ("writers/x", 1.0),
    ("writers/y", 1.0),
    ("writers/al", 1.0),
    ("writers/am", 1.0),
    ("writers/av", 1.0),
    ("writers/bb", 1.0),
    ("writers/bd", 1.0),
    ("writers/be", 1.0),
    ("seen", 0.7),
    ("manners", 0.7),
    ("spoken", 0.7),
];
const HELD_OUT: &str = "held_out";
/// What is no request: nothing that is done is right.
const OFF_DOMAIN: (&str, f64) = ("off_domain", 1.0);
/// How often the weights are fitted anew, each time to the ways that are right, by how likely they then are (expectation maximisation).
const ROUNDS: usize = 8;

/// What speaks for each way to understand an utterance, and which of them are right.
struct Ways {
    weight: f64,
    evidence: Vec<Evidence>,
    fit: Vec<Option<Fit>>,
    right: Vec<usize>,
}

/// Ways as a logit sees them, the last alternative being that none of them is meant.
struct Alternatives {
    weight: f64,
    features: Vec<Vec<f64>>,
    right: Vec<usize>,
}

impl Ways {
    fn of_case(case: &Case<'_>, weight: f64) -> Option<Self> {
        let talk = cases::before(case);
        let expected = Expected::new(case, &talk)?;
        Self::new(&talk, case.said.last()?, |understanding| expected.is_met(understanding, &talk), weight)
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
        let right = (0..ways.len()).filter(|at| is_right(&ways[*at].understanding)).collect();
        let (evidence, fit) = ways.iter().map(|way| (way.evidence, way.fit)).unzip();
        Some(Self { weight, evidence, fit, right })
    }

    fn first(&self) -> Alternatives {
        Alternatives::new(self.weight, self.evidence.iter().map(|one| one.values.as_slice()), self.right.clone())
    }

    /// Those that the re-ranker has read, with how likely they are by the first weights, if these are new.
    fn second(&self, weights: Option<&[f64]>) -> Alternatives {
        let mut fits: Vec<Fit> = self.fit.iter().copied().flatten().collect();
        if let Some(weights) = weights {
            let shares = logit::probabilities(weights, &self.first().features);
            let none = shares[shares.len() - 1] as f32;
            fits.iter_mut().zip(&shares).for_each(|(fit, share)| *fit = fit.with_first(*share as f32, none));
        }
        // These come first.
        let right = self.right.iter().copied().filter(|at| *at < fits.len()).collect();
        let values: Vec<Vec<f32>> = fits
            .iter()
            .zip(&self.evidence)
            .map(|(fit, evidence)| [&fit.values[..], &evidence.values[..]].concat())
            .collect();
        Alternatives::new(self.weight, values.iter().map(Vec::as_slice), right)
    }
}

impl Alternatives {
    fn new<'a>(weight: f64, values: impl Iterator<Item = &'a [f32]>, mut right: Vec<usize>) -> Self {
        let mut features: Vec<Vec<f64>> =
            values.map(|values| values.iter().copied().map(f64::from).chain([0.0]).collect()).collect();
        let mut none = vec![0.0; features.first().map_or(1, Vec::len)];
        *none.last_mut().expect("it has a constant") = 1.0;
        if right.is_empty() {
            right.push(features.len());
        }
        features.push(none);
        Self { weight, features, right }
    }

    /// Each of those that are right may be the one that is meant, as likely as it is among them.
    fn choices(&self, weights: &[f64]) -> impl Iterator<Item = Choice> {
        let shares = logit::probabilities(weights, &self.features);
        let whole: f64 = self.right.iter().map(|at| shares[*at]).sum();
        self.right.iter().map(move |at| Choice {
            weight: self.weight * shares[*at] / whole,
            alternatives: self.features.clone(),
            chosen: *at,
        })
    }

    /// Whether the likeliest of all is right.
    fn is_right(&self, weights: &[f64]) -> bool {
        let shares = logit::probabilities(weights, &self.features);
        let likeliest = (0..shares.len() - 1).max_by(|one, other| shares[*one].total_cmp(&shares[*other]));
        likeliest.is_some_and(|likeliest| self.right.contains(&likeliest))
    }
}

fn main() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/alternatives.toml");
    let only = std::env::args().nth(1);
    let first_weights = (only.as_deref() != Some("second")).then(fitted_first);
    let before = fs::read_to_string(&path).expect("the weights so far");
    let first = match &first_weights {
        Some(weights) => section("first", Evidence::NAMES.iter().chain(&["none"]), weights),
        None => {
            let first = before.split("[first]").nth(1).and_then(|rest| rest.split("[fit]").next());
            format!("[first]{}", first.expect("the weights so far have a table of the first"))
        }
    };
    if only.as_deref() == Some("first") {
        let head = before.split("[first]").next().expect("a text begins somewhere");
        let rest = before.split("[fit]").nth(1).expect("the weights so far have a table of the fit");
        return fs::write(path, format!("{head}{first}[fit]{rest}")).expect("the weights can be written");
    }
    let mut second: Vec<Ways> = SECOND.iter().flat_map(|(set, weight)| ways(set, *weight)).collect();
    second.extend(off_domain());
    let held_out = ways(HELD_OUT, 1.0);
    let of_first = |ways: &[Ways]| ways.iter().map(Ways::first).collect::<Vec<_>>();
    let of_second =
        |ways: &[Ways]| -> Vec<Alternatives> { ways.iter().map(|one| one.second(first_weights.as_deref())).collect() };
    let second_weights = fitted(&of_second(&second));
    let right = |ways: &[Alternatives], weights: &[f64]| {
        format!("{} of {}", ways.iter().filter(|one| one.is_right(weights)).count(), ways.len())
    };
    if let Some(weights) = &first_weights {
        let judged = [right(&of_first(&second), weights), right(&of_first(&held_out), weights)];
        println!("by the first weights the likeliest way is right: {}", judged.join(", held out "));
    }
    let judged = [right(&of_second(&second), &second_weights), right(&of_second(&held_out), &second_weights)];
    println!("by the second weights the likeliest way is right: {}", judged.join(", held out "));
    let (fit, second) = second_weights.split_at(Fit::COUNT);
    let second = section("second", Evidence::NAMES.iter().chain(&["none"]), second);
    let text = format!("{}{first}{}{second}", head(&judged), section("fit", Fit::NAMES.iter(), fit));
    fs::write(path, text).expect("the weights can be written");
}

fn fitted_first() -> Vec<f64> {
    let mut first: Vec<Ways> = FIRST.iter().flat_map(|(set, weight)| written(set, *weight)).collect();
    first.extend(off_domain());
    fitted(&first.iter().map(Ways::first).collect::<Vec<_>>())
}

fn fitted(ways: &[Alternatives]) -> Vec<f64> {
    let mut weights = vec![0.0; ways[0].features[0].len()];
    for _ in 0..ROUNDS {
        let choices: Vec<Choice> = ways.iter().flat_map(|one| one.choices(&weights)).collect();
        weights = logit::fit(&choices, weights.len());
    }
    weights
}

fn read(set: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/utterances/{set}.txt"));
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn ways(set: &str, weight: f64) -> Vec<Ways> {
    let text = read(set);
    all_cores::filter_map(&cases::cases(&text), |case| Ways::of_case(case, weight))
}

/// What `ways` has written of a set.
fn written(set: &str, weight: f64) -> Vec<Ways> {
    let name = set.rsplit('/').next().unwrap_or(set);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("ways/{name}.jsonl"));
    let text = fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("{}: {error}; `cargo run --release --bin ways` writes it", path.display()));
    let lists = text.lines().map(|line| serde_json::from_str::<List>(line).expect("a list of ways"));
    // What speaks for itself is not weighed.
    lists.filter(|list| list.ways.len() > 1).map(|list| list.weighed(weight)).collect()
}

/// A line that `ways` has written.
#[derive(Deserialize)]
struct List {
    ways: Vec<Listed>,
}

#[derive(Deserialize)]
struct Listed {
    is_right: bool,
    evidence: BTreeMap<String, f32>,
}

impl List {
    fn weighed(&self, weight: f64) -> Ways {
        let evidence = |way: &Listed| Evidence {
            values: Evidence::NAMES.map(|name| way.evidence.get(name).copied().unwrap_or_default()),
        };
        let right = (0..self.ways.len()).filter(|at| self.ways[*at].is_right).collect();
        Ways { weight, evidence: self.ways.iter().map(evidence).collect(), fit: Vec::new(), right }
    }
}

fn off_domain() -> Vec<Ways> {
    let text = read(OFF_DOMAIN.0);
    let said: Vec<&str> = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()).collect();
    all_cores::filter_map(&said, |said| Ways::off_domain(said, OFF_DOMAIN.1))
}

fn head([second, held_out]: &[String; 2]) -> String {
    let named = |sets: &[(&str, f64)]| {
        sets.iter().map(|(set, weight)| format!("{set} ({weight})")).collect::<Vec<_>>().join(", ")
    };
    format!(
        "# How much each evidence counts for a way to understand an utterance, in nats per unit of it, and the utility of none of the\n\
         # ways: before the re-ranker has read it (first), and after (fit, second). `src/evidence.rs` says what the evidence is. Written by\n\
         #\n\
         #     cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin alternatives\n\
         #\n\
         # The first are fitted, with a ridge of 1, to these sets of tests/utterances (and how much each counts):\n\
         # {}.\n\
         # The second are fitted to {}:\n\
         # the likeliest way is right for {second} of these, and for {held_out} of {HELD_OUT}.\n\n",
        named(&[FIRST.as_slice(), &[OFF_DOMAIN]].concat()),
        named(&[SECOND.as_slice(), &[OFF_DOMAIN]].concat()),
    )
}

fn section<'a>(name: &str, names: impl Iterator<Item = &'a &'a str>, weights: &[f64]) -> String {
    let mut text = format!("[{name}]\n");
    for (name, weight) in names.zip(weights) {
        let _ = writeln!(text, "{name} = {weight:.4}");
    }
    text + "\n"
}

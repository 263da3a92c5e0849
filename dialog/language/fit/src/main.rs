//! Fits the weights of `dialog/language/data/confidence.toml` to simulated sessions, and says how well they hold.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml
//! ```
//!
//! The same seed gives the same file. Scenes are the built-in floor plans with missions drawn at random; what people
//! mean and say comes from `person.rs`, and from no recorded text. One floor plan is kept for judging alone.

mod calibration;
mod chance;
mod logit;
mod person;
mod scene;

use std::{fmt::Write as _, fs, path::Path, sync::Arc};

use cohabit_cdf::{Catalog, Layout, ObjectId};
use cohabit_language::{Asking, Context, Doubt, Features, Language, Referents};

use crate::{calibration::Calibration, chance::Chance, logit::Choice, person::Habits};

const SEED: u64 = 1;
const SESSIONS: usize = 6000;
const SESSIONS_HELD_OUT: usize = 2000;
const MOST_TURNS: usize = 5;
const HELD_OUT: &str = "OfficeLayout3";
const BINS: usize = 10;
const HABITS: Habits = Habits { vagueness: 0.3, typos: 0.15, mistakes: 0.05, about_mission: 0.75 };

/// What was said of a known target: the candidates' features, what speaks for none of them, and which was meant.
struct Case {
    candidates: Vec<Vec<f64>>,
    doubt: Vec<f64>,
    meant: Option<usize>,
}

fn main() {
    let catalog = Arc::new(Catalog::builtin());
    let language = Language::new(Arc::clone(&catalog)).asking(Asking::Never);
    let plans = Layout::builtin_ids();
    let (held_out, plans): (Vec<String>, Vec<String>) = plans.into_iter().partition(|id| id.starts_with(HELD_OUT));
    let training = cases(&catalog, &language, &plans, SEED, SESSIONS);
    let test = cases(&catalog, &language, &held_out, SEED + 1, SESSIONS_HELD_OUT);
    let candidate = logit::fit(&training.iter().filter_map(Case::which).collect::<Vec<_>>(), Features::COUNT);
    let none = logit::fit(&training.iter().map(Case::whether).collect::<Vec<_>>(), Doubt::COUNT);
    let said: Vec<(f64, bool)> = test.iter().map(|case| case.judged(&candidate, &none)).collect();
    let judged = Calibration::new(&said, BINS);
    for (count, mean, held) in &judged.bins {
        println!("{count:6} said {mean:.3}, held {held:.3}");
    }
    println!("held out: {} expressions, ECE {:.4}, right {:.4}", test.len(), judged.error, judged.accuracy);
    let head = head([training.len(), test.len()], &plans, &held_out, &judged);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/confidence.toml");
    fs::write(&path, head + &tables(&candidate, &none)).expect("the weights can be written");
}

impl Case {
    fn new(referents: &Referents, target: ObjectId) -> Self {
        let wide = |values: &[f32]| values.iter().copied().map(f64::from).collect::<Vec<f64>>();
        Self {
            candidates: referents.candidates.iter().map(|candidate| wide(&candidate.features.values)).collect(),
            doubt: wide(&referents.doubt.values),
            meant: referents.candidates.iter().position(|candidate| candidate.object == target),
        }
    }

    /// Which candidate was meant, if one was.
    fn which(&self) -> Option<Choice> {
        Some(Choice { weight: 1.0, alternatives: self.candidates.clone(), chosen: self.meant? })
    }

    /// Whether none was.
    fn whether(&self) -> Choice {
        Choice {
            weight: 1.0,
            alternatives: vec![self.doubt.clone(), vec![0.0; Doubt::COUNT]],
            chosen: usize::from(self.meant.is_some()),
        }
    }

    /// The probability of the likeliest candidate, and whether it was meant.
    fn judged(&self, candidate: &[f64], none: &[f64]) -> (f64, bool) {
        let shares = logit::probabilities(candidate, &self.candidates);
        let best = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        let some = logit::probabilities(none, &self.whether().alternatives)[1];
        (best.map_or(0.0, |best| shares[best] * some), best.is_some() && best == self.meant)
    }
}

fn cases(catalog: &Catalog, language: &Language, plans: &[String], seed: u64, sessions: usize) -> Vec<Case> {
    let layouts: Vec<Layout> = plans.iter().map(|id| Layout::builtin(id).expect("a built-in plan")).collect();
    let mut chance = Chance::new(seed);
    let mut cases = Vec::new();
    for _ in 0..sessions {
        let layout = chance.pick(&layouts);
        let scene = scene::draw(catalog, layout, &mut chance);
        let mut context = Context::default();
        let mut recent: Vec<ObjectId> = Vec::new();
        for _ in 0..chance.within(1..MOST_TURNS + 1) {
            let (target, text) = person::wish(catalog, &scene, &recent, HABITS, &mut chance);
            cases.extend(language.referents(&text, &scene, &context).map(|referents| Case::new(&referents, target)));
            // The conversation goes on about it, as if it was understood.
            let instance = &scene.object(target).expect("the target is in the scene").instance;
            let _ = language.understand(&format!("go to {instance}"), &scene, &mut context);
            recent.retain(|id| *id != target);
            recent.insert(0, target);
        }
    }
    cases
}

fn head([fitted, judged_on]: [usize; 2], plans: &[String], held_out: &[String], judged: &Calibration) -> String {
    let named = |ids: &[String]| {
        let own: Vec<&str> = ids.iter().map(String::as_str).filter(|id| !id.ends_with("_mirror")).collect();
        own.join(", ")
    };
    let (plans, held_out) = (named(plans), named(held_out));
    let Habits { vagueness, typos, mistakes, about_mission } = HABITS;
    let Calibration { error, accuracy, .. } = judged;
    format!(
        "# How much each feature counts, in nats per unit of it: of a candidate for being the one meant, and for none of\n\
         # them being meant. `src/ground/confidence.rs` says what the features are. Written, with seed {SEED}, by\n\
         #\n\
         #     cargo run --release --manifest-path dialog/language/fit/Cargo.toml\n\
         #\n\
         # Fitted, with a ridge of 1, to {fitted} referring expressions of {SESSIONS} simulated sessions on the plans\n\
         # {plans}, and their mirror images.\n\
         # Of what is said, {vagueness} is vague, {typos} mistyped, {mistakes} mistaken, {about_mission} about the mission's own things.\n\
         #\n\
         # Judged on {judged_on} expressions on another plan, {held_out}, and its mirror image: expected\n\
         # calibration error {error:.4} in {BINS} bins; the likeliest candidate is the one meant in {accuracy:.4}.\n"
    )
}

fn tables(candidate: &[f64], none: &[f64]) -> String {
    let mut text = String::new();
    for (table, names, weights) in [("candidate", &Features::NAMES[..], candidate), ("none", &Doubt::NAMES[..], none)] {
        let _ = writeln!(text, "\n[{table}]");
        for (name, weight) in names.iter().zip(weights) {
            let _ = writeln!(text, "{name} = {weight:.4}");
        }
    }
    text
}

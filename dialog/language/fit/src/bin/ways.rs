//! Writes what the robot could make of labelled utterances, and which of it is right: what `dialog/parser/train/rerank.py` learns from.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin ways
//! ```
//!
//! It writes `ways/SET.jsonl` for each set of `dialog/language/tests/utterances`, or for those that are named, an utterance a line.

#[path = "../all_cores.rs"]
mod all_cores;
#[path = "../sets.rs"]
mod sets;
#[path = "../../../tests/support/mod.rs"]
mod support;

use std::fs;

use cohabit_cdf::{Action, Verb};
use cohabit_language::{Evidence, Understanding};
use serde_json::{Value, json};
use support::cases::{self, Case, Expected};

/// How much the utterances of sets count that were looked at while the grammar was written.
const LOOKED_AT: [&str; 4] = ["seen", "voices", "manners", "spoken"];
const LOOKED_AT_WEIGHT: f64 = 0.3;

fn main() {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let folder = sets::folder("ways");
    fs::create_dir_all(&folder).expect("the folder can be made");
    let sets = sets::read(&["../tests/utterances", "../tests/utterances/writers"], &named);
    for (name, text) in sets.into_iter().filter(|(name, _)| name != "off_domain") {
        let weight = if LOOKED_AT.contains(&&*name) { LOOKED_AT_WEIGHT } else { 1.0 };
        let cases = cases::cases(&text);
        let lines = all_cores::filter_map(&cases, |case| Some(format!("{}\n", ways(case, weight)?)));
        println!("{name}: {} utterances", lines.len());
        fs::write(folder.join(format!("{name}.jsonl")), lines.concat()).expect("the ways can be written");
    }
}

fn ways(case: &Case<'_>, weight: f64) -> Option<Value> {
    let talk = cases::before(case);
    let expected = Expected::new(case, &talk)?;
    let said = case.said.last()?;
    let ways = talk.language.alternatives(said, &talk.scene, &talk.context).into_iter().map(|way| {
        let is_right = expected.is_met(&way.understanding, &talk);
        let evidence: serde_json::Map<String, Value> = Evidence::NAMES
            .iter()
            .zip(way.evidence.values)
            .filter(|(_, value)| *value != 0.0)
            .map(|(name, value)| ((*name).to_owned(), json!(value)))
            .collect();
        json!({
            "words": way.paraphrase,
            "is_right": is_right,
            "probability": way.probability,
            "kind": kind(&way.understanding),
            "lasts": lasts(&way.understanding),
            "evidence": evidence,
            "fit": way.fit.map(|fit| fit.values.to_vec()),
        })
    });
    let ways: Vec<Value> = ways.collect();
    Some(json!({ "before": talk.context.lines(), "said": said, "weight": weight, "ways": ways }))
}

const fn kind(understanding: &Understanding) -> &'static str {
    match understanding {
        Understanding::Plan { .. } => "plan",
        Understanding::Question { .. } => "question",
        Understanding::Answer { .. } => "answer",
        Understanding::Refusal { .. } => "refusal",
        Understanding::Stop { .. } => "stop",
    }
}

/// Whether what is done is not simply undone.
fn lasts(understanding: &Understanding) -> bool {
    let Understanding::Plan { steps, .. } = understanding else { return false };
    steps
        .iter()
        .any(|step| matches!(step.action, Action::Interact { verb, .. } if !matches!(verb, Verb::Open | Verb::Close)))
}

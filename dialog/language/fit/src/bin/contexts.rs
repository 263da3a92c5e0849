//! Writes labelled utterances with the lines of the dialog before them, the robot's as it would speak now: what
//! `dialog/rewriter/train/fit.py` learns from.
//!
//! ```text
//! cargo run --release --manifest-path dialog/language/fit/Cargo.toml --bin contexts
//! ```
//!
//! It writes `contexts/SET.jsonl` for each set of `dialog/language/tests/utterances/writers`, or for those that are named, an utterance a line, and
//! prints the labels that the grammar makes nothing of: what is wrong in them, or missing in it.

#[path = "../all_cores.rs"]
mod all_cores;
#[path = "../sets.rs"]
mod sets;
#[path = "../../../tests/support/mod.rs"]
mod support;

use std::fs;

use serde_json::json;
use support::cases::{self, Case};

fn main() {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let contexts = sets::folder("contexts");
    fs::create_dir_all(&contexts).expect("the folder can be made");
    for (name, text) in sets::read("../tests/utterances/writers", &named) {
        let lines = all_cores::filter_map(&cases::cases(&text), |case| Some(format!("{}\n", context(case)?)));
        println!("{name}: {} utterances", lines.len());
        fs::write(contexts.join(format!("{name}.jsonl")), lines.concat()).expect("the contexts can be written");
    }
}

fn context(case: &Case<'_>) -> Option<serde_json::Value> {
    if !case.is_plain {
        return None;
    }
    let talk = cases::before(case);
    let before = if case.said.len() > 1 { talk.context.lines() } else { &[] };
    // What the grammar makes nothing of is learnt only where there is nothing else.
    let (read, unread): (Vec<&str>, Vec<&str>) =
        case.expected.iter().partition(|label| cases::Wanted::new(label, &talk).is_some());
    if read.is_empty() {
        println!("the grammar reads none of: {}", unread.join(" || "));
    }
    let meant = if read.is_empty() { unread } else { read };
    let around = talk.language.surroundings(&talk.scene);
    Some(json!({ "around": around, "before": before, "said": case.said.last()?, "meant": meant }))
}

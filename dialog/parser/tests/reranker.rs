//! The re-ranker scores as the code that trained it does, and prefers what was said.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use cohabit_parser::{Reranker, Said};
use proptest::prelude::*;
use serde_json::Value;

#[test]
fn it_scores_as_its_training_code_does() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scores.json");
    let rows: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let mut differences: Vec<f64> = Vec::new();
    for row in &rows {
        let before = row["before"].as_array().unwrap();
        let before: Vec<Said<'_>> = before
            .iter()
            .map(|line| Said { by_robot: line[0].as_bool().unwrap(), text: line[1].as_str().unwrap() })
            .collect();
        let candidate = row["candidate"].as_str().unwrap();
        let score = Reranker::builtin().scores(row["said"].as_str().unwrap(), &before, &[candidate])[0];
        differences.push((f64::from(score) - row["score"].as_f64().unwrap()).abs());
    }
    differences.sort_by(f64::total_cmp);
    // Activations are rounded here, and not there.
    assert!(rows.len() >= 100 && differences[rows.len() * 9 / 10] < 0.2, "{differences:?}");
}

#[test]
fn what_was_said_scores_best() {
    let candidates = ["picking up the red mug on the table", "opening the fridge", "= The red mug is on the table."];
    let scores = Reranker::builtin().scores("grab me that red mug", &[], &candidates);
    assert!(scores[0] > scores[1] && scores[0] > scores[2], "{scores:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(50) })]

    #[test]
    fn any_text_has_a_score(said in "\\PC{0,300}", before in "\\PC{0,200}", candidate in "\\PC{0,300}") {
        let before = [Said { by_robot: true, text: &before }];
        let scores = Reranker::builtin().scores(&said, &before, &[&candidate]);
        prop_assert!(scores.len() == 1 && scores[0].is_finite());
    }
}

//! Texts that mean much the same are alike, as much as the code says that trained the model.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use cohabit_parser::{Direction, Directions, Meaning, NUMBERS};
use proptest::prelude::*;
use serde_json::Value;

fn likeness(one: &str, other: &str) -> f32 {
    Meaning::builtin().of(one).likeness(&Meaning::builtin().of(other))
}

#[test]
fn texts_are_as_like_as_the_training_code_says() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/likenesses.json");
    let rows: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    assert!(rows.len() >= 100);
    for row in &rows {
        let wanted = row["likeness"].as_f64().unwrap();
        let found = f64::from(likeness(row["one"].as_str().unwrap(), row["other"].as_str().unwrap()));
        // Activations are rounded here, and not there.
        assert!((found - wanted).abs() < 0.02, "{row}: {found}");
    }
}

#[test]
fn what_means_the_same_is_more_alike() {
    for [said, meant, other] in [
        ["the thing monkeys are mad about", "the banana", "the hammer"],
        ["whatever you drive nails in with", "the hammer", "the banana"],
        ["somebody left the tap running", "turn off the sink", "turn on the sink"],
        ["slam the fridge shut", "close the fridge", "open the fridge"],
    ] {
        assert!(likeness(said, meant) > likeness(said, other), "{said}");
    }
}

#[test]
fn directions_are_found_again() {
    let texts = ["the banana".to_owned(), "the hammer".to_owned()];
    let known = Directions::new(&Directions::file(&texts).unwrap()).unwrap();
    for text in &texts {
        assert_eq!(known.get(text), Some(&Meaning::builtin().of(text)));
    }
    assert_eq!(known.iter().count(), 2);
    assert!(known.get("the bowl").is_none());
    assert!(Directions::new(b"no file").is_err());
    assert!(Direction::from_numbers(&[1; NUMBERS - 1]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(50) })]

    #[test]
    fn any_text_has_a_direction(text in "\\PC{0,400}") {
        let direction = Meaning::builtin().of(&text);
        prop_assert_eq!(direction.numbers().len(), NUMBERS);
        prop_assert!((direction.likeness(&direction) - 1.0).abs() < 1e-3);
    }
}

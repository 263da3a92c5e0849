//! The parser writes what the code that trained it writes, and forgives what people do to words.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use cohabit_parser::{
    Parser, Reading, Said,
    request::{Act, Request},
};
use proptest::prelude::*;
use serde_json::Value;

fn text(reading: &Reading) -> String {
    reading.requests.iter().map(Request::to_string).collect::<Vec<_>>().join("; ")
}

/// Without what the two write differently: case, marks, spaces.
fn plain(text: &str) -> String {
    text.to_lowercase().replace('’', "'").chars().filter(|c| c.is_alphanumeric()).collect()
}

#[test]
fn it_writes_what_its_training_code_writes() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference.json");
    let rows: Vec<Value> = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let mut others = Vec::new();
    for row in &rows {
        let before = row["before"].as_array().unwrap();
        let before: Vec<Said<'_>> = before
            .iter()
            .map(|line| Said { by_robot: line["by_robot"].as_bool().unwrap(), text: line["text"].as_str().unwrap() })
            .collect();
        let readings = Parser::builtin().parse(row["utterance"].as_str().unwrap(), &before);
        let wanted = row["requests"].as_str().unwrap();
        let log = row["log_probability"].as_f64().unwrap();
        let found = readings.first().map(text).unwrap_or_default();
        // A beam finds what is likelier than what is found letter by letter.
        let is_better = readings.first().is_some_and(|reading| f64::from(reading.probability.ln()) >= log - 0.2);
        if plain(&found) != plain(wanted) && !is_better {
            others.push(format!("{}\n    wanted {wanted}\n    found  {found}", row["utterance"]));
        }
    }
    // Activations are rounded here, and not there.
    assert!(rows.len() >= 100 && others.len() * 33 <= rows.len(), "{}", others.join("\n"));
}

#[test]
fn plain_requests_are_read_as_they_are() {
    for said in [
        "pick up the red mug",
        "put the bowl in the microwave",
        "go to the break room",
        "open the fridge",
        "turn on the sink",
        "where is the hammer?",
        "pour the milk into the bowl",
        "turn around",
    ] {
        let readings = Parser::builtin().parse(said, &[]);
        assert_eq!(text(&readings[0]), said);
        assert!(readings[0].probability > 0.5, "{said}: {}", readings[0].probability);
    }
}

#[test]
fn an_answer_is_one_after_a_question() {
    let before = [Said { by_robot: true, text: "Which mug do you mean: the red one or the blue one?" }];
    let readings = Parser::builtin().parse("the red one", &before);
    assert!(matches!(&readings[0].requests[0].act, Act::Answer(_)), "{readings:?}");
}

#[test]
fn what_has_no_words_or_too_many_is_not_read() {
    let parser = Parser::builtin();
    assert_eq!(parser.parse("", &[]), []);
    assert_eq!(parser.parse(" \n\t", &[]), []);
    assert_eq!(parser.parse(&"go ".repeat(500), &[]), []);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn any_text_has_an_outcome(said in "\\PC{0,120}", before in "\\PC{0,200}", by_robot: bool) {
        let readings = Parser::builtin().parse(&said, &[Said { by_robot, text: &before }]);
        for reading in &readings {
            prop_assert!(!reading.requests.is_empty() && (0.0..=1.0).contains(&reading.probability));
        }
        prop_assert_eq!(&readings, &Parser::builtin().parse(&said, &[Said { by_robot, text: &before }]));
    }
}

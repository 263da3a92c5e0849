//! Questionnaires that ship are scored as their papers say: each against an example that was worked out by hand.

use super::*;
use crate::scratch::Scratch;

fn values(all: &[i32]) -> Vec<Option<Given>> {
    all.iter().map(|value| Some(Given::Value(*value))).collect()
}

/// The scores of answers, by name.
fn scores(name: &str, given: &[Option<Given>]) -> BTreeMap<String, f64> {
    let (asked, instrument) = Instrument::find(name).unwrap();
    assert!(asked.answered(1, given).is_ok(), "these are answers to {name}");
    let of = |score: &Score| Some((score.name.clone(), instrument.score(score, &asked, given)?));
    instrument.scores.iter().filter_map(of).collect()
}

fn check(name: &str, given: &[Option<Given>], expected: &[(&str, f64)]) {
    let found = scores(name, given);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (score, value) in expected {
        assert!((found[*score] - value).abs() < 1e-9, "{score} is {}, not {value}", found[*score]);
    }
}

#[test]
fn scores_are_those_worked_out_by_hand() {
    // Odd items less 1: 3 + 4 + 2 + 3 + 4 = 16; 5 less even items: 3 + 4 + 3 + 2 + 4 = 16; (16 + 16) × 2.5.
    check("sus", &values(&[4, 2, 5, 1, 3, 2, 4, 3, 5, 1]), &[("sus", 80.0)]);
    // (70 + 10 + 50 + 20 + 65 + 25) / 6.
    check("tlx", &values(&[70, 10, 50, 20, 65, 25]), &[("tlx_raw", 40.0)]);
    // Weights 5, 0, 3, 2, 4, 1: (5·70 + 3·50 + 2·20 + 4·65 + 1·25) / 15 = 825 / 15.
    let pairs = [1, 1, 1, 1, 1, 2, 2, 2, 2, 1, 2, 1, 2, 1, 1];
    let weighted = [&[70, 10, 50, 20, 65, 25][..], &pairs].concat();
    check("tlx_weighted", &values(&weighted), &[("tlx_raw", 40.0), ("tlx_weighted", 55.0)]);
    // Warmth first, then competence, then discomfort, in turn: 6 of 5; 6, 7, 8, 9, 6, 6: 42 / 6; 1, 2, 1, 2, 1, 2: 9 / 6.
    let rosas = [5, 6, 1, 5, 7, 2, 5, 8, 1, 5, 9, 2, 5, 6, 1, 5, 6, 2];
    let expected = [("rosas_warmth", 5.0), ("rosas_competence", 7.0), ("rosas_discomfort", 1.5)];
    check("rosas", &values(&rosas), &expected);
    // Distrust turned round: 6 + 7 + 5 + 4 + 7 = 29; trust: 6 + 5 + 5 + 6 + 6 + 7 + 2 = 37; 66 / 12.
    check("trust", &values(&[2, 1, 3, 4, 1, 6, 5, 5, 6, 6, 7, 2]), &[("trust", 5.5)]);
    // (3 + 2 + 1 + 2) / 4; (-1 + 0 + 1 - 2) / 4; both: 6 / 8.
    let expected = [("ueq_s_pragmatic", 2.0), ("ueq_s_hedonic", -0.5), ("ueq_s_overall", 0.75)];
    check("ueq_s", &values(&[3, 2, 1, 2, -1, 0, 1, -2]), &expected);
    // Without what does not apply: 14 answers, 28 in all; 12 / 6; 9 / 4; 5 / 3; and the last one 2.
    let mut pssuq = values(&[1, 2, 3, 1, 2, 3, 1, 2, 3, 3, 0, 0, 2, 1, 2, 2]);
    (pssuq[10], pssuq[11]) = (None, None);
    let expected = [
        ("pssuq_overall", 2.0),
        ("pssuq_system", 2.0),
        ("pssuq_information", 9.0 / 4.0),
        ("pssuq_interface", 5.0 / 3.0),
    ];
    check("pssuq", &pssuq, &expected);
    let none: Vec<Option<Given>> = vec![None; 16];
    assert!(scores("pssuq", &none).is_empty());
}

#[test]
fn all_that_ship_say_where_they_are_from() {
    for name in ["sus", "tlx", "tlx_weighted", "rosas", "trust", "ueq_s", "pssuq"] {
        let (asked, Instrument { citation, licence, scores, .. }) = Instrument::find(name).unwrap();
        assert!(citation.is_some() && !scores.is_empty(), "{name}");
        // Who has the program may sell it, and what is in it with it.
        assert!(licence.is_some_and(|licence| !licence.to_lowercase().contains("noncommercial")), "{name}");
        let scored: Vec<usize> =
            scores.iter().flat_map(|score| score.items.iter().chain(&score.pairs)).copied().collect();
        assert!((1..=asked.items.len()).all(|number| scored.contains(&number)), "{name}: an item counts for nothing");
    }
}

const FILE: &str = "title = \"T\"\nscale = { least = 1, most = 5 }\n[[item]]\nask = \"How?\"\n[[item]]\nask = \"Mark 4.\"\nattention = 4\n\
                    [[item]]\nask = \"Which?\"\nchoice = [\"a\", \"b\"]\n";

#[test]
fn attention_is_checked() {
    let scratch = Scratch::new("attention");
    let path = scratch.write("own.toml", FILE);
    let (_, instrument) = Instrument::find(&path.to_string_lossy()).unwrap();
    let of = |item, value: i32| instrument.is_attentive(item, Some(&Given::Value(value)));
    assert_eq!((of(0, 4), of(1, 4), of(1, 3)), (None, Some(true), Some(false)));
    assert_eq!(instrument.is_attentive(1, None), Some(false));
}

#[test]
fn what_is_wrong_with_a_score_is_said() {
    let scratch = Scratch::new("scores");
    let score = |keys: &str| format!("{FILE}[[score]]\nname = \"s\"\nmeaning = \"m\"\n{keys}\n");
    for (text, part) in [
        (score("of = \"median\"\nitems = [1]"), "unknown variant `median`"),
        (score("of = \"mean\"\nitems = []"), "the score `s`: it is of no items"),
        (score("of = \"mean\"\nitems = [3]"), "item 3 is no scale: there are 3 items"),
        (score("of = \"mean\"\nitems = [0]"), "item 0 is no scale"),
        (score("of = \"mean\"\nitems = [1]\npairs = [3]"), "`pairs` are for scores that are `weighted`"),
        (score("of = \"weighted\"\nitems = [1]"), "it has no `pairs`"),
        (score("of = \"weighted\"\nitems = [1]\npairs = [3]"), "item 3 is no choice between two labels"),
        (FILE.replace("attention = 4", "attention = 6"), "item 2: `attention = 6` is none of its answers"),
    ] {
        let path = scratch.write("own.toml", &text);
        let said = Instrument::find(&path.to_string_lossy()).unwrap_err().to_string();
        assert!(said.contains(part) && said.contains("own.toml"), "no `{part}` in {said}");
    }
}

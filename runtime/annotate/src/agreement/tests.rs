#![allow(clippy::unwrap_used)]

use super::*;
use crate::task::{Reading, Reason, Task, What};

fn is_near(value: Option<f64>, expected: Option<f64>) -> bool {
    match (value, expected) {
        (Some(value), Some(expected)) => (value - expected).abs() < 1e-12,
        (value, expected) => value == expected,
    }
}

#[test]
fn words_are_compared_in_pairs() {
    for (texts, expected) in [
        (vec![], None),
        (vec!["get the bowl"], None),
        (vec!["Get the bowl.", "get the BOWL"], Some(1.0)),
        (vec!["get the bowl", "open it"], Some(0.0)),
        // Two shared of three and four words: 4/7.
        (vec!["get the bowl", "take the red bowl"], Some(4.0 / 7.0)),
        // A word counts as often as both have it: one of three and one.
        (vec!["go go go", "go"], Some(0.5)),
        // Pairs: 1, 2/3 and 2/3.
        (vec!["the bowl", "the bowl", "bowl"], Some(7.0 / 9.0)),
        (vec!["?", "!"], Some(1.0)),
    ] {
        let f1 = mean_pairwise_f1(&texts);
        assert!(is_near(f1, expected), "{texts:?}: {f1:?} instead of {expected:?}");
    }
}

#[test]
fn alpha_is_as_worked_out_by_hand() {
    for (units, expected) in [
        (vec![], None),
        // All alike: nothing could differ.
        (vec![[3, 0], [2, 0]], None),
        // Each unit alike, and units differ: no disagreement at all.
        (vec![[3, 0], [0, 3]], Some(1.0)),
        // One unit of each pair differs: n = 4, n0 = 3, n1 = 1, o01 = 1: 1 - 3 * 1 / 3.
        (vec![[2, 0], [1, 1]], Some(0.0)),
        // Units with one judgement do not count: n = 5, n0 = 4, n1 = 1, o01 = 2 * 1 / 2: 1 - 4 * 1 / 4.
        (vec![[2, 1], [2, 0], [0, 1], [1, 0]], Some(0.0)),
        // n = 6, n0 = 4, n1 = 2, o01 = 2 * (2 * 1 / 2): 1 - 5 * 2 / 8.
        (vec![[2, 1], [2, 1]], Some(1.0 - 5.0 * 2.0 / 8.0)),
        // Krippendorff (2011), section A: ten units of two judgements, n = 20, n0 = 14, n1 = 6, o01 = 4: 1 - 19 * 4 / 84 = 0.095.
        (
            vec![[2, 0], [1, 1], [1, 1], [2, 0], [1, 1], [1, 1], [2, 0], [2, 0], [2, 0], [0, 2]],
            Some(1.0 - 19.0 * 4.0 / 84.0),
        ),
    ] {
        let value = alpha(&units);
        assert!(is_near(value, expected), "{units:?}: {value:?} instead of {expected:?}");
    }
}

fn annotation(id: u64, task: Task, what: What) -> Annotation {
    Annotation { id, annotator: format!("A{id:02}"), task, what, taken_ms: 0, at_ms: 0, corrects: None }
}

#[test]
fn the_table_has_a_row_for_each_unit_and_each_kind() {
    let segment = Segment { episode: "episodes/000000".to_owned(), first_step: 0, end_step: 3 };
    let instruction = || Task::Instruction { segment: segment.clone() };
    let read = |id| Reading { id, text: "x".to_owned() };
    let answer = || Task::Answer { segment: segment.clone(), instruction: read(0), question: read(7) };
    let text = |text: &str| What::Text(text.to_owned());
    let annotations = [
        annotation(0, instruction(), text("get the bowl")),
        annotation(1, instruction(), text("take the red bowl")),
        annotation(2, instruction(), What::Skipped(Reason::CannotTell)),
        annotation(3, answer(), text("left")),
    ];
    let units = by_unit(&annotations);
    let kinds = by_kind(&units);
    // Two texts and a skip: n = 3, o01 = 2 * 1 / 2 = 1: 1 - 2 * 1 / 2.
    let expected = "\
scope,kind,episode,first_step,end_step,question,texts,skipped,token_f1,skip_alpha
unit,instruction,episodes/000000,0,3,,2,1,0.5714,
unit,answer,episodes/000000,0,3,7,1,0,,
all,instruction,,,,,2,1,0.5714,0.0000
all,question,,,,,0,0,,
all,answer,,,,,1,0,,
";
    assert_eq!(csv(&units, &kinds), expected);
    assert!(lines(&kinds).starts_with("instructions: 2 texts, 1 skipped; token F1 0.57, alpha of skipping 0.00\n"));
}

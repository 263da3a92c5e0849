//! What the rewriter writes is what the program that fitted it writes.
#![allow(clippy::unwrap_used, missing_docs)]

use cohabit_rewriter::{Line, Rewriter};
use serde_json::Value;

/// How far the logarithm of a probability may be from that of the other program, whose sums are less exact.
const TOLERANCE: f64 = 0.35;
/// Below this logarithm of a probability the other program doubts itself: what is all but as likely may come first here.
const DOUBTFUL: f64 = -1.2;

#[test]
fn rewritings_are_those_of_the_program_that_fitted_it() {
    let rows: Vec<Value> = serde_json::from_str(include_str!("rewritings.json")).unwrap();
    assert!(rows.len() >= 40);
    let is_sure = |row: &&Value| row["log_probability"].as_f64().unwrap() > DOUBTFUL;
    let sure = rows.iter().filter(is_sure).count();
    assert!(sure >= 25, "{sure}");
    let (mut alike, mut sure_alike) = (0, 0);
    for row in &rows {
        let before = row["before"].as_array().unwrap().iter();
        let before: Vec<Line> =
            before.map(|line| (line[0].as_bool().unwrap(), line[1].as_str().unwrap().to_owned())).collect();
        let rewritings = cohabit_rewriter::builtin().rewrite(
            row["said"].as_str().unwrap(),
            &before,
            row["around"].as_str().unwrap(),
        );
        let wanted = row["text"].as_str().unwrap();
        let same = rewritings.iter().find(|rewriting| rewriting.text == wanted);
        let is_close = |probability: f32| {
            (f64::from(probability).ln() - row["log_probability"].as_f64().unwrap()).abs() < TOLERANCE
        };
        if same.is_some_and(|same| is_close(same.probability)) {
            alike += 1;
            sure_alike += usize::from(is_sure(&row));
        } else {
            println!("{}: {wanted} {}, not {rewritings:?}", row["said"], row["log_probability"]);
        }
    }
    assert!(sure_alike * 20 >= sure * 19, "{sure_alike} of {sure}");
    assert!(alike * 20 >= rows.len() * 17, "{alike} of {}", rows.len());
}

#[test]
fn any_text_is_taken() {
    let long = "please ".repeat(400);
    for said in ["", " \n", "?", "\u{0}\u{1F600}", "é", &long] {
        let before = [(true, long.clone()), (false, said.to_owned())];
        let rewritings = cohabit_rewriter::builtin().rewrite(said, &before, said);
        assert!(rewritings.iter().all(|one| (0.0..=1.0).contains(&one.probability)), "{rewritings:?}");
    }
}

/// What was read before is not read again, and changes nothing.
#[test]
fn the_same_words_give_the_same_bits() {
    let said = "stick the kettle on, would you, and fetch me a mug";
    let rewriter = || Rewriter::new(include_bytes!("../rewriter.safetensors")).unwrap();
    let around = "break room with sink, 6 stool; counter top: mug, banana";
    let alone = rewriter().rewrite(said, &[], around);
    let warm = rewriter();
    for (other, around) in [("wash the mug", around), (said, ""), ("is there a mug?", "break room with sink, couch")] {
        let _ = warm.rewrite(other, &[], around);
        assert_eq!(warm.rewrite(said, &[], around), rewriter().rewrite(said, &[], around));
    }
    assert_eq!(warm.rewrite(said, &[], around), alone);
    assert_eq!(warm.rewrite(said, &[], around), alone);
}

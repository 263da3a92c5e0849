//! What many people say, and what it should mean, written by hand. Some sets are looked at while the language is worked on; of `held_out.txt`,
//! `strangers.txt` and the writers named here only the figures are looked at, so that they say what other people's words are worth.
//!
//! `cargo test -p cohabit-language --test language utterances -- --nocapture` prints the figures of every third case, and what is wrong
//! in what may be looked at.
//! `UTTERANCES=my.txt cargo test -p cohabit-language --test language other_sets -- --ignored --nocapture` measures a set of one's own;
//! `ONLY_FIGURES=1` before it keeps its cases unseen.

use std::collections::BTreeMap;

use crate::support::{
    Talk,
    cases::{Case, Expected, before, cases, found},
    text,
};
use cohabit_language::{Clarification, Understanding};

/// What comes of the last utterance of a case, after all earlier ones were done.
struct Outcome {
    understanding: Understanding,
    text: String,
    is_right: bool,
    /// Whether an answer that it offers to a question of its own leads to what is right.
    is_proposed: bool,
    /// How likely the robot took it to be what was meant.
    sureness: f32,
}

/// Nothing, where it is not known what should come of it.
fn outcome(case: &Case<'_>) -> Option<Outcome> {
    let mut talk = before(case);
    let expected = Expected::new(case, &talk)?;
    let understanding = talk.language.understand(case.said.last().unwrap(), &talk.scene, &mut talk.context);
    let (sureness, is_right) = (talk.context.sureness(), expected.is_met(&understanding, &talk));
    let leads_there = |option: &String| {
        let then = talk.language.understand(option, &talk.scene, &mut talk.context.clone());
        expected.is_met(&then, &talk)
    };
    let is_proposed = match &understanding {
        Understanding::Question { kind: Clarification::Confirmation, candidates, options, .. } if !is_right => {
            options.iter().any(|option| (candidates.is_empty() && option != "no") && leads_there(option))
        }
        _ => false,
    };
    Some(Outcome { text: found(&understanding, &talk.scene), understanding, is_right, is_proposed, sureness })
}

/// What came of a set, by kind.
#[derive(Default)]
struct Counts {
    /// As expected.
    right: usize,
    /// The robot asked whether to do what was expected.
    proposed: usize,
    /// It did something else.
    wrong: usize,
    all: usize,
}

/// How many cases of a set are understood, printed by kind; what is not understood is printed where it may be looked at.
fn understood(name: &str, set: &str, every: usize, is_open: bool) -> (usize, usize) {
    let mut kinds: BTreeMap<&str, Counts> = BTreeMap::new();
    let mut unlabelled = 0;
    // Of plans: how many were right, and how many there were, by tenths of sureness.
    let mut calibration: BTreeMap<u8, (usize, usize)> = BTreeMap::new();
    for case in cases(set).into_iter().step_by(every) {
        let Some(Outcome { understanding, text, is_right, is_proposed, sureness }) = outcome(&case) else {
            unlabelled += 1;
            if is_open {
                println!(
                    "{}\n    is labelled by what the grammar does not read: {}",
                    case.said.join(" / "),
                    case.expected.join(" || ")
                );
            }
            continue;
        };
        if matches!(understanding, Understanding::Plan { .. }) {
            let (right, all) = calibration.entry((sureness * 10.0) as u8).or_default();
            (*right, *all) = (*right + usize::from(is_right), *all + 1);
        }
        let count = kinds.entry(case.kind).or_default();
        count.right += usize::from(is_right);
        count.proposed += usize::from(is_proposed);
        count.wrong += usize::from(!is_right && matches!(understanding, Understanding::Plan { .. }));
        count.all += 1;
        if !is_right && is_open {
            println!(
                "{} {:?}{}\n    wanted {}\n    found  {text}",
                case.said.join(" / "),
                case.marks,
                if is_proposed { " PROPOSED" } else { "" },
                case.expected.join(" || ")
            );
        }
    }
    for (kind, Counts { right, proposed, wrong, all }) in &kinds {
        println!("{right:4} of {all:3}, {proposed:3} proposed, {wrong:3} something else done  {kind}");
    }
    for (tenth, (right, all)) in &calibration {
        println!(
            "{right:4} of {all:3} plans right where it was sure by {:.1} to {:.1}",
            tenth_of(*tenth),
            tenth_of(tenth + 1)
        );
    }
    let sum = |count: fn(&Counts) -> usize| kinds.values().map(count).sum::<usize>();
    let (right, proposed) = (sum(|counts| counts.right), sum(|counts| counts.proposed));
    let (all, wrong) = (sum(|counts| counts.all), sum(|counts| counts.wrong));
    println!(
        "{name}: {right} of {all} understood, {proposed} proposed, {wrong} something else done ({unlabelled} left out)"
    );
    (right, right + proposed)
}

fn tenth_of(tenth: u8) -> f32 {
    f32::from(tenth) / 10.0
}

/// An utterance takes half a second here: of a set each so many-th is tried.
const EVERY: usize = 3;

/// Finds that as many cases of a set are understood, and understood or proposed, as were when this was written, but for a few; raise the
/// numbers when more are.
#[track_caller]
fn check(name: &str, set: &str, is_open: bool, fewest: [usize; 2]) {
    let (right, met) = understood(name, set, EVERY, is_open);
    assert!(right >= fewest[0], "{name}: {right} cases are understood, {} were", fewest[0]);
    assert!(met >= fewest[1], "{name}: {met} cases are understood or proposed, {} were", fewest[1]);
}

/// A set of one's own, in the file that `UTTERANCES` names.
#[test]
#[ignore = "measures the set of utterances that UTTERANCES names"]
fn other_sets_are_measured_too() {
    let path = std::env::var_os("UTTERANCES").map(std::path::PathBuf::from).expect("UTTERANCES names a file");
    let set = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(understood("own", &set, 1, std::env::var_os("ONLY_FIGURES").is_none()).1 > 0);
}

#[test]
fn most_of_what_was_looked_at_is_understood() {
    check("seen", include_str!("utterances/seen.txt"), true, [100, 102]);
    check("manners", include_str!("utterances/manners.txt"), true, [47, 48]);
    check("spoken", include_str!("utterances/spoken.txt"), true, [18, 18]);
}

#[test]
fn most_of_what_was_said_at_first_contact_is_understood() {
    check("first contact", include_str!("utterances/first_contact.txt"), true, [50, 57]);
    check("first contact again", include_str!("utterances/first_contact_again.txt"), true, [53, 55]);
    check("newcomers", include_str!("utterances/newcomers.txt"), true, [78, 81]);
}

#[test]
fn nothing_is_done_about_what_is_no_request() {
    let set = include_str!("utterances/off_domain.txt");
    for said in set.lines().filter(|line| !line.starts_with('#') && !line.is_empty()) {
        let mut talk = Talk::new(&[]);
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        let is_done = matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. });
        assert!(!is_done, "{said}: {}", text(&understanding, &talk.scene));
    }
}

#[test]
fn most_of_what_people_say_is_understood() {
    check("held out", include_str!("utterances/held_out.txt"), false, [98, 98]);
}

#[test]
fn most_of_what_writers_say_is_understood() {
    check("writer w", include_str!("utterances/writers/w.txt"), false, [74, 78]);
    check("writer ck", include_str!("utterances/writers/ck.txt"), false, [48, 50]);
}

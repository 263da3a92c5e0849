//! What many people say, and what it should mean, written by hand. `seen.txt`, `voices.txt`, `manners.txt`, `spoken.txt` and `first_contact.txt` are looked at
//! while the language is worked on; of `held_out.txt` the figures alone are, so that they say what other people's words are worth.
//!
//! `cargo test -p cohabit-language --test utterances -- --nocapture` prints the figures, and what is wrong
//! in what may be looked at.
//! `UTTERANCES=my.txt cargo test -p cohabit-language --test utterances -- --ignored --nocapture` measures a set of one's own;
//! `ONLY_FIGURES=1` before it keeps its cases unseen.

#![allow(clippy::unwrap_used)]

mod support;

use std::collections::BTreeMap;

use cohabit_cdf::Status;
use cohabit_language::Understanding;
use support::{Talk, text};

/// One line of a set.
struct Case<'a> {
    kind: &'a str,
    marks: Vec<&'a str>,
    said: Vec<&'a str>,
    expected: Vec<&'a str>,
}

fn cases(set: &str) -> Vec<Case<'_>> {
    let (mut kind, mut marks, mut cases) = ("", Vec::new(), Vec::new());
    for line in set.lines().map(str::trim) {
        if let Some(named) = line.strip_prefix("# kind:") {
            kind = named.trim();
        } else if let Some(list) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let list = list.strip_prefix("marks:").unwrap_or(list);
            marks = list.split(';').map(str::trim).filter(|mark| !mark.is_empty()).collect();
        } else if let Some((said, expected)) = line.split_once(" -> ").filter(|_| !line.starts_with('#')) {
            let (said, expected) = (said.split(" / ").collect(), expected.split(" || ").map(str::trim).collect());
            cases.push(Case { kind, marks: marks.clone(), said, expected });
        }
    }
    cases
}

/// What comes of a case: of its last utterance, after all earlier ones were done.
fn outcome(case: &Case<'_>) -> (Understanding, String) {
    let mut talk = Talk::new(&case.marks);
    let mut last = None;
    for said in &case.said {
        if let Some(Understanding::Plan { steps, .. }) = &last {
            for step in steps {
                talk.context.note_outcome(step, Status::ActionSuccessful);
            }
        }
        last = Some(talk.language.understand(said, &talk.scene, &mut talk.context));
    }
    let understanding = last.unwrap();
    let text = text(&understanding, &talk.scene);
    if let Understanding::Question { candidates, .. } = &understanding {
        let names = candidates.iter().filter_map(|id| talk.scene.object(*id)).map(|object| object.instance.as_str());
        let mut names: Vec<&str> = names.collect();
        names.sort_unstable();
        return (understanding.clone(), format!("{text} {names:?}"));
    }
    (understanding, text)
}

fn is_as(expected: &str, understanding: &Understanding, found: &str) -> bool {
    let words =
        |text: &str| text.to_lowercase().split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect::<Vec<_>>();
    let has_all = |list: &str| {
        let found = words(found).join(" ");
        list.split(';').all(|part| {
            format!(" {found} ").contains(&format!(" {} ", words(part).join(" ").trim())) || part.trim().is_empty()
        })
    };
    match (expected.chars().next(), understanding) {
        (Some('?'), Understanding::Question { .. }) => {
            let mut wanted: Vec<&str> = expected[1..].split_whitespace().collect();
            wanted.sort_unstable();
            wanted.is_empty() || found.ends_with(&format!("{wanted:?}"))
        }
        (Some('='), Understanding::Answer { .. }) => has_all(&expected[1..]),
        (Some('!'), Understanding::Refusal { .. }) => has_all(&expected[1..]),
        (Some('?' | '=' | '!'), _) => false,
        _ => match expected.strip_suffix('…') {
            Some(start) => found.starts_with(start.trim_end()),
            None => found == expected,
        },
    }
}

/// How many cases of a set are understood, printed by kind; what is wrong is printed where it may be looked at.
fn understood(name: &str, set: &str, is_open: bool) -> usize {
    let cases = cases(set);
    let mut kinds: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for case in &cases {
        let (understanding, found) = outcome(case);
        let is_right = case.expected.iter().any(|expected| is_as(expected, &understanding, &found));
        let count = kinds.entry(case.kind).or_default();
        count[0] += usize::from(is_right);
        count[1] += 1;
        if !is_right && is_open {
            println!(
                "{} {:?}\n    wanted {}\n    found  {found}",
                case.said.join(" / "),
                case.marks,
                case.expected.join(" || ")
            );
        }
    }
    for (kind, [right, all]) in &kinds {
        println!("{right:4} of {all:3}  {kind}");
    }
    let right: usize = kinds.values().map(|[right, _]| right).sum();
    println!("{name}: {right} of {} understood", cases.len());
    right
}

/// Finds that as many cases of a set are understood as were when this was written, but for a few; raise the number when more are.
#[track_caller]
fn check(name: &str, set: &str, is_open: bool, fewest: usize) {
    let right = understood(name, set, is_open);
    assert!(right >= fewest, "{name}: {right} cases are understood, {fewest} were");
}

/// A set of one's own, in the file that `UTTERANCES` names.
#[test]
#[ignore = "measures the set of utterances that UTTERANCES names"]
fn other_sets_are_measured_too() {
    let path = std::env::var_os("UTTERANCES").map(std::path::PathBuf::from).expect("UTTERANCES names a file");
    let set = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(understood("own", &set, std::env::var_os("ONLY_FIGURES").is_none()) > 0);
}

#[test]
fn most_of_what_was_looked_at_is_understood() {
    check("seen", include_str!("utterances/seen.txt"), true, 321);
    check("voices", include_str!("utterances/voices.txt"), true, 731);
    check("manners", include_str!("utterances/manners.txt"), true, 135);
    check("spoken", include_str!("utterances/spoken.txt"), true, 62);
    check("first contact", include_str!("utterances/first_contact.txt"), true, 80);
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
    check("held out", include_str!("utterances/held_out.txt"), false, 269);
}

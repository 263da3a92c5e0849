//! Recorded sessions step by step.

use std::fs;

use cohabit_tests::{Scratch, run};
use serde_json::Value;

use crate::COHABIT;

const MISSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions");

/// Plays a mission; gives its log.
fn log(scratch: &Scratch) -> String {
    let logs = scratch.path("logs");
    let played = ["eval", MISSIONS, "--only", "cold_soda", "--workers", "1", "--understanding", "fast"];
    let done = run(COHABIT, &[&played[..], &["--record", &logs]].concat()).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    format!("{logs}/cold_soda.mcap")
}

fn printed(arguments: &[&str]) -> String {
    let all = [&["steps"], arguments, &["--understanding", "fast"]].concat();
    let done = run(COHABIT, &all).unwrap();
    assert!(done.status.success(), "{all:?}: {}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(done.stdout).unwrap()
}

#[test]
fn a_session_is_told_step_by_step_with_pictures() {
    let scratch = Scratch::new("steps");
    let log = log(&scratch);
    let seen = scratch.path("seen");
    let text = printed(&[&log, "--json", "--frames", &seen, "--size", "40x30", "--renderer", "cpu"]);
    let steps: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(steps[0]["said"]["text"], "pick up the soda can");
    assert_eq!(steps[0]["said"]["understood"]["as_recorded"], true, "{:#}", steps[0]);
    assert!(steps.iter().any(|step| step["goals_met"].as_array().is_some_and(|goals| !goals.is_empty())));
    let masked: Vec<&Value> = steps.iter().filter(|step| step["frames"]["mask"].is_string()).collect();
    assert!(masked.iter().any(|step| step["did"]["target"]["mask"]["pixels"].as_u64() > Some(0)), "{masked:#?}");
    for path in masked.iter().flat_map(|step| step["frames"].as_object().unwrap().values()) {
        assert!(fs::read(path.as_str().unwrap()).unwrap().starts_with(b"\x89PNG"), "{path}");
    }
    let one = printed(&[&log, "--step", "1"]);
    assert!(one.contains("\"pick up the soda can\"") && one.contains("understood: "), "{one}");
    assert!(!one.contains("   2  "), "{one}");
}

#[test]
fn a_step_may_be_another_and_its_log_replays() {
    let scratch = Scratch::new("steps-other");
    let log = log(&scratch);
    let log = log.as_str();
    let out = scratch.path("other.mcap");
    let change = ["--step", "1", "--instead", "look around", "--log", &out];
    let text = printed(&[&[log], &change[..]].concat());
    assert!(text.contains("-    1  to body 0: \"pick up the soda can\""), "{text}");
    assert!(text.contains("+    1  to body 0: \"look around\"") && text.contains("goals met before"), "{text}");
    let replayed = run(COHABIT, &["replay", &out]).unwrap();
    assert!(String::from_utf8_lossy(&replayed.stdout).contains("no tick differs"), "{replayed:?}");
    for (arguments, part) in [
        (&[log, "--step", "1", "--instead", "stop", "--log", &out][..], "exists already"),
        (&[log, "--step", "1", "--instead", "stop"], "--log"),
        (&[log, "--step", "999"], "steps"),
        (&["no.mcap"], "no.mcap"),
    ] {
        let output = run(COHABIT, &[&["steps"], arguments].concat()).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && text.contains(part), "{arguments:?}: {text}");
    }
}

//! A small benchmark, played by the agents of the program.

use std::fs;

use cohabit_tests::{Scratch, run};
use serde_json::Value;

use crate::COHABIT;

const SMALL: &str = r#"
version = 7
seed = 3
count = 10
share = 0.2
caps = { actions = 50, failed = 10 }
[[missions.type]]
name = "pickup"
vars = [{ name = "it", affords = ["PICKUPABLE"] }]
goals = ["it isPickedUp=true"]
[[missions.type]]
name = "toggleDevice"
vars = [{ name = "device", kind = "device", affords = ["TOGGLEABLE"], without = ["PICKUPABLE"] }]
goals = ["device isToggledOn=true"]
"#;

/// What the program prints, and its exit code.
fn benchmark(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, &[&["benchmark"], arguments].concat()).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

fn done(arguments: &[&str]) -> String {
    let (text, code) = benchmark(arguments);
    assert_eq!(code, Some(0), "{text}");
    text
}

#[test]
fn agents_play_and_their_submissions_hold() {
    let scratch = Scratch::new("benchmark");
    let small = scratch.write("small.toml", SMALL);
    let folder = scratch.path("submissions");
    fs::create_dir(&folder).unwrap();
    for agent in ["expert", "dialog", "random"] {
        let out = format!("{folder}/{agent}.jsonl");
        done(&["run", "--benchmark", &small, "--agent", agent, "--understanding", "fast", "--out", &out]);
        let text = done(&["verify", &out, "--benchmark", &small]);
        assert!(text.contains("nothing differs"), "{text}");
    }
    let expert = fs::read_to_string(format!("{folder}/expert.jsonl")).unwrap();
    let header: Value = serde_json::from_str(expert.lines().next().unwrap()).unwrap();
    assert_eq!(header["totals"]["validation"]["all"]["msr"], 1.0, "{header:#}");
    let (html, forged) = (scratch.path("table.html"), format!("{folder}/forged.jsonl"));
    fs::write(&forged, expert.replacen("\"success\":true", "\"success\":false", 1)).unwrap();
    let (text, code) = benchmark(&["verify", &forged, "--benchmark", &small]);
    assert!(code == Some(1) && text.contains("success: false in the file, true when played again"), "{text}");
    let text = done(&["table", &folder, "--verify", "--benchmark", &small, "--html", &html]);
    assert!(text.contains("no: 1 difference") && text.contains("expert"), "{text}");
    assert!(fs::read_to_string(&html).unwrap().contains("cannot be compared"));
}

#[test]
fn logs_of_whoever_played_are_scored() {
    let scratch = Scratch::new("benchmark-logs");
    let small = scratch.write("small.toml", SMALL);
    let (missions, logs, out) = (scratch.path("test.jsonl"), scratch.path("logs"), scratch.path("mine.jsonl"));
    let named = ["--benchmark", &small, "--split", "validation"];
    done(&[&["missions", "--out", &missions], named.as_slice()].concat());
    let played =
        run(COHABIT, &["eval", &missions, "--agent", "expert", "--seed", "3", "--record", &logs, "--workers", "1"]);
    assert!(played.unwrap().status.success());
    let scored = [&["run", "--logs", &logs, "--name", "mine", "--out", &out], named.as_slice()].concat();
    let text = done(&scored);
    assert!(text.contains("mine"), "{text}");
    done(&["verify", &out, "--benchmark", &small]);
    // Without the logs of the other split there is nothing to score.
    let all = ["run", "--logs", &logs, "--name", "mine", "--out", &scratch.path("all.jsonl"), "--benchmark", &small];
    let (text, code) = benchmark(&all);
    let is_refused = code == Some(2) && text.contains("have no log in it");
    let has_tests = done(&["missions", "--benchmark", &small, "--split", "test", "--out", &missions]);
    assert!(is_refused || has_tests.starts_with("0 missions"), "{text}");
}

#[test]
fn wrong_calls_end_with_one_message() {
    let scratch = Scratch::new("benchmark-wrong");
    let small = scratch.write("small.toml", SMALL);
    let (out, notes) = (scratch.path("out.jsonl"), scratch.write("notes.jsonl", "my notes\n"));
    let refused = |arguments: &[&str], expected: &str| {
        let (text, code) = benchmark(arguments);
        assert!(code == Some(2) && text.contains(expected), "{code:?}: {text}");
    };
    refused(&["run", "--split", "dessert", "--out", &out], "there is no such split: train, validation, test");
    refused(&["run", "--split", "train", "--out", &out], "nobody is scored by it");
    refused(&["run", "--logs", "/nowhere", "--out", &out], "--name");
    refused(&["run", "--benchmark", &small, "--agent", "random", "--out", &notes], "it is there already");
    refused(&["run", "--benchmark", "/nowhere.toml", "--out", &out], "/nowhere.toml");
    let empty = scratch.path("empty");
    fs::create_dir(&empty).unwrap();
    refused(&["run", "--logs", &empty, "--name", "mine", "--out", &out], "there are no session logs (*.mcap) in it");
    refused(&["run", "--logs", &empty, "--name", "mine", "--seed", "2", "--out", &out], "cannot be used with");
    refused(&["run", "--agent", "random", "--out", "/nowhere/at/all.jsonl"], "there is no such folder: make it first");
    refused(&["verify", &notes, "--benchmark", &small], "not the header of a submission");
}

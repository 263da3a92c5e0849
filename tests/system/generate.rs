//! Missions that are generated, and parted.

use std::fs;

use cohabit_tests::{Scratch, run};
use serde_json::Value;

use crate::COHABIT;

fn generate(arguments: &[&str]) -> String {
    let output = run(COHABIT, &[&["generate", "builtin"], arguments].concat()).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    text
}

#[test]
fn missions_are_parted_into_files_with_a_manifest() {
    let scratch = Scratch::new("generate");
    let (out, parts) = (scratch.path("missions.jsonl"), scratch.path("splits"));
    let arguments = ["--count", "48", "--seed", "5", "--out", &out, "--splits", &parts];
    generate(&arguments);
    let manifest = fs::read_to_string(format!("{parts}/manifest.json")).unwrap();
    let read: Value = serde_json::from_str(&manifest).unwrap();
    let files = read["files"].as_object().unwrap();
    assert_eq!(files.len(), 7, "{manifest}");
    let mut lines = Vec::new();
    for file in files.values() {
        let text = fs::read_to_string(format!("{parts}/{}", file["file"].as_str().unwrap())).unwrap();
        assert_eq!(text.lines().count() as u64, file["missions"].as_u64().unwrap(), "{file}");
        lines.extend(text.lines().map(str::to_owned));
    }
    let mut whole: Vec<String> = fs::read_to_string(&out).unwrap().lines().map(str::to_owned).collect();
    lines.sort_unstable();
    whole.sort_unstable();
    assert!(lines == whole, "each mission is in one file");
    // The digests say that all of it is the same again.
    generate(&arguments);
    assert_eq!(fs::read_to_string(format!("{parts}/manifest.json")).unwrap(), manifest);
}

#[test]
fn what_cannot_be_made_is_named() {
    for (arguments, part) in [
        (
            ["builtin", "--count", "1", "--out", "/nowhere/missions.jsonl"],
            "/nowhere: there is no such folder: make it first",
        ),
        (["builtin", "--count", "0", "--out", "none.jsonl"], "--count 0: at least one"),
        (
            ["bultin", "--count", "1", "--out", "none.jsonl"],
            "bultin: No such file or directory (os error 2); name a file (TOML), or",
        ),
    ] {
        let output = run(COHABIT, &[&["generate"], &arguments[..]].concat()).unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
    }
}

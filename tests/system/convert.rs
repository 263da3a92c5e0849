//! Data sets of demonstrations, converted by the program.

use std::{fs, path::Path};

use cohabit_tests::{Scratch, run};
use serde_json::Value;

use crate::COHABIT;

const MISSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions/make_cereal.json");

/// What the program prints, and its exit code.
fn cohabit(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

#[test]
fn trajectories_of_the_expert_solve_their_mission_when_they_are_played() {
    let scratch = Scratch::new("convert");
    let (native, arena, report) = (scratch.path("native"), scratch.path("arena"), scratch.path("report.json"));
    let (text, code) = cohabit(&["demonstrate", MISSION, "--out", &native, "--modalities", "color,ids"]);
    assert_eq!(code, Some(0), "{text}");
    let (text, code) = cohabit(&["convert", &native, "--to", "arena", "--out", &arena]);
    assert!(code == Some(0) && text.contains("1 episodes with "), "{text}");
    let trajectories = format!("{arena}/trajectories.json");
    let (text, code) = cohabit(&["eval", &trajectories, "--only", "#expert", "--report", &report]);
    assert_eq!(code, Some(0), "{text}");
    let report: Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
    assert_eq!(
        (&report["missions"].as_array().unwrap().len(), &report["missions"][0]["success"]),
        (&1, &true.into()),
        "{report:#}"
    );
}

#[test]
fn wrong_calls_end_with_one_message() {
    let scratch = Scratch::new("convert-wrong");
    let (native, out) = (scratch.path("native"), scratch.path("out"));
    let refused = |arguments: &[&str], expected: &str| {
        let (text, code) = cohabit(&[&["convert"], arguments].concat());
        assert!(code == Some(2) && text.contains(expected), "{code:?}: {text}");
    };
    refused(&[&native, "--to", "lerobot", "--out", &out], "no finished data set of `cohabit demonstrate`");
    refused(&[&native, "--to", "mp3", "--out", &out], "there is no such format: lerobot, shards, arena");
    let (text, code) = cohabit(&["demonstrate", MISSION, "--out", &native, "--modalities", "none"]);
    assert_eq!(code, Some(0), "{text}");
    fs::create_dir(&out).unwrap();
    refused(&[&native, "--to", "shards", "--out", &out], "it is there already; name another folder, or remove it");
    assert!(Path::new(&out).read_dir().unwrap().next().is_none());
}

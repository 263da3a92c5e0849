//! Missions are checked before anybody plays them.

use std::fs;

use cohabit_tests::run;
use serde_json::Value;

use crate::COHABIT;

const MISSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions");

/// What `cohabit check` prints, and its exit code.
fn check(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, &[&["check"], arguments].concat()).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

#[test]
fn what_can_be_played_is_said_so() {
    let (text, code) = check(&[MISSIONS]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("cold_soda.json: playable") && text.contains("4 of 4 missions are playable"), "{text}");
}

#[test]
fn each_mistake_is_told_with_its_place_and_what_would_be_right() {
    let folder = std::env::temp_dir().join(format!("cohabit-check-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let text = fs::read_to_string(format!("{MISSIONS}/cold_soda.json")).unwrap();
    fs::write(folder.join("sound.json"), &text).unwrap();
    fs::write(folder.join("typo.json"), text.replace("CanSodaNew_01", "CanSodaNu_01")).unwrap();
    fs::write(folder.join("torn.json"), &text[..text.len() / 2]).unwrap();
    let folder_name = folder.to_str().unwrap();
    let (told, code) = check(&[folder_name]);
    assert_eq!(code, Some(2), "{told}");
    let line = text.lines().position(|line| line.contains("CanSodaNew_01")).unwrap() + 1;
    let place = format!("typo.json:{line}:");
    let found = told.lines().find(|line| line.contains(&place)).unwrap_or_else(|| panic!("no `{place}` in {told}"));
    assert!(found.contains("did you mean `CanSodaNew_01`?"), "{found}");
    assert!(told.contains("torn.json:") && told.contains("no JSON"), "{told}");
    assert!(told.contains("1 of 3 missions are playable"), "{told}");

    let output = run(COHABIT, &["check", "--json", folder_name]).unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(found.to_string().contains("typo.json"), "{found}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn missions_have_a_schema() {
    let (text, code) = check(&["--schema"]);
    assert_eq!(code, Some(0));
    let schema: Value = serde_json::from_str(&text).unwrap();
    assert!(schema["properties"]["task_goals"].is_object(), "{text}");
}

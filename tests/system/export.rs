//! Logs as tables, and what is said where rerun would be needed.

use std::{fs, os::unix::fs::PermissionsExt as _, process::Command};

use cohabit_tests::{Scratch, run};

use crate::COHABIT;

#[test]
fn logs_of_an_evaluation_are_tables_and_conditions() {
    let scratch = Scratch::new("export");
    let logs = |ask: &str| scratch.path(&format!("logs/{ask}"));
    for ask in ["never", "always"] {
        let (seed, record) = ("--seed=3", logs(ask));
        let made = ["eval", "--user", "simulated", "--missions", "2", seed, "--ask", ask, "--record", &record];
        assert!(run(COHABIT, &made).unwrap().status.success());
    }
    let [never, always] = ["never", "always"].map(logs);
    let out = scratch.path("tables");
    let done = run(COHABIT, &["export", &never, &always, "--out", &out, "--summary", "--json"]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(summary["sessions"], 4);
    assert_eq!(summary["conditions"], serde_json::json!(["ask"]));
    for name in ["sessions", "turns", "actions", "goals", "codebook"] {
        let lines = fs::read_to_string(format!("{out}/{name}.csv")).unwrap();
        assert!(lines.lines().count() > 4, "{name}: {lines}");
    }
    let printed = run(COHABIT, &["export", &never, "--summary"]).unwrap();
    assert!(String::from_utf8_lossy(&printed.stdout).contains("no setting differs"));
    let one = fs::read_dir(&never).unwrap().next().unwrap().unwrap().path();
    let twice = run(COHABIT, &["export", &never, one.to_str().unwrap(), "--summary", "--json"]).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&twice.stdout).unwrap();
    assert_eq!(summary["sessions"], 2, "a log that is named twice is one session");
}

#[test]
fn what_cannot_be_exported_is_named() {
    let scratch = Scratch::new("export-empty");
    let path = &*scratch.path("");
    for (arguments, part) in [
        (vec!["export", path, "--summary"], "no session logs"),
        (vec!["export", "/nowhere.mcap", "--summary"], "/nowhere.mcap"),
        (vec!["export", path], "--out"),
    ] {
        let output = run(COHABIT, &arguments).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(part), "{arguments:?}: no `{part}` in {text}");
    }
}

#[test]
fn logs_that_cannot_be_read_are_named_and_the_others_are_exported() {
    let scratch = Scratch::new("export-unread");
    let [logs, out] = ["logs", "tables"].map(|name| scratch.path(name));
    let made = ["eval", "--user", "simulated", "--missions", "1", "--seed=3", "--record", &logs];
    assert!(run(COHABIT, &made).unwrap().status.success());
    for name in ["logs/empty.mcap", "logs/other.mcap"] {
        let _ = scratch.write(name, "");
    }
    let output = run(COHABIT, &["export", &logs, "--out", &out]).unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    for part in ["2 of 3 logs cannot be read", "logs/empty.mcap", "logs/other.mcap"] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    let sessions = fs::read_to_string(scratch.path("tables/sessions.csv")).unwrap();
    assert_eq!(sessions.lines().count(), 2, "{sessions}");
}

#[test]
fn a_summary_for_programs_is_all_that_is_printed_beside_parquet_tables() {
    let scratch = Scratch::new("export-quiet");
    let [logs, out] = ["logs", "tables"].map(|name| scratch.path(name));
    let made = ["eval", "--user", "simulated", "--missions", "1", "--seed=3", "--record", &logs];
    assert!(run(COHABIT, &made).unwrap().status.success());
    let own = scratch.path("cohabit");
    fs::hard_link(COHABIT, &own).or_else(|_| fs::copy(COHABIT, &own).map(drop)).unwrap();
    // Beside it something that makes the folder and says so, as the program for rerun does.
    let beside =
        scratch.write("cohabit-rerun", "#!/bin/sh\nfor last; do :; done\nmkdir -p \"$last\"\necho 9 rows written\n");
    fs::set_permissions(beside, fs::Permissions::from_mode(0o755)).unwrap();
    let arguments = ["export", &logs, "--out", &out, "--format", "parquet", "--summary"];
    let told = run(&own, &arguments).unwrap();
    assert!(String::from_utf8_lossy(&told.stdout).starts_with("9 rows written\n"), "{told:?}");
    let quiet = run(&own, &[&arguments[..], &["--json"]].concat()).unwrap();
    assert!(quiet.status.success(), "{}", String::from_utf8_lossy(&quiet.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&quiet.stdout).unwrap();
    assert_eq!(summary["sessions"], 1);
}

#[test]
fn where_the_program_for_rerun_is_not_there_it_is_said_how_to_build_it() {
    // In a folder of its own nothing is beside it.
    let scratch = Scratch::new("alone");
    let alone = scratch.path("cohabit");
    fs::hard_link(COHABIT, &alone).or_else(|_| fs::copy(COHABIT, &alone).map(drop)).unwrap();
    for arguments in [
        &["replay", "x.mcap", "--rerun"][..],
        &["compare", "x.mcap", "y.mcap"],
        &["export", "x.mcap", "--out", "y", "--format", "parquet"],
        &["play", "--rerun"],
    ] {
        let output = Command::new(&alone).args(arguments).env("PATH", "").output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("cargo build --release -p cohabit-rerun"), "{arguments:?}: {text}");
    }
}

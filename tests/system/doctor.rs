//! What the machine lacks is told, and whether sessions run on it.

use std::process::{Command, Stdio};

use cohabit_tests::run;
use serde_json::Value;

use crate::COHABIT;

const CHECKS: [&str; 7] = ["shared memory", "runtime folder", "session logs", "GPU", "audio", "voice", "timers"];

#[test]
fn a_machine_that_runs_these_tests_can_run_sessions() {
    let output = run(COHABIT, &["doctor", "--port", "0"]).unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}");
    for check in CHECKS {
        assert!(text.lines().any(|line| line.contains(check)), "no `{check}` in {text}");
    }
    assert!(text.contains("Sessions run here"), "{text}");
}

#[test]
fn programs_can_read_it() {
    let output = run(COHABIT, &["doctor", "--json", "--port", "0"]).unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["can_run_sessions"], true);
    let checks = found["checks"].as_array().unwrap();
    for name in CHECKS {
        let check = checks.iter().find(|check| check["check"] == name).unwrap();
        assert!(["ok", "costs"].contains(&check["state"].as_str().unwrap()), "{check}");
        assert_eq!(check["state"] == "ok", check["costs"].is_null(), "{check}");
    }
}

#[test]
fn a_machine_that_cannot_record_is_told_so() {
    let output = Command::new(COHABIT)
        .args(["doctor", "--port", "0"])
        .env("XDG_DATA_HOME", "/proc/nowhere")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("broken  session logs") && text.contains("XDG_DATA_HOME"), "{text}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("no session can run here"));
}

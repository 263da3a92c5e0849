//! A machine that runs these tests passes the self-test; one that cannot record is told so.

use std::process::{Command, Stdio};

use cohabit_tests::{Scratch, run};

use crate::COHABIT;

const TRIALS: [&str; 4] = ["mission", "replay", "frame", "frame sent"];

#[test]
fn all_trials_pass_and_nothing_is_left_behind() {
    let scratch = Scratch::new("self-test");
    let output = Command::new(COHABIT)
        .args(["self-test", "--port", "0"])
        .env("TMPDIR", scratch.path(""))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    for trial in TRIALS {
        assert!(text.lines().any(|line| line.starts_with(&format!("ok      {trial:17} "))), "no `{trial}` in {text}");
    }
    for check in ["GPU", "voice", "browser", "Python package"] {
        assert!(text.lines().any(|line| line.contains(check)), "no `{check}` in {text}");
    }
    let left: Vec<_> = std::fs::read_dir(scratch.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    let is_log = |name: &std::ffi::OsString| name.to_string_lossy().starts_with("cohabit-self-test");
    assert!(!left.iter().any(is_log), "{left:?}");
}

#[test]
fn what_sessions_need_and_lack_fails_it() {
    let output = Command::new(COHABIT)
        .args(["self-test", "--port", "0"])
        .env("XDG_DATA_HOME", "/proc/nowhere")
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.lines().any(|line| line.starts_with("broken  session logs")), "{text}");
    assert!(text.contains("Sessions do not run on this machine"), "{text}");
}

#[test]
fn its_options_are_checked() {
    let output = run(COHABIT, &["self-test", "--port", "many"]).unwrap();
    assert_eq!(output.status.code(), Some(2));
}

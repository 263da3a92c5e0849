//! Session logs are files like others of their format: its own reader finds all in them. Where it cannot be installed,
//! the test says that it is skipped.

use std::{path::Path, process::Command};

use cohabit_record::Log;
use cohabit_tests::{Page, Play, output, python_with};
use serde_json::Value;

use crate::COHABIT;

const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/system/mcap");
const FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/mcap-python");

#[test]
fn another_reader_finds_all_that_a_log_holds() {
    let here = Path::new(HERE);
    let python = match python_with(&here.join("requirements.txt"), Path::new(FOLDER)) {
        Ok(python) => python,
        Err(why) => return eprintln!("skipped: no other reader reads a log, for want of Python's package mcap: {why}"),
    };
    let play = Play::start(COHABIT, &["cold_soda", "--speed", "3", "--record-frames", "eyes/0"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("pick up the soda can").unwrap();
    drop(page);
    let ended = play.end().unwrap();
    let read = output(Command::new(python).arg(here.join("read.py")).arg(&ended.log)).unwrap();
    let counts: Value = serde_json::from_slice(&read.stdout).unwrap();
    let log = Log::open(&ended.log).unwrap();
    let held = [
        ("/ticks", log.ticks.len()),
        ("/events", log.events.len()),
        ("/dialog", log.dialog.len()),
        ("/snapshots", log.snapshots.len()),
    ];
    for (topic, messages) in held {
        assert!(messages > 0, "{topic}");
        assert_eq!(counts[topic], messages, "{topic} in {counts}");
    }
    let copies = counts["/session"].as_u64().unwrap();
    assert!(copies >= 3, "the session entry stands at the beginning, soon after, and at the end: {counts}");
    assert!(counts.as_object().unwrap().keys().any(|topic| topic.starts_with("/frames/")), "{counts}");
}

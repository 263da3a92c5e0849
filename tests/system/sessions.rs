//! Sessions side by side, ended, and bereft of a process.

use std::{
    io::{BufRead as _, BufReader},
    process::{Command, Stdio},
};

use cohabit_tests::{Page, Play, Scratch, run};
use rustix::process::{Pid, Signal, kill_process};

use crate::COHABIT;

#[test]
fn two_sessions_run_side_by_side_and_leave_nothing() {
    let (one, two) = (Play::start(COHABIT, &[]).unwrap(), Play::start(COHABIT, &[]).unwrap());
    assert_ne!(one.address, two.address);
    for play in [&one, &two] {
        let mut page = Page::open(play.authority()).unwrap();
        page.do_and_wait("turn left 90 degrees").unwrap();
        page.wait("a frame", |page, _| page.frames > 0).unwrap();
    }
    one.end().unwrap();
    let mut page = Page::open(two.authority()).unwrap();
    page.do_and_wait("turn right").unwrap();
    two.end().unwrap();
}

#[test]
fn a_session_ends_as_ever_though_nobody_reads_any_more_what_it_says() {
    let scratch = Scratch::new("unread");
    let (session, log) = (format!("unread-{}", std::process::id()), scratch.path("session.mcap"));
    let mut play = Command::new(COHABIT)
        .args(["play", "--port", "0", "--session", &session, "--log", &log])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(play.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(said.any(|line| line.starts_with("Open http")));
    // As of `cohabit play | tee file`, of which Ctrl-C ends `tee` first.
    drop(said);
    kill_process(Pid::from_raw(i32::try_from(play.id()).unwrap()).unwrap(), Signal::INT).unwrap();
    let output = play.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let left = std::fs::read_dir("/dev/shm").unwrap().flatten();
    assert_eq!(left.filter(|entry| entry.file_name().to_string_lossy().contains(&session)).count(), 0);
    let replayed = run(COHABIT, &["replay", &log]).unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
}

#[test]
fn what_dies_but_the_simulator_is_started_again() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let dead = play.processes("agent");
    assert_eq!(dead.len(), 1);
    let mut page = Page::open(play.authority()).unwrap();
    // In the middle of a plan, and before another one: what was asked for is done by the agent that comes next.
    page.say("turn left 90 degrees, turn right 90 degrees and go to the robotics lab").unwrap();
    page.wait("a first step", |_, message| message["type"] == "progress").unwrap();
    kill_process(Pid::from_raw(dead[0]).unwrap(), Signal::KILL).unwrap();
    let ended = page.wait("the end of the plan", |_, message| message["type"] == "turn" && message["ended"] == true);
    assert_eq!(ended.unwrap()["status"], "done", "{:?}", page.chat);
    assert!(play.processes("agent").iter().all(|pid| !dead.contains(pid)));
    play.end().unwrap();
}

#[test]
fn a_supervisor_killed_takes_all_with_it_and_the_next_one_cleans_up() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let session = play.session.clone();
    let copy = std::env::temp_dir().join(format!("{session}-killed.mcap"));
    // The page may be served before the recorder has begun.
    while std::fs::hard_link(&play.log, &copy).is_err() {
        std::thread::yield_now();
    }
    kill_process(Pid::from_raw(i32::try_from(play.pid()).unwrap()).unwrap(), Signal::KILL).unwrap();
    while play.left_behind().iter().any(|line| line.contains("--session")) {
        std::thread::yield_now();
    }
    drop(play);
    let next = Play::start(COHABIT, &[]).unwrap();
    let left = std::fs::read_dir("/dev/shm").unwrap().flatten();
    assert_eq!(left.filter(|entry| entry.file_name().to_string_lossy().contains(&session)).count(), 0);
    next.end().unwrap();
    let replayed = run(COHABIT, &["replay", copy.to_str().unwrap()]).unwrap();
    let _ = std::fs::remove_file(&copy);
    assert!(replayed.status.success(), "{replayed:?}");
}

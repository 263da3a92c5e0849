//! A process that cannot be started again at once is tried again, and the session goes on meanwhile; what it cannot do is said.

use std::{
    fs,
    net::TcpListener,
    time::{Duration, Instant},
};

use cohabit_bus::{Session, Shm, Topic, Transport as _};
use cohabit_tests::{Page, Play};
use rustix::process::Signal;

use crate::COHABIT;

/// Kills a process of a session, and does something before its supervisor can notice.
fn kill_and(play: &Play, role: &str, meanwhile: impl FnOnce()) {
    play.signal_supervisor(Signal::STOP).unwrap();
    play.send(role, Signal::KILL).unwrap();
    meanwhile();
    play.signal_supervisor(Signal::CONT).unwrap();
}

#[test]
fn a_port_that_is_taken_between_two_dialog_services_is_waited_for() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port().to_string();
    let mut play = Play::start(COHABIT, &["--port", &port]).unwrap();
    let mut taken = None;
    kill_and(&play, "dialog", || {
        // The kernel ends the process a moment later.
        let deadline = Instant::now() + Duration::from_secs(60);
        while taken.is_none() {
            assert!(Instant::now() < deadline, "the port is still taken");
            taken = TcpListener::bind(format!("127.0.0.1:{port}")).ok();
        }
    });
    for _ in 0..3 {
        play.wait_for_line("the dialog process ended (exit code 4); starting it again").unwrap();
    }
    drop(taken);
    play.wait_for_line("The page is back").unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    drop(page);
    play.end().unwrap();
}

#[test]
fn a_process_that_may_not_join_is_tried_again() {
    let mut play = Play::start(COHABIT, &[]).unwrap();
    let version = Session::new(&play.session).unwrap().folder().join("version");
    let spoken = fs::read_to_string(&version).unwrap();
    kill_and(&play, "agent", || fs::write(&version, "4000000000").unwrap());
    play.wait_for_line("the agent process ended (exit code 4); starting it again").unwrap();
    fs::write(&version, spoken).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    drop(page);
    play.end().unwrap();
}

#[test]
fn a_spoilt_mission_and_state_keep_nobody_from_taking_a_dead_ones_place() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let bus = Shm::join(&Session::new(&play.session).unwrap()).unwrap();
    // What a publisher keeps for late joiners lasts as long as it does.
    let mut publishers = [Topic::Mission, Topic::State].map(|topic| bus.publisher(topic).unwrap());
    for publisher in &mut publishers {
        publisher.send(1 << 40, 300, &mut |bytes| bytes.fill(0xff)).unwrap();
    }
    for role in ["agent", "dialog"] {
        play.send(role, Signal::KILL).unwrap();
    }
    let mut page = Page::once_served(|| Page::open(play.authority())).unwrap();
    page.do_and_wait("turn left").unwrap();
    drop((page, publishers, bus));
    let play = play.end().unwrap();
    // Each is started again once, and stays.
    assert_eq!(play.said().matches("exit code").count(), 0);
}

#[test]
fn truncated_shared_memory_is_told_from_memory_that_is_full() {
    let mut play = Play::start(COHABIT, &[]).unwrap();
    for file in fs::read_dir("/dev/shm").unwrap().flatten() {
        let name = file.file_name().to_string_lossy().into_owned();
        if name.contains(&play.session) && name.ends_with(".data") {
            fs::File::options().write(true).open(file.path()).unwrap().set_len(0).unwrap();
        }
    }
    let line = play.wait_for_line("signal 7").unwrap();
    assert!(line.contains("was truncated by another program") && !line.contains("full"), "{line}");
    assert!(!play.wait_for_end().unwrap().success());
    let left = play.left_behind();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_log_that_its_recorder_could_not_end_is_said_to_be_incomplete() {
    let mut play = Play::start(COHABIT, &[]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("look around").unwrap();
    drop(page);
    play.send("record", Signal::STOP).unwrap();
    play.signal_supervisor(Signal::INT).unwrap();
    play.wait_for_line("Recorded in part in").unwrap();
    assert_eq!(play.wait_for_end().unwrap().code(), Some(3));
}

//! `cohabit time` changes how the time of a running session goes by.

use std::time::{Duration, Instant};

use cohabit_tests::{Page, Play, run};

use crate::COHABIT;

#[test]
fn a_look_at_a_session_takes_as_long_as_is_asked_for() {
    let play = Play::start(COHABIT, &["make_cereal"]).unwrap();
    let top = |once: &str| {
        let began = Instant::now();
        let output = run(COHABIT, &["top", "--session", &play.session, "--json", "--once", once]).unwrap();
        (output, began.elapsed())
    };
    let (output, taken) = top("2.5");
    assert!(output.status.success() && taken >= Duration::from_millis(2500), "{taken:?}: {output:?}");
    let (output, _) = top("nan");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    play.end().unwrap();
}

#[test]
fn a_session_stands_still_steps_goes_faster_and_goes_on() {
    let play = Play::start(COHABIT, &["make_cereal"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    let time = |change: &[&str]| {
        let output = run(COHABIT, &[&["time", "--session", &play.session], change].concat()).unwrap();
        assert!(output.status.success(), "{change:?}: {output:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let tick = |page: &Page| page.state["tick"].as_u64().unwrap_or_default();
    let paused = time(&["pause"]);
    assert!(paused.contains(": paused, at tick "), "{paused}");
    let at: u64 = paused.trim().rsplit(' ').next().unwrap().parse().unwrap();
    assert!(time(&["step", "30"]).contains("30 ticks"));
    page.wait("thirty ticks", |page, _| tick(page) == at + 30).unwrap();
    assert!(time(&["speed", "2"]).contains("2 times real time"));
    assert!(time(&["resume"]).contains("going on"));
    page.wait("time to go by", |page, _| tick(page) > at + 60).unwrap();
    drop(page);
    play.end().unwrap();
}

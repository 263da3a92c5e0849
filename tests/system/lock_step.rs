//! A session in lock-step: the world waits for its agents and for its recorder, and nothing is missing in the log.

use std::{thread, time::Duration};

use cohabit_tests::{Page, Play, run};
use rustix::process::Signal;

use crate::COHABIT;

#[test]
fn agents_and_recorder_keep_up() {
    let arguments = ["--lock-step", "--body", "robot@Lab1", "--agent", "random", "--agent", "random@1", "--seed", "4"];
    let play = Play::start(COHABIT, &arguments).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    let many = |page: &Page| page.state["tick"].as_u64().is_some_and(|tick| tick > 1000);
    page.wait("a thousand ticks", |page, _| many(page)).unwrap();
    thread::sleep(Duration::from_millis(500));
    let ended = play.end().unwrap();
    let log = cohabit_record::Log::open(&ended.log).unwrap();
    assert_eq!(log.session.settings["timing"], "lock-step with 2 agents", "as many as it has waited for");
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let said = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success() && said.contains("no tick differs"), "{said}");
}

#[test]
fn an_expert_in_a_process_of_its_own_plays_a_mission_to_its_goals() {
    let play = Play::start(COHABIT, &["make_cereal", "--lock-step", "--agent", "expert", "--seed", "4"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.wait("every goal", |page, _| page.state["ending"] == "complete").unwrap();
    assert!(page.goals().iter().all(|(_, met)| *met), "{:?}", page.goals());
    let ended = play.end().unwrap();
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let said = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success() && said.contains("no tick differs"), "{said}");
}

#[test]
fn a_recorder_that_dies_is_waited_for_until_another_takes_its_place() {
    let arguments = ["--lock-step", "--agent", "random", "--seed", "4"];
    let mut play = Play::start(COHABIT, &arguments).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    let tick = |page: &Page| page.state["tick"].as_u64().unwrap_or(0);
    page.wait("some ticks", |page, _| tick(page) > 500).unwrap();
    play.send("record", Signal::KILL).unwrap();
    play.wait_for_line("the record process ended (signal 9); starting it again").unwrap();
    let then = tick(&page);
    // The bus keeps two thousand ticks for who joins late.
    page.wait("many more ticks", |page, _| tick(page) > then + 5000).unwrap();
    let ended = play.end().unwrap();
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let said = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success() && said.contains("no tick differs"), "{said}");
}

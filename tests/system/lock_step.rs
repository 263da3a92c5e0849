//! A session in lock-step: the world waits for its agents and for its recorder, and nothing is missing in the log.

use std::{thread, time::Duration};

use cohabit_tests::{Page, Play, run};

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
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let said = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success() && said.contains("no tick differs"), "{said}");
}

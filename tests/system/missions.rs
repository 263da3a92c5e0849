//! Missions solved by typed commands, through the page's own socket, in real time; then replayed to the bit.

use cohabit_tests::{Page, Play, reference_data, run};

use crate::COHABIT;

/// Plays a mission with these sentences, and finds every goal checked and the log replayed without a difference.
fn check(mission: &str, sentences: &[&str]) {
    let play = Play::start(COHABIT, &[mission]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for sentence in sentences {
        page.do_and_wait(sentence).unwrap();
    }
    page.wait("every goal", |page, _| page.state["ending"] == "complete").unwrap();
    let goals = page.goals();
    assert!(!goals.is_empty() && goals.iter().all(|(_, met)| *met), "{goals:#?}");
    drop(page);
    let ended = play.end().unwrap();
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let text = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success() && text.contains("no tick differs"), "{text}{replayed:?}");
    assert!(text.contains(&format!("{0} of {0} goals met", goals.len())), "{text}");
}

#[test]
fn the_default_mission() {
    check(
        "make_cereal",
        &[
            "pick up the bowl",
            "open the time machine, put the bowl in it and close it",
            "turn on the time machine",
            "open the time machine and take the bowl",
            "put the bowl on the table",
            "pick up the cereal box and pour it into the bowl",
            "put the cereal on the table",
            "open the fridge, take the milk and close it",
            "pour the milk into the bowl",
        ],
    );
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_reference_cereal_mission() {
    let data = reference_data();
    check(
        data.join("cdf/mission_01.json").to_str().unwrap(),
        &[
            "go to the time machine",
            "pick up the bowl",
            "open the time machine",
            "put the bowl in the time machine",
            "close the time machine",
            "turn on the time machine",
            "open the time machine",
            "pick up the bowl",
            "put it on the table",
            "pick up the cereal",
            "pour the cereal into the bowl",
            "put the cereal box on the table",
            "open the fridge, grab the milk and close the fridge",
            "pour the milk into the bowl",
        ],
    );
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_reference_laser_mission() {
    let data = reference_data();
    check(
        data.join("cdf/mission_07.json").to_str().unwrap(),
        &["pick up the control panel", "place it in the laser", "turn on the red computer"],
    );
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_reference_freeze_ray_mission() {
    let data = reference_data();
    check(
        data.join("cdf/mission_08.json").to_str().unwrap(),
        &["find the soda can and pick it up", "put it on the blue shelf", "turn on the blue computer"],
    );
}

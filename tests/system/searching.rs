//! What the robot has not seen it looks for; what it saw it remembers.

use cohabit_tests::{Page, Play};

use crate::COHABIT;

fn robot_says(page: &Page, part: &str) -> bool {
    page.chat.iter().any(|(from, text)| from == "robot" && text.contains(part))
}

#[test]
fn what_is_unknown_is_looked_for_and_fetched() {
    let play = Play::start(COHABIT, &["make_cereal", "--speed", "8"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("where is the trophy?").unwrap();
    assert!(robot_says(&page, "I have not seen a trophy yet. Shall I look for it?"), "{:?}", page.chat);
    page.do_and_wait("pick up the trophy").unwrap();
    assert!(robot_says(&page, "I have not seen a trophy yet, so I look for it."), "{:?}", page.chat);
    assert!(robot_says(&page, "I found the trophy"), "{:?}", page.chat);
    assert!(robot_says(&page, "I have the trophy."), "{:?}", page.chat);
    page.do_and_wait("what are you holding?").unwrap();
    assert!(robot_says(&page, "I am holding the trophy."), "{:?}", page.chat);
    play.end().unwrap();
}

#[test]
fn a_search_stops_when_told_to() {
    let play = Play::start(COHABIT, &["make_cereal"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.say("find the hammer").unwrap();
    page.wait("the search", |page, _| robot_says(page, "so I look for it")).unwrap();
    page.say("stop").unwrap();
    page.wait("the end of it", |page, _| robot_says(page, "OK, I stop.")).unwrap();
    page.wait("the robot at rest", |page, _| page.state["robot"]["busy"] == false).unwrap();
    page.say("what are you doing?").unwrap();
    page.wait("nothing to do", |page, _| robot_says(page, "I am waiting for you")).unwrap();
    play.end().unwrap();
}

#[test]
fn who_knows_everything_need_not_search() {
    let play = Play::start(COHABIT, &["make_cereal", "--knows", "everything"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("where is the milk?").unwrap();
    assert!(robot_says(&page, "in the fridge"), "{:?}", page.chat);
    play.end().unwrap();
}

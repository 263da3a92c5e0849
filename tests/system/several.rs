//! Several robots and several people in one session: who is spoken to, and who said what.

use cohabit_tests::{Page, Play, Scratch};
use serde_json::{Value, json};

use crate::COHABIT;

const TWO: [&str; 12] = [
    "make_cereal",
    "--body",
    "robot@BreakRoom",
    "--body",
    "person@BreakRoom",
    "--agent",
    "dialog",
    "--agent",
    "dialog@1",
    "--name",
    "0=Rosie",
    "--name=1=Bob",
];

fn said_by(message: &Value, body: u32, part: &str) -> bool {
    message["from"] == "robot"
        && message["body"] == body
        && message["text"].as_str().is_some_and(|text| text.contains(part))
}

fn of_body(state: &Value, body: u32) -> &Value {
    let others = state["others"].as_array().into_iter().flatten();
    others.chain([&state["robot"]]).find(|one| one["body"] == body).unwrap_or(&Value::Null)
}

#[test]
fn robots_are_called_by_name_and_each_has_a_mind_of_its_own() {
    let play = Play::start(COHABIT, &TWO).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.say("Bob, go to the reception").unwrap();
    page.wait("Bob's answer", |_, message| said_by(message, 1, "going to the reception")).unwrap();
    page.wait("Bob's arrival", |_, message| said_by(message, 1, "I am in the reception")).unwrap();
    let is_told = |body: &u32| of_body(&page.state, *body)["room_name"].is_string();
    assert!([0, 1].iter().all(is_told), "the page shows where each is: {}", page.state);
    let rosie = of_body(&page.state, 0).clone();
    // Who was spoken to is spoken to still.
    page.say("where are you?").unwrap();
    page.wait("Bob's answer", |_, message| said_by(message, 1, "I am in the reception")).unwrap();
    page.say("And you, Rosie?").unwrap();
    page.say("Rosie, where are you?").unwrap();
    page.wait("Rosie's answer", |_, message| said_by(message, 0, "I am in the")).unwrap();
    assert_eq!(of_body(&page.state, 0)["x"], rosie["x"], "Rosie did not move");
    page.say("both of you, turn around").unwrap();
    let mut done = [false; 2];
    page.wait("both to turn", |_, message| {
        for (body, done) in (0..).zip(&mut done) {
            *done |= said_by(message, body, "I am done turning around");
        }
        done == [true, true]
    })
    .unwrap();
    play.end().unwrap();
}

#[test]
fn stop_without_a_name_stops_all() {
    let play = Play::start(COHABIT, &TWO).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.say("Rosie, go to the main office").unwrap();
    page.say("Bob, go to the reception").unwrap();
    page.wait("Bob's answer", |_, message| said_by(message, 1, "going to the reception")).unwrap();
    page.say("stop it now!").unwrap();
    let mut stopped = [false; 2];
    page.wait("both to stop", |_, message| {
        for (body, stopped) in (0..).zip(&mut stopped) {
            *stopped |= said_by(message, body, "I stop");
        }
        stopped == [true, true]
    })
    .unwrap();
    play.end().unwrap();
}

#[test]
fn a_robot_that_acts_on_its_own_says_so_to_who_tells_it_something() {
    let play = Play::start(COHABIT, &["make_cereal", "--agent", "expert", "--seed", "4"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for told in ["stop!", "go to the reception"] {
        page.say(told).unwrap();
        let is_told = |message: &Value| {
            message["from"] == "robot" && message["text"].as_str().is_some_and(|text| text.contains("I act on my own"))
        };
        page.wait("what it is", |_, message| is_told(message)).unwrap();
    }
    play.end().unwrap();
}

#[test]
fn people_at_several_pages_are_told_apart_and_the_robot_comes_to_who_calls() {
    let play = Play::start(COHABIT, &TWO).unwrap();
    let mut ana = Page::open(play.authority()).unwrap();
    ana.wait("the state", |page, _| !page.state.is_null()).unwrap();
    let mut ben = Page::open(play.authority()).unwrap();
    ana.say("Bob, go to the hallway").unwrap();
    let line = ben.wait("what Ana said", |_, message| message["from"] == "person").unwrap();
    assert_eq!((&line["visitor"], &line["body"]), (&json!(1), &json!(1)));
    ana.wait("Bob's arrival", |_, message| said_by(message, 1, "I am in the hallway")).unwrap();
    ben.send(&json!({ "type": "drive_body", "body": 2 })).unwrap();
    ben.wait("the avatar", |_, message| message["type"] == "driving" && message["body"] == 2).unwrap();
    ben.say("Bob, come here please").unwrap();
    let line = ana.wait("what Ben said", |_, message| message["visitor"] == 2).unwrap();
    assert_eq!(line["text"], "Bob, come here please");
    ben.wait("Bob's answer", |_, message| said_by(message, 1, "coming to you")).unwrap();
    ben.wait("Bob's arrival", |_, message| said_by(message, 1, "ere I am")).unwrap();
    let place = |page: &Page, body: u32| ["x", "y"].map(|key| of_body(&page.state, body)[key].as_f64().unwrap());
    let ([x, y], [to_x, to_y]) = (place(&ben, 1), place(&ben, 2));
    let away_m = (x - to_x).hypot(y - to_y);
    assert!((0.3..1.6).contains(&away_m), "{away_m}");
    play.end().unwrap();
}

#[test]
fn each_seat_has_a_page_of_its_own_that_drives_one_avatar() {
    let arguments = ["make_cereal", "--body", "person", "--body", "person", "--seats", "2"];
    let mut play = Play::spawn(COHABIT, &arguments).unwrap();
    let seats = [1, 2].map(|number| {
        let line = play.wait_for_line(&format!("Seat {number} (body {number}): http")).unwrap();
        line.split_once("://").unwrap().1.to_owned()
    });
    play.wait_until_ready().unwrap();
    // The second one comes first, and is the second one all the same.
    for (number, seat) in [(2, &seats[1]), (1, &seats[0])] {
        let mut page = Page::open(seat).unwrap();
        let you = page.wait("whose page it is", |_, message| message["type"] == "you").unwrap();
        assert_eq!((&you["visitor"], &you["seat"]), (&json!(number), &json!({ "body": number })));
        page.send(&json!({ "type": "drive_body", "body": 3 - number })).unwrap();
        page.wait("that it may not", |_, message| message["type"] == "error").unwrap();
        page.send(&json!({ "type": "drive_body", "body": number })).unwrap();
        page.wait("the avatar", |_, message| message["type"] == "driving" && message["body"] == number).unwrap();
    }
    let mut page = Page::open(play.authority()).unwrap();
    let you = page.wait("whose page it is", |_, message| message["type"] == "you").unwrap();
    assert_eq!((&you["visitor"], &you["seat"]), (&json!(3), &Value::Null), "the page for all has no seat");
    play.end().unwrap();
}

#[test]
fn what_a_mind_says_of_its_own_accord_is_shown() {
    let scratch = Scratch::new("says");
    let mind = format!("scripted@1={}", scratch.write("script.txt", "wait 1\nsay Here you are.\n"));
    let arguments = ["make_cereal", "--body", "robot@BreakRoom", "--agent", "dialog", "--agent", &mind];
    let play = Play::start(COHABIT, &arguments).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.wait("what it says", |_, message| said_by(message, 1, "Here you are.")).unwrap();
    play.end().unwrap();
}

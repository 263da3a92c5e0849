//! People share the space: they drive avatars from the page, one each, and work beside the robot.

use std::f64::consts::{PI, TAU};

use cohabit_tests::{Browser, Page, Play, run};
use serde_json::{Value, json};

use crate::COHABIT;

/// Places of the picture from above, the nearest to its middle, where the avatar is, first.
fn places() -> Vec<[f64; 2]> {
    let steps = |from: i32, to: i32| (from..=to).map(|step| f64::from(step) / 40.0);
    let mut all: Vec<[f64; 2]> = steps(4, 36).flat_map(|x| steps(4, 36).map(move |y| [x, y])).collect();
    let off = |[x, y]: &[f64; 2]| (x - 0.5).hypot(y - 0.5);
    all.sort_by(|one, two| off(one).total_cmp(&off(two)));
    all
}

/// A page at the controls of body 1.
struct Avatar {
    page: Page,
    /// What it was told last that is before it.
    aim: Value,
}

impl Avatar {
    fn new(mut page: Page) -> Self {
        page.send(&json!({ "type": "drive_body", "body": 1 })).unwrap();
        let told = page.wait("the body", |_, message| message["type"] == "driving").unwrap();
        assert_eq!(told["body"], 1, "{told}");
        page.send(&json!({ "type": "view", "camera": "overhead/1" })).unwrap();
        let frames = page.frames;
        page.wait("a picture from above", |page, _| page.frames > frames + 2).unwrap();
        Self { page, aim: Value::Null }
    }

    fn body(&self) -> &Value {
        &self.page.state["others"][0]
    }

    fn number(&self, key: &str) -> f64 {
        self.body()[key].as_f64().unwrap()
    }

    /// Sends something, and waits for the next state, so that no more is sent than a page may.
    fn tell(&mut self, message: &Value) {
        self.page.send(message).unwrap();
        let tick = self.page.state["tick"].clone();
        let mut aim = Value::Null;
        self.page
            .wait("the next state", |page, message| {
                if message["type"] == "aim" {
                    aim = message.clone();
                }
                page.state["tick"] != tick
            })
            .unwrap();
        if !aim.is_null() {
            self.aim = aim;
        }
    }

    /// What is at a place of the picture from above, with what can be done with it.
    fn look(&mut self, [x, y]: [f64; 2]) -> Value {
        self.aim = Value::Null;
        self.tell(&json!({ "type": "point", "camera": "overhead/1", "tick": 0, "x": x, "y": y }));
        self.aim.clone()
    }

    /// Walks on for a tenth of a second.
    fn walk(&mut self, forward_m_s: f64, turn_rad_s: f64) {
        self.tell(&json!({ "type": "drive", "forward_m_s": forward_m_s, "turn_rad_s": turn_rad_s, "pitch_rad_s": 0 }));
    }

    /// Turns to a direction of the picture from above, where north is up, and walks that way for a while.
    fn walk_towards(&mut self, [x, y]: [f64; 2]) {
        let heading = (0.5 - y).atan2((x - 0.5) * 16.0 / 9.0);
        for _ in 0..60 {
            let off = (heading - self.number("yaw") + PI).rem_euclid(TAU) - PI;
            let forward = if off.abs() < 0.4 { 0.9 } else { 0.0 };
            self.walk(forward, off * 2.0);
            if forward > 0.0 {
                break;
            }
        }
    }

    /// Does something, and waits for what comes of it.
    fn act(&mut self, deed: &str, object: &Value) -> (bool, String) {
        self.page.send(&json!({ "type": "act", "deed": deed, "object": object })).unwrap();
        let acted = self.page.wait("what came of it", |_, message| message["type"] == "acted").unwrap();
        (acted["ok"] == true, acted["text"].as_str().unwrap().to_owned())
    }

    /// Looks around and walks about until something affords `deed` here, and does it.
    fn find_and(&mut self, deed: &str) -> Result<String, String> {
        let mut tried = Vec::new();
        for round in 0..12 {
            for place in places().into_iter().step_by(3) {
                let aim = self.look(place);
                let offers = aim["options"].as_array().is_some_and(|all| all.iter().any(|one| one["deed"] == deed));
                if !offers || tried.contains(&aim["object"]) {
                    continue;
                }
                let (ok, text) = self.act(deed, &aim["object"]);
                if ok {
                    return Ok(text);
                }
                tried.push(aim["object"].clone());
            }
            let angle = f64::from(round) * 2.4;
            for _ in 0..12 {
                self.walk_towards([0.5 + 0.3 * angle.cos(), 0.5 + 0.3 * angle.sin()]);
            }
        }
        Err(format!("nothing affords {deed}; tried {tried:?}; state: {}", self.page.state))
    }
}

#[test]
fn a_person_works_beside_the_robot_and_it_replays_to_the_bit() {
    let play = Play::start(COHABIT, &["--body", "person@BreakRoom", "--seed", "5"]).unwrap();
    let mut avatar = Avatar::new(Page::open(play.authority()).unwrap());
    avatar.page.say("go to the main office").unwrap();
    let from = [avatar.number("x"), avatar.number("y")];
    let took = avatar.find_and("pick_up").unwrap();
    println!("{took}");
    avatar.page.wait("it in the hand", |page, _| !page.state["others"][0]["holding"].is_null()).unwrap();
    for _ in 0..15 {
        avatar.walk(1.2, 0.6);
    }
    let put = avatar.find_and("place").unwrap();
    println!("{put}");
    avatar.page.wait("an empty hand", |page, _| page.state["others"][0]["holding"].is_null()).unwrap();
    let to = [avatar.number("x"), avatar.number("y")];
    assert!((to[0] - from[0]).hypot(to[1] - from[1]) > 0.2, "walked from {from:?} to {to:?}");
    avatar.page.wait("the robot", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();

    // One body, one commander; who closes the page gives it back.
    let mut other = Page::open(play.authority()).unwrap();
    other.send(&json!({ "type": "drive_body", "body": 1 })).unwrap();
    let refused = other.wait("a refusal", |_, message| message["type"] == "error").unwrap();
    assert!(refused["text"].as_str().unwrap().contains("Somebody else drives"), "{refused}");
    other.send(&json!({ "type": "drive_body", "body": 0 })).unwrap();
    let refused = other.wait("a refusal", |_, message| message["type"] == "error").unwrap();
    assert!(refused["text"].as_str().unwrap().contains("Nobody may drive"), "{refused}");
    drop(avatar);
    other.wait("the body to be free", |page, _| page.state["driven"] == json!([])).unwrap();
    other.send(&json!({ "type": "drive_body", "body": 1 })).unwrap();
    other.wait("the body", |_, message| message["type"] == "driving" && message["body"] == 1).unwrap();
    drop(other);

    let play = play.end().unwrap();
    let replayed = run(COHABIT, &["replay", play.log.to_str().unwrap()]).unwrap();
    let text = String::from_utf8_lossy(&replayed.stdout).into_owned();
    assert!(replayed.status.success(), "{text}{}", String::from_utf8_lossy(&replayed.stderr));
}

#[test]
fn the_robot_is_handed_over_where_the_session_allows_it_and_taken_up_again() {
    let play = Play::start(COHABIT, &["--drive", "all", "--seed", "5"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    page.send(&json!({ "type": "drive_body", "body": 0 })).unwrap();
    page.wait("the robot", |_, message| message["type"] == "driving" && message["body"] == 0).unwrap();
    let yaw = page.state["robot"]["yaw"].clone();
    page.send(&json!({ "type": "drive", "forward_m_s": 0, "turn_rad_s": 2, "pitch_rad_s": 0 })).unwrap();
    page.wait("a turn", |page, _| page.state["robot"]["yaw"] != yaw).unwrap();
    page.send(&json!({ "type": "release" })).unwrap();
    page.wait("the robot to be free", |page, _| page.state["driven"] == json!([])).unwrap();
    page.do_and_wait("go to the main office").unwrap();
    page.wait("the robot", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
    play.end().unwrap();
}

#[test]
fn a_page_cannot_flood_its_way_in() {
    let play = Play::start(COHABIT, &["--body", "person"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for _ in 0..100 {
        page.send(&json!({ "type": "drive", "forward_m_s": 1e300, "turn_rad_s": 0, "pitch_rad_s": 0 })).unwrap();
    }
    let told = page.wait("a word", |_, message| message["type"] == "error").unwrap();
    assert!(told["text"].as_str().unwrap().contains("a lot at once"), "{told}");
    // Who drives nothing moves nothing, and the session goes on.
    page.wait("calm", |page, _| page.state["others"][0]["x"].is_number()).unwrap();
    play.end().unwrap();
}

/// Presses a key for as long as `held` takes, where that is given.
fn press(tab: &mut cohabit_tests::Tab, code: &str, key: &str, held: Option<&str>) {
    let event = |kind: &str| json!({ "type": kind, "code": code, "key": key, "windowsVirtualKeyCode": 0 });
    tab.call("Input.dispatchKeyEvent", &event("rawKeyDown")).unwrap();
    if let Some(until) = held {
        tab.wait_until(until).unwrap();
    }
    tab.call("Input.dispatchKeyEvent", &event("keyUp")).unwrap();
}

#[test]
fn a_person_walks_in_from_the_page_by_keys() {
    let Some(browser) = Browser::start().unwrap() else { return };
    let play = Play::start(COHABIT, &["--body", "person@MainOffice"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && !document.querySelector('#walk-in').hidden").unwrap();
    tab.evaluate("document.querySelector('#walk-in').click()").unwrap();
    tab.wait_until("window.cohabit.driving === 1 && window.cohabit.view === 'eyes/1'").unwrap();
    tab.evaluate("window.start = window.cohabit.state.others[0]").unwrap();
    let turned = "Math.abs(window.cohabit.state.others[0].yaw - window.start.yaw) > 0.5";
    press(&mut tab, "KeyA", "a", Some(turned));
    let moved = "Math.hypot(window.cohabit.state.others[0].x - window.start.x, \
                 window.cohabit.state.others[0].y - window.start.y) > 0.05";
    press(&mut tab, "KeyW", "w", Some(moved));
    // What is typed in the chat moves nobody.
    press(&mut tab, "Slash", "/", Some("document.activeElement.id === 'chat-input'"));
    let written = "document.querySelector('#chat-input').value";
    tab.call("Input.insertText", &json!({ "text": "wasd" })).unwrap();
    assert_eq!(tab.evaluate(written).unwrap(), json!("wasd"));
    press(&mut tab, "Escape", "Escape", Some("document.activeElement.id === 'view'"));
    assert_eq!(tab.evaluate("window.cohabit.driving").unwrap(), json!(1), "the first Escape leaves the field alone");
    press(&mut tab, "Escape", "Escape", Some("window.cohabit.driving === null"));
    tab.wait_until("window.cohabit.view === 'spectator/0' && !document.querySelector('#walk-in').hidden").unwrap();
    drop((tab, browser));
    play.end().unwrap();
}

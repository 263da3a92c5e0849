//! People share the space: they drive avatars from the page, one each, and work beside the robot.

use std::f32::consts::{PI, TAU};

use cohabit_bus::{Sample, Session, Shm, Subscriber, Topic, Transport as _, message::StateView};
use cohabit_tests::{Browser, Page, Play, Scratch, run};
use serde_json::json;

use crate::COHABIT;

/// A page at the controls of body 1, and what is truly so.
struct Avatar {
    page: Page,
    states: Box<dyn Subscriber>,
    newest: Option<Sample>,
}

impl Avatar {
    fn new(play: &Play) -> Self {
        let bus = Shm::join(&Session::new(&play.session).unwrap()).unwrap();
        let states = bus.subscriber(Topic::State).unwrap();
        let mut page = Page::open(play.authority()).unwrap();
        page.send(&json!({ "type": "drive_body", "body": 1 })).unwrap();
        let told = page.wait("the body", |_, message| message["type"] == "driving").unwrap();
        assert_eq!(told["body"], 1, "{told}");
        page.send(&json!({ "type": "view", "camera": "eyes/1" })).unwrap();
        Self { page, states, newest: None }
    }

    /// The number of an object and how far it is, m, and to which side, rad, from the avatar.
    fn find(&mut self, instance: &str) -> (u32, f32, f32) {
        if let Some(sample) = self.states.latest().unwrap() {
            self.newest = Some(sample);
        }
        let state = StateView::new(self.newest.as_ref().unwrap().payload()).unwrap();
        let object = state.objects.iter().find(|object| object.instance.as_str() == instance).unwrap();
        let body = &state.bodies[1];
        let [dx, dy] = [0, 1].map(|axis| object.position_m[axis] - body.position_m[axis]);
        let off = (dy.atan2(dx) - body.yaw_rad + PI).rem_euclid(TAU) - PI;
        (object.object, dx.hypot(dy), off)
    }

    /// Keeps the keys held for a tenth of a second.
    fn hold(&mut self, forward_m_s: f32, turn_rad_s: f32) {
        let drive = json!({ "type": "drive", "forward_m_s": forward_m_s, "turn_rad_s": turn_rad_s, "pitch_rad_s": 0 });
        self.page.send(&drive).unwrap();
        let tick = self.page.state["tick"].clone();
        self.page.wait("the next state", |page, _| page.state["tick"] != tick).unwrap();
    }

    /// Walks up to an object.
    fn walk_to(&mut self, instance: &str) {
        for _ in 0..600 {
            let (_, distance_m, off) = self.find(instance);
            if distance_m < 1.3 {
                return self.hold(0.0, 0.0);
            }
            self.hold(if off.abs() < 0.5 { 0.9 } else { 0.0 }, off * 2.0);
        }
        panic!("no way to {instance}: {:?}; {}", self.find(instance), self.page.state);
    }

    /// Does something to an object, and waits for what comes of it.
    fn act(&mut self, deed: &str, instance: &str) -> String {
        let (object, ..) = self.find(instance);
        self.page.send(&json!({ "type": "act", "deed": deed, "object": object })).unwrap();
        let acted = self.page.wait("what came of it", |_, message| message["type"] == "acted").unwrap();
        assert_eq!(acted["ok"], true, "{deed} {instance}: {acted}");
        acted["text"].as_str().unwrap().to_owned()
    }
}

#[test]
fn a_person_works_beside_the_robot_and_it_replays_to_the_bit() {
    let play = Play::start(COHABIT, &["--body", "person@BreakRoom", "--seed", "5"]).unwrap();
    let mut avatar = Avatar::new(&play);
    avatar.page.say("go to the main office").unwrap();
    avatar.walk_to("Bowl_01_1");
    let told = avatar.act("pick_up", "Bowl_01_1");
    assert_eq!(told, "You are holding the bowl");
    avatar.page.wait("it in the hand", |page, _| page.state["others"][0]["holding"] == "Bowl").unwrap();
    // The eyes are still on the table that it was taken from.
    avatar.page.wait("an offer", |page, _| page.aim["options"][0]["deed"] == "place").unwrap();
    avatar.hold(-0.5, 0.5);
    avatar.act("place", "TableRound_02_1");
    avatar.page.wait("an empty hand", |page, _| page.state["others"][0]["holding"].is_null()).unwrap();
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
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_walks_in_from_the_page_by_keys() {
    let browser = Browser::start().unwrap();
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

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn who_cannot_walk_in_is_told_why() {
    let browser = Browser::start().unwrap();
    let scratch = Scratch::new("walk-in");
    let schedule = scratch.write("stands.toml", "[[entry]]\nperson = 1\nstay_s = 3600\n");
    let pedestrian = format!("pedestrian={schedule}");
    let play =
        Play::start(COHABIT, &["--body", "person@MainOffice", "--agent", "dialog", "--agent", &pedestrian]).unwrap();
    let bus = Shm::join(&Session::new(&play.session).unwrap()).unwrap();
    let mut states = bus.subscriber(Topic::State).unwrap();
    let is_commanded = |sample: Sample| StateView::new(sample.payload()).unwrap().bodies[1].commander != 0;
    while !states.latest().unwrap().is_some_and(is_commanded) {
        std::thread::park_timeout(std::time::Duration::from_millis(20));
    }
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && !document.querySelector('#walk-in').hidden").unwrap();
    tab.evaluate("document.querySelector('#walk-in').click()").unwrap();
    tab.wait_until("document.querySelector('#toasts').textContent.includes('--drive all')").unwrap();
    assert_eq!(tab.evaluate("window.cohabit.driving").unwrap(), json!(null));
    drop((tab, browser));
    play.end().unwrap();
}

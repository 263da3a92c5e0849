//! A wizard takes part in a session: decides what the robot answers, at a page of their own, and nobody else learns of it.

use std::{
    collections::{BTreeMap, BTreeSet},
    thread,
};

use cohabit_record::{DecisionOutcome, Log, WizardDecision};
use cohabit_tests::{Browser, Page, Play, Tab, run};
use serde_json::{Value, json};

use crate::{COHABIT, accessibility};

/// A session, and where its wizard sits: `host:port/?token=…`, as pages are opened in tests.
fn play(arguments: &[&str]) -> (Play, String) {
    let common = ["make_cereal", "--knows", "everything", "--understanding", "fast", "--seed", "3", "--speed", "4"];
    let mut play = Play::spawn(COHABIT, &[&common, arguments].concat()).unwrap();
    let line = play.wait_for_line("Wizard's seat: ").unwrap();
    let (_, address) = line.split_once("://").unwrap();
    play.wait_until_ready().unwrap();
    (play, address.replace("/wizard?", "/?"))
}

/// Says these, one after the other was answered; all that the page was told meanwhile.
fn talk(page: &mut Page, said: &[&str]) -> Vec<Value> {
    let mut told = Vec::new();
    let mut hear = |page: &mut Page, last: &dyn Fn(&Value) -> bool| loop {
        let message = page.next_message().unwrap();
        let is_last = last(&message);
        told.push(message);
        if is_last {
            break;
        }
    };
    hear(page, &|message| message["type"] == "state");
    for text in said {
        page.say(text).unwrap();
        hear(page, &|message| message["type"] == "turn" && message["ended"] == true);
    }
    told
}

/// Accepts whatever is proposed, so many times.
fn accept(seat: &str, count: usize) -> thread::JoinHandle<()> {
    let mut page = Page::open(seat).unwrap();
    page.wait("the seat", |_, message| message["type"] == "seat").unwrap();
    thread::spawn(move || {
        for _ in 0..count {
            let is_open = |message: &Value| message["type"] == "proposal" && message["proposal"]["is_decided"] == false;
            let told = page.wait("a proposal", |_, message| is_open(message)).unwrap();
            let (turn, revision) = (&told["proposal"]["turn"], &told["proposal"]["revision"]);
            decide(&mut page, &json!({ "type": "accept", "turn": turn, "revision": revision }));
        }
    })
}

/// Decides; the problem with it, if there is one.
fn decide(page: &mut Page, decision: &Value) -> Value {
    page.send(&json!({ "type": "decide", "decision": decision })).unwrap();
    page.wait("the answer", |_, message| message["type"] == "decided").unwrap()["problem"].clone()
}

/// The fields of the messages of each kind, also of what is in them.
fn fields(told: &[Value]) -> BTreeMap<String, BTreeSet<String>> {
    fn add(value: &Value, at: &str, all: &mut BTreeSet<String>) {
        match value {
            Value::Object(fields) => {
                for (name, value) in fields {
                    let at = format!("{at}/{name}");
                    add(value, &at, all);
                    all.insert(at);
                }
            }
            Value::Array(items) => items.iter().for_each(|item| add(item, at, all)),
            _ => {}
        }
    }
    let mut fields = BTreeMap::<String, BTreeSet<String>>::new();
    for message in told {
        add(message, "", fields.entry(message["type"].to_string()).or_default());
    }
    fields
}

const TALK: [&str; 4] =
    ["go to the main office", "what are you holding?", "blorp the zargle", "go to the break room, then look around"];

#[test]
fn participants_are_told_the_same_with_a_wizard_and_without() {
    let delay = ["--response-delay-ms", "300"];
    let (led, seat) = play(&[&delay[..], &["--wizard", "yes", "--wizard-phrase", "h=Hello!"]].concat());
    // The wizard is there first.
    let wizard = accept(&seat, TALK.len());
    let with = talk(&mut Page::open(led.authority()).unwrap(), &TALK);
    wizard.join().unwrap();
    let common = ["make_cereal", "--knows", "everything", "--understanding", "fast", "--seed", "3", "--speed", "4"];
    let alone = Play::start(COHABIT, &[&common[..], &delay].concat()).unwrap();
    let without = talk(&mut Page::open(alone.authority()).unwrap(), &TALK);
    // What follows from what was said comes in the same order, word for word; all else, such as what the mission tells, is of the
    // same kinds and fields.
    let said = |told: &[Value]| -> Vec<Value> {
        let follows = ["you", "hello", "chat", "progress", "turn"];
        let told = told.iter().filter(|message| follows.iter().any(|kind| message["type"] == *kind));
        let told = told.filter(|message| message["from"] != "game");
        let mut told: Vec<Value> = told.cloned().collect();
        for message in told.iter_mut().filter(|message| message["type"] == "hello") {
            message["session"] = Value::Null;
        }
        told
    };
    assert_eq!(said(&with), said(&without));
    assert_eq!(fields(&with), fields(&without));
    for message in &with {
        let text = message.to_string().to_lowercase();
        assert!(!text.contains("wizard") && !text.contains("proposal") && !text.contains("decid"), "{text}");
    }
    led.end().unwrap();
    alone.end().unwrap();
}

#[test]
fn what_a_wizard_decides_is_done_and_stands_in_the_log() {
    let (play, seat) = play(&["--wizard", "yes", "--wizard-phrase", "h=Hello!"]);
    let mut wizard = Page::open(&seat).unwrap();
    let told = wizard.wait("the seat", |_, message| message["type"] == "seat").unwrap();
    assert_eq!(told["phrases"], json!([{ "key": "h", "text": "Hello!", "waits": false }]));
    let mut page = Page::open(play.authority()).unwrap();
    let proposed = |wizard: &mut Page, kind: &str, revision: u64| {
        let is_it = |message: &Value| {
            let proposal = &message["proposal"];
            message["type"] == "proposal" && proposal["kind"] == kind && proposal["revision"] == revision
        };
        wizard.wait("a proposal", |_, message| is_it(message)).unwrap()["proposal"].clone()
    };
    let ended = |page: &mut Page| {
        page.wait("the end", |_, message| message["type"] == "turn" && message["ended"] == true).unwrap();
    };
    let says = |page: &Page, text: &str| page.chat.iter().any(|(from, said)| from == "robot" && said.contains(text));

    // Another request in place of what was said.
    page.say("blorp the zargle").unwrap();
    let proposal = proposed(&mut wizard, "refusal", 0);
    assert_eq!(proposal["said"], "blorp the zargle");
    let turn = &proposal["turn"];
    assert!(decide(&mut wizard, &json!({ "type": "edit", "turn": turn, "text": "go to the reception" })).is_null());
    let stale = decide(&mut wizard, &json!({ "type": "accept", "turn": turn, "revision": 0 }));
    assert!(stale.as_str().unwrap().contains("changed"), "{stale}");
    assert!(decide(&mut wizard, &json!({ "type": "accept", "turn": turn, "revision": 1 })).is_null());
    ended(&mut page);
    assert!(says(&page, "going to the reception"), "{:?}", page.chat);
    // A phrase.
    page.say("go to the break room").unwrap();
    let proposal = proposed(&mut wizard, "plan", 0);
    let phrase = json!({ "type": "own", "turn": proposal["turn"], "phrase": "h" });
    assert!(decide(&mut wizard, &phrase).is_null());
    ended(&mut page);
    assert!(says(&page, "Hello!") && !says(&page, "break room"), "{:?}", page.chat);
    // An order, of which nothing is said.
    let lines = page.chat.len();
    let order = json!({ "type": "own", "turn": null, "order": "go to the break room" });
    assert!(decide(&mut wizard, &order).is_null());
    page.wait("the break room", |page, _| page.state["robot"]["room_name"] == "break room").unwrap();
    ended(&mut page);
    assert_eq!(page.chat.len(), lines, "{:?}", page.chat);
    let problem = decide(&mut wizard, &json!({ "type": "own", "turn": null, "order": "snorf the wibble" }));
    assert!(problem.as_str().unwrap().contains("would not do that"), "{problem}");
    // A stop is not held back.
    page.do_and_wait("stop").unwrap();
    drop((page, wizard));
    let ended = play.end().unwrap();
    let log = Log::open(&ended.log).unwrap();
    let decisions: Vec<WizardDecision> = log.dialog.iter().filter_map(WizardDecision::of).collect();
    let outcomes: Vec<_> = decisions.iter().map(|one| one.outcome).collect();
    use DecisionOutcome::{Edited, Replaced, Unprompted};
    assert_eq!(outcomes, [Edited, Replaced, Unprompted], "{decisions:#?}");
    assert_eq!((decisions[1].phrase, decisions[2].ordered.as_str()), (Some('h'), "go to the break room"));
    assert!(decisions[..2].iter().all(|one| one.decided_ms.is_some() && one.answered_ms >= one.decided_ms));
    assert_eq!(log.session.settings["wizard"], "yes");
    // What a wizard does reaches the world by the robot's commands alone.
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
    let out = ended.folder.join("tables");
    let exported = run(COHABIT, &["export", ended.log.to_str().unwrap(), "--out", out.to_str().unwrap()]).unwrap();
    assert!(exported.status.success(), "{exported:?}");
    let table = std::fs::read_to_string(out.join("decisions.csv")).unwrap();
    for part in ["edited,true,false,blorp the zargle,refusal", "go to the reception,1", "unprompted,true"] {
        assert!(table.contains(part), "`{part}` is not in {table}");
    }
}

#[test]
fn a_wizard_clicks_shows_a_face_injects_an_error_and_leaves_something_undecided() {
    let error = r#"{"name":"wrong room","do":"go to the reception","step":1}"#;
    let (play, seat) = play(&["--wizard", "yes", "--wizard-error", error]);
    let mut wizard = Page::open(&seat).unwrap();
    let told = wizard.wait("the seat", |_, message| message["type"] == "seat").unwrap();
    assert_eq!((&told["errors"][0]["name"], &told["expressions"][2]), (&json!("wrong room"), &json!("sorry")));
    let mut page = Page::open(play.authority()).unwrap();
    page.wait("the robot", |page, _| page.state["robot"].is_object()).unwrap();
    // Where it stands is a place on the floor.
    let robot = &page.state["robot"];
    wizard.send(&json!({ "type": "floor", "x": robot["x"], "y": robot["y"] })).unwrap();
    let menu = wizard.wait("what is offered", |_, message| message["type"] == "menu").unwrap();
    assert_eq!((&menu["name"], &menu["choices"][0]["label"]), (&robot["room_name"], &json!("Go there")));
    let click = json!({ "type": "click", "turn": null, "click": menu["choices"][0]["click"] });
    assert!(decide(&mut wizard, &click).is_null());
    assert!(decide(&mut wizard, &json!({ "type": "express", "expression": "sorry" })).is_null());
    page.wait("the face", |_, message| message["type"] == "expression" && message["expression"] == "sorry").unwrap();
    let propose = |page: &mut Page, wizard: &mut Page, said: &str| {
        page.say(said).unwrap();
        let is_it = |message: &Value| message["type"] == "proposal" && message["proposal"]["said"] == said;
        wizard.wait("a proposal", |_, message| is_it(message)).unwrap()["proposal"]["turn"].clone()
    };
    let turn = propose(&mut page, &mut wizard, "go to the main office");
    let inject = json!({ "type": "inject", "turn": turn, "error": "wrong room" });
    assert!(decide(&mut wizard, &inject).is_null());
    page.wait("the wrong room", |page, _| page.state["robot"]["room_name"] == "reception").unwrap();
    assert!(page.chat.iter().any(|(_, text)| text.starts_with("OK, going to the main office")), "{:?}", page.chat);
    propose(&mut page, &mut wizard, "go to the break room");
    drop((page, wizard));
    let ended = play.end().unwrap();
    let log = Log::open(&ended.log).unwrap();
    let decisions: Vec<WizardDecision> = log.dialog.iter().filter_map(WizardDecision::of).collect();
    let outcomes: Vec<_> = decisions.iter().map(|one| one.outcome).collect();
    use DecisionOutcome::{Replaced, Undecided, Unprompted};
    assert_eq!(outcomes, [Unprompted, Unprompted, Replaced, Undecided], "{decisions:#?}");
    assert_eq!((decisions[0].clicked.as_deref(), decisions[0].chosen_ms.is_some()), (Some("go_to_point"), true));
    assert_eq!(decisions[1].expression.as_deref(), Some("sorry"));
    assert_eq!(decisions[2].injected.as_deref(), Some("wrong room"));
    assert_eq!(decisions[3].said, "go to the break room");
    let seat: Vec<&str> = log.dialog.iter().filter(|one| one.kind == "Seat").map(|one| one.text.as_str()).collect();
    assert!(seat.starts_with(&["empty", "taken"]), "{seat:?}");
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    assert!(replayed.status.success(), "{replayed:?}");
}

#[test]
fn a_late_wizard_leaves_it_to_the_policy_and_a_killed_service_holds_what_was_held() {
    let acts = ["--wizard", "yes", "--wizard-timeout-s", "0.5", "--wizard-on-timeout", "act"];
    let (play_acting, _) = play(&acts);
    let mut page = Page::open(play_acting.authority()).unwrap();
    page.do_and_wait("go to the main office").unwrap();
    assert_eq!(page.state["robot"]["room_name"], "main office");
    drop(page);
    play_acting.end().unwrap();

    let (play, seat) = play(&["--wizard", "yes"]);
    let mut page = Page::open(play.authority()).unwrap();
    let mut wizard = Page::open(&seat).unwrap();
    let is_open = |message: &Value| message["type"] == "proposal" && message["proposal"]["is_decided"] == false;
    page.say("go to the main office").unwrap();
    let before = wizard.wait("a proposal", |_, message| is_open(message)).unwrap();
    play.send("dialog", rustix::process::Signal::KILL).unwrap();
    let mut wizard = Page::once_served(|| Page::open(&seat)).unwrap();
    let after = wizard.wait("the proposal", |_, message| is_open(message)).unwrap();
    assert_eq!(
        (&after["proposal"]["turn"], &after["proposal"]["reply"]),
        (&before["proposal"]["turn"], &before["proposal"]["reply"])
    );
    let mut page = Page::once_served(|| Page::open(play.authority())).unwrap();
    let accept =
        json!({ "type": "accept", "turn": after["proposal"]["turn"], "revision": after["proposal"]["revision"] });
    assert!(decide(&mut wizard, &accept).is_null());
    page.wait("the main office", |page, _| page.state["robot"]["room_name"] == "main office").unwrap();
    drop((page, wizard));
    play.end().unwrap();
}

/// The seat in a browser, once it shows what the robot sees.
fn sit_down(browser: &Browser, seat: &str) -> Tab {
    let address = format!("http://{}", seat.replace("/?", "/wizard?"));
    let mut tab = browser.open(&address, 1280, 800).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && window.cohabit.seat !== null").unwrap();
    assert_eq!(tab.evaluate("window.cohabit.view").unwrap(), json!("eyes/0"), "what the robot sees");
    tab
}

/// Presses a key in the element that has the focus.
fn press(tab: &mut Tab, key: &str) {
    let event = format!(
        "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {{ key: {key:?}, bubbles: true }}))"
    );
    tab.evaluate(&event).unwrap();
}

/// The numbers of a list.
fn numbers<const COUNT: usize>(list: &Value) -> [f64; COUNT] {
    std::array::from_fn(|at| list[at].as_f64().unwrap())
}

/// Clicks with the mouse, px from the left and from the top of the window.
fn click(tab: &mut Tab, [x, y]: [f64; 2]) {
    for kind in ["mousePressed", "mouseReleased"] {
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
        tab.call("Input.dispatchMouseEvent", &event).unwrap();
    }
}

/// Clicks here and there in the picture until a menu opens that is of a thing, not of the floor or of a wall.
fn click_on_a_thing(tab: &mut Tab) {
    let view = "(() => { const box = document.querySelector('#view').getBoundingClientRect(); \
        return [box.x, box.y, box.width, box.height]; })()";
    let [left, top, width, height] = numbers(&tab.evaluate(view).unwrap());
    // What was offered by then, or nothing: there are places where nothing is.
    let offered = "new Promise((done) => { const look = (tries) => window.cohabit.menu !== null || tries === 0 \
        ? done(window.cohabit.menu) : setTimeout(look, 20, tries - 1); look(100); })";
    for y in [0.5, 0.6, 0.4, 0.7] {
        for x in [0.5, 0.35, 0.65, 0.2, 0.8] {
            tab.evaluate("window.cohabit.menu = null").unwrap();
            click(tab, [left + width * x, top + height * y]);
            let choices = tab.evaluate(offered).unwrap().as_array().cloned().unwrap_or_default();
            if choices.iter().any(|choice| choice["label"] == "Look at it") {
                return;
            }
            // An open menu may lie over the next place.
            if !choices.is_empty() {
                press(tab, "Escape");
            }
        }
    }
    panic!("no thing in the picture has a menu");
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_wizard_needs_nothing_but_a_keyboard() {
    let (play, seat) = play(&["--wizard", "yes", "--wizard-phrase", "h=Hello!"]);
    let browser = Browser::start().unwrap();
    let mut tab = sit_down(&browser, &seat);
    accessibility::check(&mut tab, "the wizard's seat while nothing is proposed");
    accessibility::resize(&mut tab, [1280, 800]);
    let mut page = Page::open(play.authority()).unwrap();
    page.say("blorp the zargle").unwrap();
    tab.wait_until("window.cohabit.proposal?.kind === 'refusal'").unwrap();
    // Written words begin with what was said.
    press(&mut tab, "=");
    assert_eq!(
        tab.evaluate("document.activeElement.id + document.activeElement.value").unwrap(),
        json!("editblorp the zargle")
    );
    tab.evaluate(
        "document.activeElement.value = 'go to the reception'; document.querySelector('#orders').requestSubmit()",
    )
    .unwrap();
    tab.wait_until("window.cohabit.proposal?.kind === 'plan' && document.activeElement === document.body").unwrap();
    press(&mut tab, "Enter");
    page.wait("the reception", |page, _| page.chat.iter().any(|(_, text)| text.contains("going to the reception")))
        .unwrap();
    press(&mut tab, "h");
    page.wait("a phrase", |page, _| page.chat.iter().any(|(_, text)| text == "Hello!")).unwrap();
    press(&mut tab, "/");
    assert_eq!(tab.evaluate("document.activeElement.id").unwrap(), json!("say"));
    tab.evaluate("document.activeElement.value = 'Here I am.'; document.querySelector('#orders').requestSubmit()")
        .unwrap();
    page.wait("what was typed", |page, _| page.chat.iter().any(|(_, text)| text == "Here I am.")).unwrap();
    tab.wait_until("document.querySelector('#say').value === ''").unwrap();
    drop(page);
    accessibility::check(&mut tab, "the wizard's seat after a conversation");
    let mut page = Page::open(play.authority()).unwrap();
    page.say("go to the break room").unwrap();
    tab.wait_until("window.cohabit.proposal?.kind === 'plan'").unwrap();
    drop(page);
    accessibility::check(&mut tab, "the wizard's seat with a proposal");
    accessibility::check_with_more_contrast(&mut tab, "the wizard's seat with a proposal");
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_wizard_clicks_on_a_thing_in_the_picture_and_the_robot_does_what_is_chosen() {
    let (play, seat) = play(&["--wizard", "yes"]);
    let browser = Browser::start().unwrap();
    let mut tab = sit_down(&browser, &seat);
    let mut page = Page::open(play.authority()).unwrap();
    page.say("blorp the zargle").unwrap();
    tab.wait_until("window.cohabit.proposal?.kind === 'refusal'").unwrap();
    // Who reads nothing for a while is taken for gone.
    drop(page);
    click_on_a_thing(&mut tab);
    let focused = "document.querySelector('#menu button') === document.activeElement";
    assert_eq!(tab.evaluate(focused).unwrap(), json!(true), "the keyboard can choose at once");
    accessibility::check_here(&mut tab, "the menu of a thing");
    press(&mut tab, "ArrowDown");
    assert_eq!(tab.evaluate(focused).unwrap(), json!(false), "an arrow goes on to the next choice");
    // Escape closes the menu, and nothing else comes of it.
    press(&mut tab, "Escape");
    assert_eq!(tab.evaluate("document.querySelector('#menu').hidden").unwrap(), json!(true));
    assert_eq!(tab.evaluate("window.cohabit.proposal.is_decided").unwrap(), json!(false));

    click_on_a_thing(&mut tab);
    let mut page = Page::open(play.authority()).unwrap();
    page.wait("the greeting", |_, message| message["type"] == "hello").unwrap();
    let go_there = "(() => { const all = [...document.querySelectorAll('#menu button')]; \
        const box = all.find((one) => one.textContent.startsWith('Go there')).getBoundingClientRect(); \
        return [box.x + box.width / 2, box.y + box.height / 2]; })()";
    let place = numbers(&tab.evaluate(go_there).unwrap());
    click(&mut tab, place);
    page.wait("a step of the plan", |_, message| message["type"] == "progress").unwrap();
    page.wait("its end", |_, message| message["type"] == "turn" && message["ended"] == true).unwrap();
    tab.wait_until("window.cohabit.proposal === null").unwrap();
    assert_eq!(tab.evaluate("document.querySelector('#problem').textContent").unwrap(), json!(""));
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((page, tab, browser));
    let ended = play.end().unwrap();
    let log = Log::open(&ended.log).unwrap();
    let decisions: Vec<WizardDecision> = log.dialog.iter().filter_map(WizardDecision::of).collect();
    let [decision] = &decisions[..] else { panic!("not one decision: {decisions:#?}") };
    assert_eq!((decision.outcome, decision.said.as_str()), (DecisionOutcome::Replaced, "blorp the zargle"));
    assert_eq!(decision.clicked.as_deref(), Some("go_to"));
    assert!(decision.object.is_some() && decision.chosen_ms.is_some(), "{decision:?}");
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn what_one_robot_proposes_is_shown_while_the_other_ones_answer_is_delayed() {
    let robots = ["--body", "robot@BreakRoom", "--agent", "dialog", "--agent", "dialog@1", "--name", "0=Rosie"];
    let seat = ["--name", "1=Bob", "--wizard", "yes", "--response-delay-ms", "60000"];
    let (play, seat) = play(&[&robots[..], &seat[..]].concat());
    let browser = Browser::start().unwrap();
    let mut tab = sit_down(&browser, &seat);
    let mut page = Page::open(play.authority()).unwrap();
    page.say("Rosie, go to the main office").unwrap();
    tab.wait_until("window.cohabit.proposal?.body === 0").unwrap();
    press(&mut tab, "Enter");
    tab.wait_until("window.cohabit.proposal?.is_decided").unwrap();
    page.say("Bob, go to the reception").unwrap();
    tab.wait_until("window.cohabit.proposal?.body === 1 && !window.cohabit.proposal.is_decided").unwrap();
    drop(page);
    let answers = "document.querySelectorAll('#chat .from-robot').length";
    assert_eq!(tab.evaluate(answers).unwrap(), json!(0), "Rosie's answer is still to come");
    drop((tab, browser));
    play.end().unwrap();
}

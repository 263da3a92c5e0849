//! A study with a wizard in one condition: the wizard's page leads to the seat, and participants' pages are the same.

use std::{
    thread,
    time::{Duration, Instant},
};

use cohabit_tests::{Browser, Page, run};
use serde_json::{Value, json};

use super::{Person, STUDY, Server, WATCHDOG, pages::heading, study};
use crate::{COHABIT, accessibility};

const WIZARD: &str = r#"
[wizard]
timeout_s = 30
on_timeout = "act"

[[wizard.phrase]]
key = "h"
text = "Hello!"
"#;

/// The study in which a wizard takes part at one level of the factor within participants.
fn with_wizard() -> String {
    let study = STUDY.replace("settings = { ask = \"always\" }", "settings = { ask = \"never\", wizard = \"yes\" }");
    assert_ne!(study, STUDY);
    format!("{study}\n{WIZARD}")
}

fn keys(value: &Value) -> Vec<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn the_wizards_page_leads_to_the_seat_and_participants_see_no_difference() {
    let scratch = study("study-wizard");
    let _ = scratch.write("study.toml", &with_wizard());
    let server = Server::start(&scratch, "0");
    let overview = server.get(&format!("{}/state", server.experimenter));
    let wizard = overview["wizard"].as_str().unwrap().to_owned();
    for wrong in [format!("{wizard}0"), server.experimenter.replace("experimenter", "wizard")] {
        let (head, _) = server.request("GET", &wrong, "");
        assert!(head.starts_with("HTTP/1.1 404"), "{head}");
    }
    let person = Person::sign_up(&server);
    person.agree(&server);
    let mut shown = Vec::new();
    for _ in 0..2 {
        person.tell(&server, &json!("goes_on"));
        let state = person.wait_for(&server, "mission");
        shown.push((keys(&state), keys(&state["session"])));
        let sessions = server.get(&format!("{wizard}/state"))["sessions"].clone();
        let now = server.get(&format!("{}/state", server.experimenter))["participants"][0]["now"].clone();
        let has_wizard = now.as_str().unwrap().contains("ask=always");
        assert_eq!(sessions.as_array().unwrap().len(), usize::from(has_wizard), "{sessions} {now}");
        if has_wizard {
            let seat = &sessions[0];
            assert_eq!(seat["participant"], "P01");
            let authority = format!("127.0.0.1:{}/?token={}", seat["port"], seat["token"].as_str().unwrap());
            let overview = || server.get(&format!("{}/state", server.experimenter));
            let wait_for_alarm = |expected: bool| {
                let deadline = Instant::now() + WATCHDOG;
                while overview()["participants"][0]["lacks_wizard"] != expected {
                    assert!(Instant::now() < deadline, "the alarm is not {expected}");
                    thread::park_timeout(Duration::from_millis(50));
                }
            };
            wait_for_alarm(true);
            let mut page = person.session(&server);
            let mut seat = Page::open(&authority).unwrap();
            wait_for_alarm(false);
            page.say("go to the main office").unwrap();
            let told = seat.wait("a proposal", |_, message| message["proposal"]["is_decided"] == false).unwrap();
            let accept =
                json!({ "type": "accept", "turn": told["proposal"]["turn"], "revision": told["proposal"]["revision"] });
            seat.send(&json!({ "type": "decide", "decision": accept })).unwrap();
            page.wait("the main office", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
        }
        person.skip(&server);
    }
    assert_eq!(shown[0], shown[1]);
    server.end();
    let (data, out) = (scratch.path("data"), scratch.path("tables"));
    let exported = run(COHABIT, &["study", "export", "--folder", &data, "--out", &out]).unwrap();
    assert!(exported.status.success(), "{exported:?}");
    let decisions = std::fs::read_to_string(format!("{out}/decisions.csv")).unwrap();
    assert!(decisions.contains("accepted,false,false,go to the main office,plan"), "{decisions}");
    assert!(decisions.lines().next().unwrap().contains("factor_ask"), "{decisions}");
    let sheet = run(COHABIT, &["study", "report", "--folder", &data]).unwrap();
    let sheet = String::from_utf8_lossy(&sheet.stdout).into_owned();
    assert!(sheet.contains("Of 1 decision, 0 were interventions"), "{sheet}");
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_wizards_page() {
    let scratch = study("study-wizard-page");
    let _ = scratch.write("study.toml", &with_wizard());
    let server = Server::start(&scratch, "0");
    let wizard = server.get(&format!("{}/state", server.experimenter))["wizard"].as_str().unwrap().to_owned();
    let browser = Browser::start().unwrap();
    let mut tab = browser.open(&format!("http://{}{wizard}", server.host), 1280, 800).unwrap();
    tab.wait_until(&heading("A short study")).unwrap();
    accessibility::check(&mut tab, "the wizard's page while no session has a wizard");
    let person = Person::sign_up(&server);
    person.agree(&server);
    let has_seat =
        || server.get(&format!("{wizard}/state"))["sessions"].as_array().is_some_and(|sessions| !sessions.is_empty());
    let play = || {
        person.tell(&server, &json!("goes_on"));
        person.wait_for(&server, "mission");
    };
    play();
    // The wizard takes part in one of the two missions.
    if !has_seat() {
        person.skip(&server);
        play();
    }
    assert!(has_seat());
    tab.wait_until("document.querySelector('iframe.session') !== null").unwrap();
    accessibility::check(&mut tab, "the wizard's page with a seat");
    drop((tab, browser));
    server.end();
}

//! Two participants in one session, each at their own page, whatever is reloaded and killed.

use std::fs;

use cohabit_tests::{Browser, Page, Tab, run};
use rustix::process::Signal;
use serde_json::{Value, json};

use super::{
    Person, STUDY, Server, asked_of, conditions,
    pages::{go_on, heading},
    study,
};
use crate::{COHABIT, accessibility};

/// What is said to the robot in the study's first mission until that is complete.
const COLD_SODA: &str = include_str!("../../../cdf/missions/cold_soda.script");

/// The study in pairs, each with an avatar of their own.
fn in_pairs() -> String {
    let pairs = STUDY.replacen("participants = 4\n", "participants = 4\nparticipants_per_session = 2\n", 1).replacen(
        "understanding = \"fast\"\n",
        "understanding = \"fast\"\nbody = [\"person\", \"person\"]\n",
        1,
    );
    format!("{pairs}\n[pair]\npartner_absent = \"alone\"\nskip = \"both\"\n")
}

/// Somebody signs up in a browser, agrees, and wants to begin the first mission.
fn begin(browser: &Browser, server: &Server) -> Tab {
    let mut tab = browser.open(&format!("http://{}{}", server.host, server.sign_up), 1280, 800).unwrap();
    go_on(&mut tab, "I have read this");
    tab.wait_until("document.querySelectorAll('.check input:required').length === 2").unwrap();
    tab.evaluate("document.querySelectorAll('.check input:required').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "I agree to take part");
    go_on(&mut tab, "Begin");
    tab
}

/// The address of the session's page within somebody's page, once it is another one than that.
fn session(tab: &mut Tab, before: &str) -> String {
    let frame = "document.querySelector('iframe.session')";
    tab.wait_until(&format!("{frame} !== null && {frame}.src !== '{before}'")).unwrap();
    tab.evaluate(&format!("{frame}.src")).unwrap().as_str().unwrap().to_owned()
}

/// The same page by itself, and what it is told of who has it.
fn open(address: &str) -> (Page, Value) {
    let mut page = Page::open(address.split_once("://").unwrap().1).unwrap();
    let you = page.wait("whose page it is", |_, message| message["type"] == "you").unwrap();
    (page, you)
}

/// Somebody wants to skip the mission, and means it.
fn skip(tab: &mut Tab) {
    tab.wait_until("document.querySelector('.offer')?.hidden === false").unwrap();
    tab.evaluate("document.querySelector('#skip').click()").unwrap();
    tab.wait_until("document.querySelector('#skip-card').open && !document.querySelector('#skip-pair').hidden")
        .unwrap();
    tab.evaluate("document.querySelector('#skip-now').click()").unwrap();
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_pair_plays_one_mission_together_and_ends_in_the_same_condition() {
    let scratch = study("study-pairs");
    let _ = scratch.write("study.toml", &in_pairs());
    let server = Server::start(&scratch, "0");
    let browser = Browser::start().unwrap();
    // Who is ready waits for the other one.
    let mut ana = begin(&browser, &server);
    ana.wait_until(&heading("Please wait for your partner")).unwrap();
    accessibility::check(&mut ana, "the page of who waits for a partner");
    let mut ben = begin(&browser, &server);
    let addresses = [session(&mut ana, ""), session(&mut ben, "")];
    let site = |address: &str| address.split_once("/?").unwrap().0.to_owned();
    assert_eq!(site(&addresses[0]), site(&addresses[1]), "one session");
    assert_ne!(addresses[0], addresses[1], "each with a token of their own");
    let assigned = conditions(&server);
    assert_eq!(assigned[0], assigned[1]);

    // Each has a number and an avatar, and hears what the other one says. Who reads nothing for long is let go, so one comes after the other.
    let (mut anas, you) = open(&addresses[0]);
    assert_eq!((&you["visitor"], &you["seat"]["body"]), (&json!(1), &json!(1)));
    anas.do_and_wait("go to the main office").unwrap();
    anas.do_and_wait("yes").unwrap();
    anas.wait("the main office", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
    let (mut bens, you) = open(&addresses[1]);
    assert_eq!((&you["visitor"], &you["seat"]["body"]), (&json!(2), &json!(2)));
    bens.send(&json!({ "type": "drive_body", "body": 1 })).unwrap();
    bens.wait("that it is not his", |_, message| {
        message["type"] == "error" && message["text"].as_str().is_some_and(|text| text.contains("your own avatar"))
    })
    .unwrap();
    bens.send(&json!({ "type": "drive_body", "body": 2 })).unwrap();
    bens.wait("his avatar", |_, message| message["type"] == "driving" && message["body"] == 2).unwrap();
    bens.wait("what she said", |page, _| page.chat.iter().any(|(_, text)| text == "go to the main office")).unwrap();
    bens.say("turn right").unwrap();
    anas.wait("what he said", |_, message| message["visitor"] == 2).unwrap();
    drop((anas, bens));

    // A reload changes nothing.
    ben.call("Page.reload", &json!({})).unwrap();
    assert_eq!(session(&mut ben, ""), addresses[1]);

    // The server is killed, and with it the session: the next one goes on with both.
    let port = server.port().to_owned();
    server.signal(Signal::KILL);
    drop(server);
    let server = Server::start(&scratch, &port);
    let again = [session(&mut ana, &addresses[0]), session(&mut ben, &addresses[1])];
    assert_eq!(site(&again[0]), site(&again[1]));
    assert_eq!(conditions(&server), assigned);
    let (mut bens, you) = open(&again[1]);
    assert_eq!((&you["visitor"], &you["seat"]["body"]), (&json!(2), &json!(2)));
    bens.wait("where the robot is", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
    drop(bens);

    // One wants to skip, and the other one agrees.
    skip(&mut ana);
    ana.wait_until("document.querySelector('.wish').textContent.includes('once your partner agrees')").unwrap();
    ben.wait_until("document.querySelector('.wish')?.textContent.includes('once you agree')").unwrap();
    accessibility::check(&mut ben, "a mission that a partner would like to skip");
    skip(&mut ben);
    for tab in [&mut ana, &mut ben] {
        tab.wait_until("document.querySelectorAll('.item').length === 2").unwrap();
    }
    // Each answers by themselves, and the next mission waits for both.
    for (tab, place) in [(&mut ana, 1), (&mut ben, 3)] {
        tab.evaluate(&format!("document.querySelectorAll('.places input')[{place}].click()")).unwrap();
        go_on(tab, "Send and go on");
        tab.wait_until(&heading("Your next mission")).unwrap();
    }
    assert_eq!(conditions(&server), conditions_of_both(&server));
    let mut lab = browser.open(&format!("http://{}{}", server.host, server.experimenter), 1280, 800).unwrap();
    lab.wait_until("document.querySelectorAll('#rows tr td')[0]?.textContent === 'pair01, seat 1'").unwrap();
    accessibility::check(&mut lab, "the experimenter's page with a pair");
    let problems = ana.problems().iter().chain(ben.problems()).chain(lab.problems());
    // While no server was there, pages said that they could not reach it.
    let expected = ["Blocked autofocusing", "Failed to load resource", "WebSocket connection"];
    let problems: Vec<_> = problems.filter(|one| !expected.iter().any(|begin| one.starts_with(begin))).collect();
    assert_eq!(problems, [] as [&str; 0]);
    drop((ana, ben, lab, browser));
    server.end();

    let (data, out) = (scratch.path("data"), scratch.path("tables"));
    let exported = run(COHABIT, &["study", "export", "--folder", &data, "--out", &out]).unwrap();
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    let read = |name: &str| fs::read_to_string(format!("{out}/{name}.csv")).unwrap();
    for (name, rows) in [("participants", 2), ("missions", 2), ("answers", 2)] {
        let table = read(name);
        assert_eq!(table.lines().count(), 1 + rows, "{table}");
        assert!(table.lines().next().unwrap().contains("participant,") && table.contains(",pair01,1,"), "{table}");
        assert!(table.contains(",pair01,2,"), "{table}");
    }
    let sessions = read("sessions");
    let names: Vec<&str> = sessions.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(names, ["pair01-01-1", "pair01-01-2"], "one row a session of both: {sessions}");
    let asked: Vec<String> = names.iter().map(|name| asked_of(&format!("{data}/logs/{name}.mcap"))).collect();
    assert_eq!(asked[0], asked[1]);
    let turns = read("turns");
    assert!(turns.lines().next().unwrap().contains(",pair,seat,"), "{turns}");
    assert!(
        turns.contains("go to the main office") && turns.contains(",pair01,1,") && turns.contains(",pair01,2,"),
        "{turns}"
    );
    let sheet = run(COHABIT, &["study", "report", "--folder", &data]).unwrap();
    let sheet = String::from_utf8_lossy(&sheet.stdout).into_owned();
    assert!(sheet.contains("They took part in 1 pair: 0 finished together"), "{sheet}");

    // Who withdraws takes the sessions along.
    let done = run(COHABIT, &["study", "withdraw", "P01", "--folder", &data]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(fs::read_dir(format!("{data}/logs")).unwrap().count(), 0);
    let noted = fs::read_to_string(format!("{data}/withdrawn.jsonl")).unwrap();
    assert!(noted.contains("\"participant\":\"P01\"") && noted.contains("\"pair\":\"pair01\""), "{noted}");
    assert!(fs::exists(format!("{data}/journals/P02.jsonl")).unwrap(), "the other one's answers stay");
}

#[test]
fn a_mission_that_one_of_a_pair_completes_is_over_for_both() {
    let scratch = study("study-pairs-complete");
    // Whatever level comes first, the robot does what is said without asking.
    let _ = scratch.write("study.toml", &in_pairs().replace("ask = \"always\"", "ask = \"unsure\""));
    let server = Server::start(&scratch, "0");
    let pair = [Person::sign_up(&server), Person::sign_up(&server)];
    for person in &pair {
        person.agree(&server);
        person.tell(&server, &json!("goes_on"));
    }
    let tokens = pair.each_ref().map(|person| person.wait_for(&server, "mission")["session"]["token"].clone());
    assert_ne!(tokens[0], tokens[1], "each has a page of their own");
    let mut page = pair[0].session(&server);
    let sentences: Vec<&str> = COLD_SODA.lines().collect();
    let [before @ .., last] = &sentences[..] else { panic!("an empty script") };
    for sentence in before {
        page.do_and_wait(sentence).unwrap();
    }
    // The session may end before the page is told that the turn has.
    page.say(last).unwrap();
    for person in &pair {
        person.wait_for(&server, "questionnaire");
    }
    drop(page);
    for person in &pair {
        let answers = json!([{ "value": 3 }, null]);
        let told = person.tell(&server, &json!({ "answered": { "questionnaire": "short", "answers": answers } }));
        assert_eq!(told["page"], "ready", "{told}");
    }
    server.end();

    let (data, out) = (scratch.path("data"), scratch.path("tables"));
    let exported = run(COHABIT, &["study", "export", "--folder", &data, "--out", &out]).unwrap();
    assert!(exported.status.success(), "{}", String::from_utf8_lossy(&exported.stderr));
    let missions = fs::read_to_string(format!("{out}/missions.csv")).unwrap();
    let complete: Vec<&str> = missions.lines().skip(1).filter(|row| row.contains(",complete,")).collect();
    assert!(complete.len() == 2 && complete.iter().all(|row| row.contains("pair01-01-1")), "{missions}");
}

/// The conditions of the first one, twice: both of a pair have the same.
fn conditions_of_both(server: &Server) -> Vec<[String; 3]> {
    let first = conditions(server)[0].clone();
    vec![first.clone(), first]
}

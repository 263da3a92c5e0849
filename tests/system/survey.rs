//! Questionnaires: asked on the page, answered once, recorded, and told in tables.

use std::fs;

use cohabit_record::Log;
use cohabit_tests::{Browser, Page, Play, Scratch, run};
use rustix::process::Signal;
use serde_json::{Value, json};

use crate::COHABIT;

const AFTER: &str = r#"
title = "Your robot"

[[item]]
ask = "Which did you like?"
choice = ["its voice", "its manners"]

[[item]]
ask = "What would you change?"
words = true
optional = true
"#;

/// What comes of the answers of a person who says that they have finished.
fn answer(page: &mut Page, questionnaire: &str, answers: &Value) -> Value {
    let finished = json!({ "type": "answer", "questionnaire": questionnaire, "answers": answers, "finished": true });
    page.send(&finished).unwrap();
    page.wait("what comes of the answers", |_, message| message["type"] == "answered").unwrap()["problem"].clone()
}

#[test]
fn questionnaires_are_answered_recorded_and_scored() {
    let scratch = Scratch::new("survey");
    let file = scratch.write("after.toml", AFTER);
    let play = Play::start(COHABIT, &["--questionnaire", "sus", "--questionnaire", &file]).unwrap();
    let mut page = Page::open_as(play.authority(), 7).unwrap();
    let hello = page.wait("the greeting", |_, message| message["type"] == "hello").unwrap();
    let names: Vec<_> = hello["questionnaires"].as_array().unwrap().iter().map(|one| one["name"].clone()).collect();
    assert_eq!(names, ["sus", "after"]);
    let scale = |value: i32| json!({ "value": value });
    let mut sus: Vec<Value> = [4, 2, 4, 2, 4, 2, 4, 2, 4].map(scale).into();
    assert_eq!(answer(&mut page, "sus", &json!(sus)), "9 answers to 10 questions.");
    sus.push(scale(6));
    assert_eq!(answer(&mut page, "sus", &json!(sus)), "Question 10 has no answer yet.");
    sus[9] = scale(5);
    assert_eq!(answer(&mut page, "sus", &json!(sus)), Value::Null);
    // What was answered is known to a service that takes a dead one's place.
    play.send("dialog", Signal::KILL).unwrap();
    let mut again = Page::once_served(|| Page::open_as(play.authority(), 7)).unwrap();
    let you = again.wait("who it is", |_, message| message["type"] == "you").unwrap();
    assert_eq!((&you["visitor"], &you["answered"]), (&json!(1), &json!(["sus"])));
    assert_eq!(answer(&mut again, "after", &json!([scale(2), { "text": " Less talk. " }])), Value::Null);
    // Once each: the first answers count.
    let already = "You have answered this already; your first answers count.";
    assert_eq!(answer(&mut again, "after", &json!([scale(1), null])), already);
    assert_eq!(answer(&mut again, "sus", &json!(sus)), already);
    // The longest text is kept whole in any script.
    let mut other = Page::open_as(play.authority(), 8).unwrap();
    let long = |letters: usize| json!([scale(1), { "text": "я".repeat(letters) }]);
    assert_eq!(answer(&mut other, "after", &long(2001)), "Question 2: It has 2001 characters; 2000 at most, please.");
    assert_eq!(answer(&mut other, "after", &long(2000)), Value::Null);
    let play = play.end().unwrap();

    let log = Log::open(&play.log).unwrap();
    assert_eq!(log.problems(), [] as [&str; 0]);
    assert_eq!(log.session.settings["questionnaires"], "sus after");
    assert_eq!(log.answers.len(), 14);
    assert_eq!(log.answers[13].text, "я".repeat(2000));
    let (log, tables) = (play.log.to_str().unwrap(), scratch.path("tables"));
    let done = run(COHABIT, &["export", log, "--out", &tables, "--summary"]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let printed = String::from_utf8_lossy(&done.stdout).into_owned();
    // By Brooke: 2.5 times the sum of what is above 1, or below 5 where it is reversed.
    assert!(printed.contains("sus score") && printed.contains("67.5"), "{printed}");
    let rows = fs::read_to_string(format!("{tables}/questionnaires.csv")).unwrap();
    assert_eq!(rows.lines().count(), 15, "{rows}");
    assert!(rows.contains("its manners") && rows.contains("Less talk."), "{rows}");
}

#[test]
fn what_is_asked_afterwards_is_not_answered_during_the_mission() {
    let play = Play::start(COHABIT, &["cold_soda", "--seed", "5", "--questionnaire", "sus"]).unwrap();
    let sus = json!([3, 3, 3, 3, 3, 3, 3, 3, 3, 3].map(|value| json!({ "value": value })));
    let mut early = Page::open_as(play.authority(), 7).unwrap();
    early.wait("the mission", |page, _| page.state["goals"].as_array().is_some_and(|goals| !goals.is_empty())).unwrap();
    early.send(&json!({ "type": "answer", "questionnaire": "sus", "answers": sus })).unwrap();
    let told = early.wait("what comes of it", |_, message| message["type"] == "answered").unwrap();
    assert_eq!(told["problem"], "The mission is not over yet: this is asked afterwards.");
    // Who has done what they could says so.
    assert_eq!(answer(&mut early, "sus", &sus), Value::Null);
    let play = play.end().unwrap();
    assert_eq!(Log::open(&play.log).unwrap().answers.len(), 10);
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_who_has_finished_says_so_on_the_page() {
    let browser = Browser::start().unwrap();
    let scratch = Scratch::new("survey-page");
    let file = scratch.write("after.toml", AFTER);
    let play = Play::start(COHABIT, &["cold_soda", "--seed", "5", "--questionnaire", &file]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    let button = "document.querySelector('#survey-open')";
    tab.wait_until(&format!("window.cohabit?.frames > 0 && {button}.textContent === 'I have finished'")).unwrap();
    tab.evaluate(&format!("window.confirm = () => true; {button}.click()")).unwrap();
    let fill = "document.querySelector('#survey input[type=radio]').checked = true; \
        document.querySelector('#survey textarea').value = 'я'.repeat(2001)";
    tab.evaluate(fill).unwrap();
    tab.evaluate("document.querySelector('#survey-send').click()").unwrap();
    tab.wait_until("document.querySelector('#survey-problem').textContent.includes('2001 characters; 2000 at most')")
        .unwrap();
    tab.evaluate("document.querySelector('#survey textarea').value = 'я'.repeat(2000)").unwrap();
    tab.evaluate("document.querySelector('#survey-send').click()").unwrap();
    tab.wait_until(&format!("{button}.hidden && !document.querySelector('#survey').open")).unwrap();
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((tab, browser));
    let play = play.end().unwrap();
    assert_eq!(Log::open(&play.log).unwrap().answers[1].text.chars().count(), 2000);
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn what_was_filled_in_is_kept_when_a_person_puts_it_off() {
    let browser = Browser::start().unwrap();
    let scratch = Scratch::new("survey-later");
    let file = scratch.write("after.toml", AFTER);
    let play = Play::start(COHABIT, &["cold_soda", "--seed", "5", "--questionnaire", &file]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    let button = "document.querySelector('#survey-open')";
    tab.wait_until(&format!("window.cohabit?.frames > 0 && {button}.textContent === 'I have finished'")).unwrap();
    tab.evaluate(&format!("window.confirm = () => true; {button}.click()")).unwrap();
    let fill = "document.querySelector('#survey input[type=radio]').checked = true; \
        document.querySelector('#survey textarea').value = 'Less talk.'";
    tab.evaluate(fill).unwrap();
    tab.evaluate("document.querySelector('#survey-later').click()").unwrap();
    tab.wait_until("!document.querySelector('#survey').open").unwrap();
    tab.evaluate(&format!("{button}.click()")).unwrap();
    tab.wait_until("document.querySelector('#survey').open").unwrap();
    let kept = "[document.querySelector('#survey input[type=radio]').checked, \
        document.querySelector('#survey textarea').value]";
    assert_eq!(tab.evaluate(kept).unwrap(), json!([true, "Less talk."]));
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
fn what_cannot_be_asked_is_said_before_anything_starts() {
    let scratch = Scratch::new("survey-refused");
    let wrong = scratch.write("wrong.toml", "title = \"T\"\n[[item]]\nask = \"How?\"\n");
    for (arguments, part) in [
        (["--questionnaire", "none-such"].to_vec(), "sus, tlx"),
        (["--questionnaire", &wrong].to_vec(), "item 1: it has no `scale`"),
        (["--questionnaire", "sus", "--questionnaire", "sus"].to_vec(), "two are called `sus`"),
    ] {
        let output = run(COHABIT, &[&["play"][..], &arguments].concat()).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}

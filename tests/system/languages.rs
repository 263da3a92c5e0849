//! The page in other languages than English.

use std::fs;

use cohabit_tests::{Browser, Play, Scratch, run};
use serde_json::json;

use crate::{COHABIT, accessibility};

const GERMAN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../dialog/web/texts/de.toml");

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_german_page_is_german_and_says_that_the_robot_speaks_english() {
    let browser = Browser::start().unwrap();
    let german = ["cold_soda", "--seed", "5", "--page-language", "de", "--body", "person"];
    let play = Play::start(COHABIT, &german).unwrap();
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && document.querySelector('#goals-list li') !== null").unwrap();
    assert_eq!(tab.evaluate("document.documentElement.lang").unwrap(), json!("de"));
    for (what, text) in [
        ("#walk-in span", "Mitgehen"),
        ("#stop span", "Roboter anhalten"),
        ("#link-text", "verbunden"),
        ("#doing-text", "Bereit"),
        (".fact-score dt", "Punkte"),
        ("#holding", "Nichts"),
    ] {
        tab.wait_until(&format!("document.querySelector('{what}').textContent === '{text}'")).unwrap();
    }
    let notice = "document.querySelector('.robot-language').innerText.includes('nur Englisch')";
    assert_eq!(tab.evaluate(notice).unwrap(), json!(true));
    // What is said is English, and is told to be.
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("what is left?").unwrap();
    tab.wait_until("document.querySelectorAll('#chat .from-robot').length > 0").unwrap();
    let spoken = "[...document.querySelectorAll('#chat .line-text, #chips button, #goals-list li > span:not(.unseen)')] \
        .every((one) => one.lang === 'en')";
    assert_eq!(tab.evaluate(spoken).unwrap(), json!(true));
    accessibility::check(&mut tab, "a German page");
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_lab_writes_the_texts_of_the_page_itself() {
    let scratch = Scratch::new("languages-own");
    let own = fs::read_to_string(GERMAN).unwrap().replacen("\"de\"", "\"gsw\"", 1);
    let file = scratch.write("own.toml", &own.replacen("walk_in = \"Mitgehen\"", "walk_in = \"Mitlaufe <b>\"", 1));
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["--page-texts", &file, "--body", "person"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("window.cohabit?.frames > 0").unwrap();
    assert_eq!(tab.evaluate("document.documentElement.lang").unwrap(), json!("gsw"));
    assert_eq!(tab.evaluate("document.querySelector('#walk-in span').textContent").unwrap(), json!("Mitlaufe <b>"));
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
fn what_is_missing_in_texts_is_said_before_anything_starts() {
    let scratch = Scratch::new("languages-refused");
    let german = fs::read_to_string(GERMAN).unwrap();
    let lacking = scratch.write("lacking.toml", &german.replacen("walk_in = \"Mitgehen\"\n", "", 1));
    let surplus = scratch.write("surplus.toml", &german.replacen("walk_in = ", "walkin = ", 1));
    for (arguments, part) in [
        (["--page-language", "tlh"].to_vec(), "choose en, de, es"),
        (["--page-texts", &lacking].to_vec(), "lacking.toml: `[session]` has no `walk_in`; add it with a translation"),
        (["--page-texts", &surplus].to_vec(), "`walkin` is no key of `[session]`; leave it out"),
        (["--page-texts", "/nowhere.toml"].to_vec(), "/nowhere.toml: "),
        (["--page-language", "de", "--page-texts", &lacking].to_vec(), "cannot be used with"),
    ] {
        let output = run(COHABIT, &[&["play"][..], &arguments].concat()).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(part), "no `{part}` in {text}");
    }
}

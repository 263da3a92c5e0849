//! The pages of a study that people see in passing, or where something is not as planned, can be used by everybody.

use cohabit_tests::{Browser, Tab};
use serde_json::json;

use super::{
    Person, STUDY, Server,
    pages::{go_on, heading},
    study,
};
use crate::accessibility;

/// The block of missions, and a tutorial that comes before it.
const MISSIONS: &str = "[[block]]\nkind = \"missions\"\n";
const TUTORIAL: &str = "[[block]]\nkind = \"tutorial\"\nmission = \"laser_lab\"\nskip_after_minutes = 0.01\n\n";

/// A page of a study on a phone.
fn open(browser: &Browser, server: &Server, path: &str) -> Tab {
    browser.open(&format!("http://{}{path}", server.host), 390, 844).unwrap()
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_pages_of_who_does_not_agree_who_waits_and_who_is_excluded() {
    let scratch = study("study-accessible");
    let server = Server::start(&scratch, "0");
    let browser = Browser::start().unwrap();
    let mut stranger = open(&browser, &server, "/p/unknown");
    stranger.wait_until(&heading("This link is not known")).unwrap();
    accessibility::check(&mut stranger, "a link that no participant has");
    // There are two sessions at a time, and both are taken.
    let people = [Person::sign_up(&server), Person::sign_up(&server)];
    for person in &people {
        person.agree(&server);
        person.tell(&server, &json!("goes_on"));
        person.wait_for(&server, "mission");
    }

    let mut tab = open(&browser, &server, &server.sign_up);
    go_on(&mut tab, "I have read this");
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    tab.evaluate("document.querySelector('.consent .quiet').click()").unwrap();
    tab.wait_until(&heading("You do not take part")).unwrap();
    accessibility::check(&mut tab, "the page of who does not agree");
    tab.evaluate("document.querySelector('#content .quiet').click()").unwrap();
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    // A browser that checks nothing leaves it to the server.
    tab.evaluate("{ const form = document.querySelector('.consent'); form.noValidate = true; form.requestSubmit(); }")
        .unwrap();
    tab.wait_until("document.querySelector('.consent .problem').textContent.startsWith('Please tick all boxes')")
        .unwrap();
    accessibility::check(&mut tab, "a consent form that lacks a tick");
    tab.evaluate("document.querySelectorAll('.check input:required').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "I agree to take part");
    tab.wait_until(&heading("Your next mission")).unwrap();
    accessibility::check(&mut tab, "the page before a mission");
    go_on(&mut tab, "Begin");
    tab.wait_until(&heading("Please wait")).unwrap();
    accessibility::check(&mut tab, "the page of who waits for a session");

    let overview = server.get(&format!("{}/state", server.experimenter));
    let mut rows = overview["participants"].as_array().unwrap().iter();
    let waiting = rows.find(|row| row["progress"] == "waiting").unwrap();
    let exclude = json!({ "participant": waiting["participant"], "reason": "there is no time left" });
    server.order(&json!({ "exclude": exclude }));
    tab.wait_until(&heading("The study ends here for you")).unwrap();
    accessibility::check(&mut tab, "the page of who is excluded");
    drop((tab, stranger, browser));
    server.end();
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_a_tutorial_a_break_and_the_last_page() {
    let scratch = study("study-tutorial");
    let with_tutorial = STUDY.replacen(MISSIONS, &format!("{TUTORIAL}{MISSIONS}"), 1);
    let _ = scratch.write("study.toml", &with_tutorial);
    let server = Server::start(&scratch, "0");
    let person = Person::sign_up(&server);
    person.agree(&server);
    person.tell(&server, &json!("goes_on"));
    let browser = Browser::start().unwrap();
    let mut tab = open(&browser, &server, &person.link);
    tab.wait_until("document.querySelectorAll('.exercises li').length > 2").unwrap();
    accessibility::check(&mut tab, "a tutorial");
    go_on(&mut tab, "Go on");
    tab.wait_until(&heading("Your next mission")).unwrap();
    for _ in 0..2 {
        person.tell(&server, &json!("goes_on"));
        person.wait_for(&server, "mission");
        person.skip(&server);
    }
    tab.wait_until(&heading("A break")).unwrap();
    accessibility::check(&mut tab, "a break");
    go_on(&mut tab, "Go on now");
    tab.wait_until(&heading("Thank you")).unwrap();
    accessibility::check(&mut tab, "the last page");
    drop((tab, browser));
    server.end();
}

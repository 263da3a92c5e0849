//! The pages of a study in a browser.

use std::fs;

use cohabit_tests::{Browser, Tab};
use serde_json::{Value, json};

use super::{STUDY, Server, study};
use crate::accessibility;

/// Clicks the chief button of the page, once it is there.
pub fn go_on(tab: &mut Tab, text: &str) {
    let button =
        format!("[...document.querySelectorAll('#content button.chief')].find((one) => one.textContent === '{text}')");
    tab.wait_until(&format!("{button} !== undefined && !{button}.disabled")).unwrap();
    tab.evaluate(&format!("{button}.click()")).unwrap();
}

/// Whether the page has that heading.
pub fn heading(text: &str) -> String {
    format!("document.querySelector('h1')?.textContent === '{text}'")
}

/// The page of a session, which is within the study's, by itself: what participants see of it on a phone.
fn look_at_session(browser: &Browser, address: &Value) {
    let mut tab = browser.open(address.as_str().unwrap(), 390, 740).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && document.querySelector('#goals-list li') !== null").unwrap();
    let is_shown = |what: &str| format!("(document.querySelector('{what}').checkVisibility())");
    for hidden in ["#score", "#fps", "#latency", "#session", "#mic", "#open-mic", ".by-voice"] {
        assert_eq!(tab.evaluate(&is_shown(hidden)).unwrap(), json!(false), "{hidden}");
    }
    assert_eq!(
        tab.evaluate("document.querySelector('#stop').innerText.split(/\\s+/).join(' ').trim()").unwrap(),
        json!("Stop the robot")
    );
    // The goals are one press away, above the conversation, and nothing covers them.
    assert_eq!(tab.evaluate(&is_shown("#goals-list li")).unwrap(), json!(false));
    let toggle = "document.querySelector('#goals-toggle')";
    let on_top = format!(
        "(() => {{ const box = {toggle}.getBoundingClientRect(); \
         return {toggle}.contains(document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2)); }})()"
    );
    assert_eq!(tab.evaluate(&on_top).unwrap(), json!(true));
    tab.evaluate(&format!("{toggle}.click()")).unwrap();
    tab.wait_until(&is_shown("#goals-list li")).unwrap();
    let above = "document.querySelector('#goals').getBoundingClientRect().bottom <= \
        document.querySelector('#chat').getBoundingClientRect().top + 1";
    assert_eq!(tab.evaluate(above).unwrap(), json!(true));
    assert_eq!(tab.evaluate("document.documentElement.scrollWidth <= 390").unwrap(), json!(true));
    accessibility::check(&mut tab, "what participants see of a session");
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_person_takes_part_in_a_browser() {
    let scratch = study("study-browser");
    let probe = "[[probe]]\nquestionnaire = \"annoyed.toml\"\nat = \"minutes\"\nminutes = 0.01\n";
    let code = "[[code]]\nkey = \"t\"\ntext = \"thinks aloud\"\n";
    let _ = scratch.write("study.toml", &format!("{STUDY}\n{probe}\n{code}"));
    let server = Server::start(&scratch, "0");
    let browser = Browser::start().unwrap();
    let mut tab = browser.open(&format!("http://{}{}", server.host, server.sign_up), 390, 844).unwrap();
    tab.wait_until("document.querySelector('#content button.chief') !== null").unwrap();
    accessibility::check(&mut tab, "the information of a study");
    go_on(&mut tab, "I have read this");
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    accessibility::check(&mut tab, "the consent form");
    accessibility::check_keyboard(&mut tab, "the consent form");
    tab.wait_until("document.querySelectorAll('.check input:required').length === 2").unwrap();
    tab.evaluate("document.querySelectorAll('.check input:required').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "I agree to take part");
    go_on(&mut tab, "Begin");
    tab.wait_until("document.querySelector('iframe.session') !== null").unwrap();
    assert_eq!(tab.evaluate("document.documentElement.scrollWidth <= 390").unwrap(), json!(true));
    // The session's page is there within the study's: it says that it has shown a frame, and no policy forbade it.
    let may_skip = "document.querySelector('iframe.session') !== null && !document.querySelector('.offer').hidden";
    tab.wait_until(may_skip).unwrap();
    tab.call("Page.reload", &json!({})).unwrap();
    tab.wait_until(may_skip).unwrap();
    // No clock runs, and nobody who was not asked is heard.
    assert_eq!(tab.evaluate("document.querySelector('#bar-time').textContent").unwrap(), json!(""));
    assert_eq!(tab.evaluate("document.querySelector('iframe.session').allow").unwrap(), json!("autoplay"));
    look_at_session(&browser, &tab.evaluate("document.querySelector('iframe.session').src").unwrap());
    // A question in between is asked beside the mission, until it is answered.
    tab.wait_until("document.querySelector('.probe') !== null").unwrap();
    accessibility::check(&mut tab, "a mission with a question in between");
    tab.evaluate("document.querySelector('.probe .chief').click()").unwrap();
    tab.wait_until("document.querySelector('.probe .problem').textContent === 'Please answer the question.'").unwrap();
    accessibility::check(&mut tab, "a question in between that lacks an answer");
    tab.evaluate("document.querySelectorAll('.probe input')[2].click()").unwrap();
    tab.evaluate("document.querySelector('.probe .chief').click()").unwrap();
    tab.wait_until("document.querySelector('.probe') === null").unwrap();
    // The experimenter has the mission stand still, and tells the participant something.
    let mut lab = browser.open(&format!("http://{}{}", server.host, server.experimenter), 1280, 800).unwrap();
    let press = |text: &str| {
        format!("[...document.querySelectorAll('#rows button')].find((one) => one.textContent === '{text}').click()")
    };
    lab.wait_until("document.querySelector('#rows')?.textContent.includes('% of ticks late')").unwrap();
    lab.evaluate(&press("Pause")).unwrap();
    tab.wait_until("!document.querySelector('#paused').hidden").unwrap();
    lab.evaluate("prompt = () => 'Please take your time.'").unwrap();
    lab.evaluate(&press("Message")).unwrap();
    tab.wait_until("document.querySelector('#told-text').textContent.includes('Please take your time.')").unwrap();
    accessibility::check(&mut tab, "a mission that is paused, with a message");
    tab.evaluate("document.querySelector('#told-close').click()").unwrap();
    tab.wait_until("document.querySelector('#told').hidden").unwrap();
    lab.wait_until("document.querySelector('#rows').textContent.includes('Resume')").unwrap();
    lab.evaluate(&press("Resume")).unwrap();
    tab.wait_until("document.querySelector('#paused').hidden").unwrap();
    drop(lab);
    // To skip a mission is one thing, to leave the study another; each is asked about.
    assert_eq!(tab.evaluate("document.querySelector('#leave').textContent").unwrap(), json!("Leave the study"));
    assert_eq!(tab.evaluate("document.querySelector('#skip').textContent").unwrap(), json!("Skip this mission"));
    assert_eq!(tab.evaluate("document.querySelector('.bar #skip')").unwrap(), Value::Null);
    tab.evaluate("document.querySelector('#skip').click()").unwrap();
    tab.wait_until("document.querySelector('#skip-card').open").unwrap();
    accessibility::check(&mut tab, "the question whether to skip a mission");
    tab.evaluate("document.querySelector('#skip-now').click()").unwrap();
    tab.wait_until("document.querySelectorAll('.item').length === 2").unwrap();
    accessibility::check(&mut tab, "a questionnaire of a study");
    go_on(&mut tab, "Send and go on");
    tab.wait_until("document.querySelector('.problem').textContent === 'Question 1 has no answer yet.'").unwrap();
    assert_eq!(tab.evaluate("document.activeElement.type").unwrap(), json!("radio"));
    accessibility::check(&mut tab, "a questionnaire of a study that lacks an answer");
    accessibility::check_with_more_contrast(&mut tab, "a questionnaire of a study that lacks an answer");
    // Of two windows the newer one goes on, and the other one says so.
    let address = tab.evaluate("location.href").unwrap();
    let mut second = browser.open(address.as_str().unwrap(), 390, 844).unwrap();
    second.wait_until("document.querySelectorAll('.item').length === 2").unwrap();
    tab.wait_until(&heading("This study is open in another window")).unwrap();
    accessibility::check(&mut tab, "the page of who has opened another window");
    drop(second);
    go_on(&mut tab, "Go on here");
    tab.wait_until("document.querySelectorAll('.item').length === 2").unwrap();
    // What was filled in is there again after a reload, also what was typed a moment before.
    tab.evaluate("document.querySelectorAll('.places input')[3].click()").unwrap();
    let type_words = "const area = document.querySelector('textarea'); area.value = 'so far'; \
        area.dispatchEvent(new Event('input', { bubbles: true }))";
    tab.evaluate(&format!("{{ {type_words} }}")).unwrap();
    tab.call("Page.reload", &json!({})).unwrap();
    tab.wait_until("document.querySelector('textarea')?.value === 'so far'").unwrap();
    assert_eq!(tab.evaluate("document.querySelector('.places input:checked').value").unwrap(), json!("4"));
    go_on(&mut tab, "Send and go on");
    tab.wait_until("document.querySelector('h1').textContent === 'Your next mission'").unwrap();

    let mut lab = browser.open(&format!("http://{}{}", server.host, server.experimenter), 1280, 800).unwrap();
    lab.wait_until("document.querySelector('#rows tr td')?.textContent === 'ready'").unwrap();
    accessibility::check(&mut lab, "the experimenter's page");
    accessibility::check_keyboard(&mut lab, "the experimenter's page");
    let type_note = "document.querySelector('#note-text').focus()";
    lab.evaluate(type_note).unwrap();
    lab.type_and_enter("took her time").unwrap();
    lab.wait_until("document.querySelector('#notes li')?.textContent.includes('took her time')").unwrap();
    accessibility::check(&mut lab, "the experimenter's page with a note");
    accessibility::check_with_more_contrast(&mut lab, "the experimenter's page with a note");
    // A key notes a code about whom is chosen; in a field it is a letter.
    let choose = "document.activeElement.blur(); document.querySelector('#note-about').value = 'P01'";
    lab.evaluate(choose).unwrap();
    let press = "document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 't', bubbles: true }))";
    lab.evaluate(press).unwrap();
    lab.wait_until("document.querySelector('#notes li')?.textContent.endsWith('P01 thinks aloud')").unwrap();
    let type_letter =
        "document.querySelector('#note-text').dispatchEvent(new KeyboardEvent('keydown', { key: 't', bubbles: true }))";
    let notes = lab.evaluate("document.querySelectorAll('#notes li').length").unwrap();
    lab.evaluate(type_letter).unwrap();
    assert_eq!(lab.evaluate("document.querySelectorAll('#notes li').length").unwrap(), notes);

    // Who observes sees the same, and has no buttons.
    let observer = lab
        .evaluate("fetch(`${location.pathname}/state`).then((answer) => answer.json()).then((state) => state.observer)")
        .unwrap();
    let address = format!("http://{}{}", server.host, observer.as_str().unwrap());
    let mut observed = browser.open(&address, 1280, 800).unwrap();
    let has_note =
        "[...document.querySelectorAll('#notes li')].some((one) => one.textContent.includes('took her time'))";
    observed.wait_until(has_note).unwrap();
    let buttons = "[...document.querySelectorAll('button, input')].filter((one) => one.checkVisibility()).length";
    assert_eq!(observed.evaluate(buttons).unwrap(), json!(0));
    accessibility::check(&mut observed, "the observers' page");
    drop(observed);
    // Who leaves is asked once more, and then nothing is left.
    tab.evaluate("document.querySelector('#leave').click()").unwrap();
    tab.wait_until("document.querySelector('#leave-card').open").unwrap();
    accessibility::check(&mut tab, "the question whether to leave");
    tab.evaluate("document.querySelector('#leave-card .danger').click()").unwrap();
    tab.wait_until(&heading("You have left the study")).unwrap();
    accessibility::check(&mut tab, "the page of who has left the study");
    // The session's page does not take the focus from the study's: the browser says so.
    let problems = tab.problems().iter().chain(lab.problems());
    let problems: Vec<_> = problems.filter(|one| !one.starts_with("Blocked autofocusing")).collect();
    assert_eq!(problems, [] as [&str; 0]);
    drop((tab, lab, browser));
    server.end();
    assert!(!fs::exists(scratch.path("data/journals/P01.jsonl")).unwrap());
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_person_takes_part_in_german() {
    let scratch = study("study-german");
    let _ = scratch.write("study.toml", &format!("language = \"de\"\n{STUDY}"));
    let server = Server::start(&scratch, "0");
    let browser = Browser::start().unwrap();
    let mut tab = browser.open(&format!("http://{}{}", server.host, server.sign_up), 390, 844).unwrap();
    go_on(&mut tab, "Ich habe dies gelesen");
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    assert_eq!(tab.evaluate("document.documentElement.lang").unwrap(), json!("de"));
    accessibility::check(&mut tab, "a German consent form");
    tab.evaluate("document.querySelectorAll('.check input:required').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "Ich willige in die Teilnahme ein");
    tab.wait_until("document.querySelector('h1').textContent === 'Ihre nächste Aufgabe'").unwrap();
    let notice = "document.querySelector('.robot-language').textContent.includes('nur Englisch')";
    assert_eq!(tab.evaluate(notice).unwrap(), json!(true));
    accessibility::check(&mut tab, "a German page before a mission");
    go_on(&mut tab, "Beginnen");
    // The page of the session is in the same language.
    tab.wait_until("document.querySelector('iframe.session') !== null").unwrap();
    let address = tab.evaluate("document.querySelector('iframe.session').src").unwrap();
    let mut session = browser.open(address.as_str().unwrap(), 1280, 800).unwrap();
    session.wait_until("document.querySelector('#link-text')?.textContent === 'verbunden'").unwrap();
    // The experimenter's page is not.
    let mut lab = browser.open(&format!("http://{}{}", server.host, server.experimenter), 1280, 800).unwrap();
    lab.wait_until("document.documentElement.lang === 'en' && document.querySelector('#rows tr') !== null").unwrap();
    drop((tab, session, lab, browser));
    server.end();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn other_machines_take_part_by_https_at_ports_that_are_known() {
    let scratch = study("study-https");
    let first = 20_000 + std::process::id() % 10_000;
    let ports = format!("{first}-{}", first + 40);
    let arguments = ["--listen", "0.0.0.0", "--tls", "--session-ports", &ports];
    let server = Server::start_with(&scratch, "0", &arguments);
    assert!(!server.host.starts_with("0.0.0.0"), "nobody can go there: {}", server.host);
    let browser = Browser::start_trusting().unwrap();
    // Whatever stands between this machine and others, it reaches itself.
    let site = format!("https://127.0.0.1:{}", server.port());
    let mut tab = browser.open(&format!("{site}{}", server.sign_up), 1280, 800).unwrap();
    go_on(&mut tab, "I have read this");
    tab.wait_until("document.querySelectorAll('.check input').length === 3").unwrap();
    tab.evaluate("document.querySelectorAll('.check input').forEach((box) => box.click())").unwrap();
    go_on(&mut tab, "I agree to take part");
    go_on(&mut tab, "Begin");
    tab.wait_until("document.querySelector('iframe.session') !== null && !document.querySelector('.offer').hidden")
        .unwrap();
    assert_eq!(tab.evaluate("isSecureContext").unwrap(), json!(true));
    assert_eq!(tab.evaluate("document.querySelector('iframe.session').allow").unwrap(), json!("microphone; autoplay"));
    let address = tab.evaluate("document.querySelector('iframe.session').src").unwrap();
    let address = address.as_str().unwrap();
    let port: u32 = address.rsplit_once(':').unwrap().1.split_once('/').unwrap().0.parse().unwrap();
    assert!(address.starts_with("https://127.0.0.1:") && (first..=first + 40).contains(&port), "{address}");
    let mut session = browser.open(address, 1280, 720).unwrap();
    session.wait_until("window.cohabit?.frames > 0 && !document.querySelector('#mic').hidden").unwrap();
    let problems: Vec<_> = tab.problems().iter().filter(|one| !one.starts_with("Blocked autofocusing")).collect();
    assert_eq!(problems, [] as [&str; 0]);
    drop((tab, session, browser));
    server.end();
}

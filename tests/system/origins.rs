//! Who may use a session's page: people who were given its address, and no page of another site.

use cohabit_tests::{Browser, Page, Play};
use serde_json::json;

use crate::COHABIT;

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_page_whose_name_leads_here_is_refused() {
    let browser = Browser::start_with_names(&["evil.example"]).unwrap();
    let play = Play::start(COHABIT, &[]).unwrap();
    // It even knows the token.
    let rebound = play.address.replace("127.0.0.1", "evil.example");
    let mut tab = browser.open(&rebound, 800, 600).unwrap();
    tab.wait_until("document.body !== null && document.body.innerText.includes('not served as')").unwrap();
    assert!(tab.evaluate("location.host").unwrap().as_str().unwrap().starts_with("evil.example:"));
    let fetched = "Promise.all(['/' + location.search, '/app.js', '/frame.jpg' + location.search, '/nowhere'] \
        .map(async (path) => (await fetch(path)).status))";
    assert_eq!(tab.evaluate(fetched).unwrap(), json!([403, 403, 403, 403]));
    let connected = "new Promise((done) => { const socket = new WebSocket(`ws://${location.host}/ws${location.search}`); \
        socket.onopen = () => done('open'); socket.onerror = () => done('refused'); })";
    assert_eq!(tab.evaluate(connected).unwrap(), json!("refused"));
    // The names of this machine lead in.
    for name in ["127.0.0.1", "localhost"] {
        let mut tab = browser.open(&play.address.replace("127.0.0.1", name), 800, 600).unwrap();
        tab.wait_until("window.cohabit?.frames > 0").unwrap();
    }
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_name_that_was_added_is_served() {
    let browser = Browser::start_with_names(&["lab.example"]).unwrap();
    let play = Play::start(COHABIT, &["--host", "lab.example"]).unwrap();
    let mut tab = browser.open(&play.address.replace("127.0.0.1", "lab.example"), 800, 600).unwrap();
    tab.wait_until("window.cohabit?.frames > 0").unwrap();
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn the_policy_forbids_nothing_that_the_page_needs() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["--questionnaire", "tlx"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    let worklet = "new OfflineAudioContext(1, 16000, 16000).audioWorklet.addModule('/microphone.js').then(() => true)";
    assert_eq!(tab.evaluate(worklet).unwrap(), json!(true));
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("what can you see?").unwrap();
    tab.wait_until("document.querySelectorAll('#chat .from-robot').length > 0").unwrap();
    tab.evaluate("window.confirm = () => true; document.querySelector('#survey-open').click()").unwrap();
    // It is the same page when it is loaded again.
    tab.call("Page.reload", &json!({})).unwrap();
    tab.wait_until("performance.getEntriesByType('navigation')[0].type === 'reload' && window.cohabit?.frames > 0")
        .unwrap();
    assert_eq!(tab.problems(), [] as [&str; 0]);
    // Scripts in the page, or from elsewhere, are forbidden.
    tab.evaluate("{ const script = document.createElement('script'); script.textContent = 'window.injected = true'; document.body.append(script); }").unwrap();
    assert_eq!(tab.evaluate("window.injected === undefined").unwrap(), json!(true));
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
fn without_the_token_nobody_is_let_in() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let (host, token) = play.authority().split_once("/?token=").unwrap();
    assert!(token.len() == 32 && Page::open(host).is_err());
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("turn left").unwrap();
    play.end().unwrap();
}

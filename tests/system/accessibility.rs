//! The pages as people meet them who see little, hear them read, or have no mouse.

use cohabit_tests::{Browser, Play, Tab};
use serde_json::{Value, json};

use crate::COHABIT;

/// Gives what is wrong with the page that it is run in.
const AUDIT: &str = include_str!("accessibility/audit.js");
/// More than any page has of what can be used.
const MOST_PRESSES: usize = 400;

/// Notes what has the focus; of radio buttons, one of each name stands for all.
const NOTE_FOCUS: &str = "(() => { const note = window.reached ??= new Set(); const now = document.activeElement; \
    note.add(now.type === 'radio' ? now.name : now); return note.size; })()";
/// What can be used, and never had the focus.
const UNREACHED: &str = "(() => { const root = document.querySelector('dialog[open]') ?? document; \
    const all = root.querySelectorAll('a[href], button, input, select, textarea, [tabindex=\"0\"]'); \
    return [...all].filter((one) => one.checkVisibility({ visibilityProperty: true }) && one.tabIndex >= 0 && !one.disabled \
        && !window.reached.has(one.type === 'radio' ? one.name : one)).map((one) => one.outerHTML.slice(0, 160)); })()";

/// Finds out whether everybody can use the page that is open, at this size and on a phone.
pub fn check(tab: &mut Tab, page: &str) {
    for (width, height) in [(1280, 800), (390, 844)] {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        tab.call("Emulation.setDeviceMetricsOverride", &size).unwrap();
        tab.wait_until(&format!("innerWidth === {width}")).unwrap();
        // The page takes in its new size with its next frame.
        tab.evaluate("new Promise(done => setTimeout(done, 50))").unwrap();
        assert_eq!(tab.evaluate(AUDIT).unwrap(), json!([]), "{page} at {width} px");
    }
}

/// Finds out whether Tab leads to everything that can be used.
pub fn check_keyboard(tab: &mut Tab, page: &str) {
    let mut without_news = 0;
    let mut known = Value::Null;
    for _ in 0..MOST_PRESSES {
        for kind in ["rawKeyDown", "keyUp"] {
            let key = json!({ "type": kind, "key": "Tab", "code": "Tab", "windowsVirtualKeyCode": 9 });
            tab.call("Input.dispatchKeyEvent", &key).unwrap();
        }
        let reached = tab.evaluate(NOTE_FOCUS).unwrap();
        without_news = if reached == known { without_news + 1 } else { 0 };
        known = reached;
        // It has gone round.
        if without_news > 3 && tab.evaluate(UNREACHED).unwrap() == json!([]) {
            return;
        }
    }
    assert_eq!(tab.evaluate(UNREACHED).unwrap(), json!([]), "{page}");
}

fn wanting_contrast(contrast: &str) -> Value {
    json!({ "features": [{ "name": "prefers-contrast", "value": contrast }] })
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn everybody_can_use_the_page_of_a_session() {
    let browser = Browser::start().unwrap();
    let asking = ["--ask", "always", "--knows", "everything", "--questionnaire", "sus"];
    let play = Play::start(COHABIT, &asking).unwrap();
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until("document.querySelectorAll('.answers button:enabled').length > 0").unwrap();
    check(&mut tab, "a question of the robot's");
    // More contrast takes nothing away.
    tab.call("Emulation.setEmulatedMedia", &wanting_contrast("more")).unwrap();
    check(&mut tab, "the same with more contrast");
    tab.call("Emulation.setEmulatedMedia", &wanting_contrast("no-preference")).unwrap();
    check_keyboard(&mut tab, "a question of the robot's");

    // What the robot says is read aloud as it comes, and in its own language.
    let log = "(() => { const log = document.querySelector('#chat'); return [log.role, log.ariaLive]; })()";
    assert_eq!(tab.evaluate(log).unwrap(), json!(["log", "polite"]));

    // A card keeps the focus while it is open, and gives it back.
    tab.evaluate("window.confirm = () => true").unwrap();
    tab.evaluate("{ const open = document.querySelector('#survey-open'); open.focus(); open.click(); }").unwrap();
    tab.wait_until("document.querySelector('#survey').open").unwrap();
    check(&mut tab, "a questionnaire");
    tab.evaluate("window.reached = new Set()").unwrap();
    check_keyboard(&mut tab, "a questionnaire");
    let outside = "[...window.reached].filter((one) => one instanceof Element && one !== document.body \
        && !document.querySelector('#survey').contains(one)).length";
    assert_eq!(tab.evaluate(outside).unwrap(), json!(0));
    tab.evaluate("document.querySelector('#survey-later').click()").unwrap();
    tab.wait_until("document.activeElement.id === 'survey-open'").unwrap();
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn an_enlarged_page_can_be_scrolled_to_all_of_it() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &[]).unwrap();
    // A window of 1280 by 720 px at 200 %.
    let mut tab = browser.open(&play.address, 640, 360).unwrap();
    tab.wait_until("window.cohabit?.frames > 0").unwrap();
    let part = |what: &str| format!("document.querySelector('{what}').getBoundingClientRect()");
    assert_eq!(tab.evaluate(&format!("{}.height >= 200", part("#chat"))).unwrap(), json!(true));
    let reaches = format!(
        "(() => {{ const input = document.querySelector('#chat-input'); input.scrollIntoView({{ behavior: 'instant' }}); \
         const box = {}; return box.top >= -1 && box.bottom <= innerHeight + 1; }})()",
        part("#chat-input")
    );
    assert_eq!(tab.evaluate(&reaches).unwrap(), json!(true));
    assert_eq!(tab.evaluate("document.documentElement.scrollWidth <= 640").unwrap(), json!(true));
    // Nothing moves by itself for who asked for that.
    let calm = json!({ "features": [{ "name": "prefers-reduced-motion", "value": "reduce" }] });
    tab.call("Emulation.setEmulatedMedia", &calm).unwrap();
    let moving =
        "document.getAnimations().filter((one) => one.effect.getComputedTiming().iterations === Infinity).length";
    assert_eq!(tab.evaluate(moving).unwrap(), json!(0));
    drop((tab, browser));
    play.end().unwrap();
}

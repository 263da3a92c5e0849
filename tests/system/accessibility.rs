//! The pages as people meet them who see little, hear them read, or have no mouse: an audit of the project's own looks over them,
//! and so does axe-core.

use std::{fs, path::Path, process::Command, sync::LazyLock};

use cohabit_tests::{Browser, Page, Play, Tab, output, python_with};
use serde_json::{Value, json};

use crate::COHABIT;

/// Brings what moves in the page to its end.
const REST: &str = include_str!("accessibility/rest.js");
/// Gives what is wrong with the page that it is run in.
const AUDIT: &str = include_str!("accessibility/audit.js");
/// The same, as axe-core finds it.
const RUN_AXE: &str = include_str!("accessibility/axe.js");
/// The Python package that axe-core comes in, where it is installed, and how its file is found there.
const REQUIREMENTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/system/accessibility/requirements.txt");
const AXE_FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/axe");
const FIND_AXE: &str = "import axe_core_python, pathlib; \
    print(pathlib.Path(axe_core_python.__file__).with_name('axe.min.js'))";
/// The sizes of a desk's screen and of a phone, px.
const SIZES: [[u32; 2]; 2] = [[1280, 800], [390, 844]];
/// What is said in a mission until all its goals are met.
const COLD_SODA: &str = include_str!("../../cdf/missions/cold_soda.script");
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

/// The source of axe-core, or why it is not there.
static AXE: LazyLock<Result<String, String>> = LazyLock::new(fetch_axe);

fn fetch_axe() -> Result<String, String> {
    let python = python_with(Path::new(REQUIREMENTS), Path::new(AXE_FOLDER))?;
    let found = output(Command::new(python).args(["-c", FIND_AXE]))?;
    let file = String::from_utf8_lossy(&found.stdout).trim().to_owned();
    fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))
}

/// What axe-core finds wrong with the page that is open.
fn run_axe(tab: &mut Tab) -> Value {
    if tab.evaluate("typeof axe").unwrap() == json!("undefined") {
        let source = AXE.as_ref().unwrap();
        tab.call("Runtime.evaluate", &json!({ "expression": source })).unwrap();
    }
    tab.evaluate(&format!("{REST}{RUN_AXE}")).unwrap()
}

/// Gives the page that is open this size, px.
pub fn resize(tab: &mut Tab, [width, height]: [u32; 2]) {
    let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
    tab.call("Emulation.setDeviceMetricsOverride", &size).unwrap();
    tab.wait_until(&format!("innerWidth === {width}")).unwrap();
    // The page takes in its new size with its next frame.
    tab.evaluate("new Promise(done => setTimeout(done, 50))").unwrap();
}

/// Finds out whether everybody can use the page that is open, at the size that it has.
pub fn check_here(tab: &mut Tab, page: &str) {
    assert_eq!(tab.evaluate(&format!("{REST}{AUDIT}")).unwrap(), json!([]), "{page}");
    assert_eq!(run_axe(tab), json!([]), "{page}, by axe-core");
}

/// Finds out whether everybody can use the page that is open, at a desk and then on a phone, whose size it keeps.
pub fn check(tab: &mut Tab, page: &str) {
    for size in SIZES {
        resize(tab, size);
        check_here(tab, &format!("{page} at {} px", size[0]));
    }
}

/// Finds out the same for who asks the system for more contrast.
pub fn check_with_more_contrast(tab: &mut Tab, page: &str) {
    wish(tab, "prefers-contrast", "more");
    check(tab, &format!("{page}, with more contrast"));
    wish(tab, "prefers-contrast", "no-preference");
}

/// Has the system ask the page that is open for this alone.
pub fn wish(tab: &mut Tab, feature: &str, value: &str) {
    let wanted = json!({ "features": [{ "name": feature, "value": value }] });
    tab.call("Emulation.setEmulatedMedia", &wanted).unwrap();
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

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_page_of_a_session() {
    let browser = Browser::start().unwrap();
    let asking = ["--ask", "always", "--knows", "everything", "--questionnaire", "sus"];
    let play = Play::start(COHABIT, &asking).unwrap();
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    check(&mut tab, "a session that has begun");
    // On a phone the goals and the plan are opened by a press.
    tab.evaluate("document.querySelector('#goals-toggle').click()").unwrap();
    check_here(&mut tab, "the goals on a phone");
    tab.evaluate("document.querySelector('#map-toggle').click()").unwrap();
    check_here(&mut tab, "the enlarged plan on a phone");
    tab.evaluate("document.querySelector('#map-toggle').click()").unwrap();
    resize(&mut tab, SIZES[0]);
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until("document.querySelectorAll('.answers button:enabled').length > 0").unwrap();
    check(&mut tab, "a question of the robot's");
    // More contrast takes nothing away.
    check_with_more_contrast(&mut tab, "a question of the robot's");
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
    tab.evaluate("document.querySelector('#survey-send').click()").unwrap();
    tab.wait_until("document.querySelector('#survey-problem').textContent !== ''").unwrap();
    check(&mut tab, "a questionnaire that lacks an answer");
    tab.evaluate("document.querySelector('#survey-later').click()").unwrap();
    tab.wait_until("document.activeElement.id === 'survey-open'").unwrap();
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_walk_in() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["--body", "person@BreakRoom", "--body", "person@MainOffice"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && !document.querySelector('#walk-in').hidden").unwrap();
    tab.evaluate("document.querySelector('#walk-in').click()").unwrap();
    tab.wait_until("document.querySelectorAll('#walk-menu button:enabled').length === 2").unwrap();
    check(&mut tab, "the choice of an avatar");
    tab.evaluate("document.querySelector('#walk-menu button').click()").unwrap();
    tab.wait_until("window.cohabit.driving === 1 && window.cohabit.view === 'eyes/1'").unwrap();
    check(&mut tab, "the page of who walks as an avatar");
    assert_eq!(tab.problems(), [] as [&str; 0]);
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_page_of_a_session_that_ends() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["cold_soda", "--speed", "3"]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for sentence in COLD_SODA.lines() {
        page.do_and_wait(sentence).unwrap();
    }
    page.wait("every goal", |page, _| page.state["ending"] == "complete").unwrap();
    drop(page);
    let mut tab = browser.open(&play.address, 1280, 800).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && !document.querySelector('#banner').hidden").unwrap();
    check(&mut tab, "a mission that is complete");
    let ended = play.end().unwrap();
    tab.wait_until("document.body.classList.contains('lost')").unwrap();
    check(&mut tab, "a session that has ended");
    drop((tab, browser, ended));
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
    wish(&mut tab, "prefers-reduced-motion", "reduce");
    let moving =
        "document.getAnimations().filter((one) => one.effect.getComputedTiming().iterations === Infinity).length";
    assert_eq!(tab.evaluate(moving).unwrap(), json!(0));
    drop((tab, browser));
    play.end().unwrap();
}

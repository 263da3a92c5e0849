//! The page in a real browser.

use cohabit_tests::{Browser, Play};
use serde_json::json;

use crate::COHABIT;

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_opens_the_page_types_and_sees_the_robot_move() {
    let browser = Browser::start().unwrap();
    let mut play = Play::start(COHABIT, &["--camera", "door=fixed,x=4,y=10,yaw=90,rate=5"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    let line = play.wait_for_line("First frame on the page").unwrap();
    println!("{line}");

    let before = tab.evaluate("window.cohabit.state.robot").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until("document.querySelectorAll('#chat .from-robot').length > 0").unwrap();
    tab.wait_until("window.cohabit.state.robot.room === 'MainOffice'").unwrap();
    let after = tab.evaluate("window.cohabit.state.robot").unwrap();
    assert_ne!((&before["x"], &before["y"]), (&after["x"], &after["y"]));
    assert!(tab.evaluate("document.querySelector('#chat').innerText").unwrap().to_string().contains("main office"));

    // The picture is not one flat colour.
    let spread = "(() => { const v = document.querySelector('#view'); const c = document.createElement('canvas'); \
        c.width = 64; c.height = 36; const x = c.getContext('2d'); x.drawImage(v, 0, 0, 64, 36); \
        const d = x.getImageData(0, 0, 64, 36).data; const s = new Set(); \
        for (let i = 0; i < d.length; i += 4) s.add((d[i] >> 4) * 256 + (d[i + 1] >> 4) * 16 + (d[i + 2] >> 4)); \
        return s.size; })()";
    assert!(tab.evaluate(spread).unwrap().as_u64().unwrap() > 12, "the view is flat");

    // Other views are chosen by a button, by a key and from a list, and the next page begins with the one chosen.
    let looks_through = |camera: &str| format!("window.cohabit.view === '{camera}'");
    tab.evaluate("document.querySelector('[data-camera=\"eyes/0\"]').click()").unwrap();
    tab.wait_until(&looks_through("eyes/0")).unwrap();
    tab.evaluate("document.dispatchEvent(new KeyboardEvent('keydown', { code: 'KeyC', key: 'c', altKey: true }))")
        .unwrap();
    tab.wait_until(&looks_through("overhead/0")).unwrap();
    let choose = "{ const more = document.querySelector('#views-more'); more.value = 'door'; \
        more.dispatchEvent(new Event('change')); }";
    tab.evaluate(choose).unwrap();
    tab.wait_until(&looks_through("door")).unwrap();
    tab.evaluate("document.querySelector('[data-camera=\"overhead/0\"]').click()").unwrap();
    tab.wait_until(&looks_through("overhead/0")).unwrap();
    // The robot is in the middle of the picture from above, and says so to who clicks on it.
    let click = "{ const box = document.querySelector('#view').getBoundingClientRect(); \
        document.querySelector('#view').dispatchEvent(new MouseEvent('click', { \
        clientX: box.x + box.width / 2, clientY: box.y + box.height / 2 })); }";
    tab.evaluate(click).unwrap();
    tab.wait_until("window.cohabit.seen === 'robot'").unwrap();

    // After a lost connection it is a page with a picture again, and recalls each line once.
    let press = |key: &str| {
        let event = format!("new KeyboardEvent('keydown', {{ key: '{key}' }})");
        format!("document.querySelector('#chat-input').dispatchEvent({event})")
    };
    let said = "document.querySelectorAll('#chat .from-person').length";
    for (number, line) in (2..).zip(["what do you see?", "where are you?"]) {
        let say = format!(
            "document.querySelector('#chat-input').value = '{line}'; \
             document.querySelector('#composer').requestSubmit();"
        );
        tab.evaluate(&say).unwrap();
        tab.wait_until(&format!("{said} === {number}")).unwrap();
    }
    let watch = "window.sent = []; const own = WebSocket.prototype.send; \
        WebSocket.prototype.send = function (data) { \
        window.sent.push(String(data)); window.socket = this; return own.call(this, data); };";
    tab.evaluate(watch).unwrap();
    tab.evaluate("document.querySelector('[data-camera=\"eyes/0\"]').click()").unwrap();
    tab.wait_until("window.socket !== undefined").unwrap();
    tab.evaluate("window.sent = []; window.socket.close()").unwrap();
    tab.wait_until("window.sent.some((message) => message.includes('\"shown\"'))").unwrap();
    tab.wait_until(&format!("!document.querySelector('#chat').hasAttribute('aria-busy') && {said} === 3")).unwrap();
    for _ in 0..4 {
        tab.evaluate(&press("ArrowUp")).unwrap();
    }
    let typed = "document.querySelector('#chat-input').value";
    assert_eq!(tab.evaluate(typed).unwrap(), json!("go to the main office"));
    tab.evaluate(&press("ArrowDown")).unwrap();
    assert_eq!(tab.evaluate(typed).unwrap(), json!("what do you see?"));
    tab.evaluate("document.querySelector('#chat-input').value = ''").unwrap();
    tab.evaluate("document.querySelector('[data-camera=\"overhead/0\"]').click()").unwrap();
    tab.wait_until(&looks_through("overhead/0")).unwrap();

    // On a phone nothing is cut off at the side.
    let mut phone = browser.open(&play.address, 390, 844).unwrap();
    phone.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    phone.wait_until(&looks_through("overhead/0")).unwrap();
    assert_eq!(phone.evaluate("document.documentElement.scrollWidth <= 390").unwrap(), json!(true));
    // What was chosen in another session, as by the participant before, is not chosen in this one.
    for name in ["cohabit-view", "cohabit-voice"] {
        let other = format!(
            "{{ const kept = JSON.parse(localStorage.getItem('{name}')) ?? {{ value: {{ aloud: true }} }}; \
             localStorage.setItem('{name}', JSON.stringify({{ ...kept, of: 'another' }})); }}"
        );
        phone.evaluate(&other).unwrap();
    }
    let mut next = browser.open(&play.address, 390, 844).unwrap();
    next.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    next.wait_until(&looks_through("spectator/0")).unwrap();
    assert_eq!(next.evaluate("window.cohabit.voice.aloud").unwrap(), json!(false));
    drop((tab, phone, next, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_page_whose_connection_died_without_a_word_connects_anew() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &[]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("window.cohabit?.frames > 0").unwrap();
    // Each look at the clock is half a minute after the one before, as if nothing had come for so long.
    let sleeps = "{ window.opened = 0; const Own = window.WebSocket; \
        window.WebSocket = class extends Own { constructor(...all) { super(...all); window.opened += 1; } }; \
        const now = performance.now.bind(performance); let late = 0; \
        performance.now = () => now() + (late += 30000); window.wake = () => { performance.now = now; }; }";
    tab.evaluate(sleeps).unwrap();
    tab.wait_until("window.opened > 0").unwrap();
    tab.evaluate("window.wake()").unwrap();
    tab.wait_until("document.body.classList.contains('open')").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("what are you holding?").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('My hand is empty')").unwrap();
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_person_answers_a_question_with_a_click() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["--ask", "always", "--knows", "everything"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    let answers = "document.querySelectorAll('.answers button:enabled')";
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until(&format!("{answers}.length === 2")).unwrap();
    tab.evaluate(&format!("{answers}[0].click()")).unwrap();
    tab.wait_until("window.cohabit.state.robot.room === 'MainOffice'").unwrap();
    assert_eq!(tab.evaluate(&format!("{answers}.length")).unwrap(), json!(0), "an answer is given once");
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_question_waits_on_while_another_robot_speaks() {
    let browser = Browser::start().unwrap();
    let arguments = ["make_cereal", "--ask", "always", "--knows", "everything", "--body", "robot@BreakRoom"];
    let robots = ["--agent", "dialog", "--agent", "dialog@1", "--name", "0=Rosie", "--name", "1=Bob"];
    let play = Play::start(COHABIT, &[&arguments[..], &robots[..]].concat()).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    let answers = "document.querySelectorAll('.answers button:enabled')";
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("Rosie, go to the main office").unwrap();
    tab.wait_until(&format!("{answers}.length === 2")).unwrap();
    tab.type_and_enter("Bob, where are you?").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('I am in the break room')").unwrap();
    assert_eq!(tab.evaluate(&format!("{answers}.length")).unwrap(), json!(2), "Rosie waits for an answer yet");
    tab.evaluate(&format!("{answers}[0].click()")).unwrap();
    tab.wait_until("window.cohabit.state.robot.room === 'MainOffice'").unwrap();
    assert_eq!(tab.evaluate(&format!("{answers}.length")).unwrap(), json!(0), "an answer is given once");
    drop((tab, browser));
    play.end().unwrap();
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn what_the_robot_is_about_is_shown_on_while_it_answers_a_question() {
    let browser = Browser::start().unwrap();
    let play = Play::start(COHABIT, &["--knows", "everything"]).unwrap();
    let mut tab = browser.open(&play.address, 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("go to the main office").unwrap();
    tab.wait_until("!document.querySelector('#doing').classList.contains('idle')").unwrap();
    tab.type_and_enter("what are you holding?").unwrap();
    tab.wait_until("document.querySelector('#chat').innerText.includes('My hand is empty')").unwrap();
    tab.wait_until("window.cohabit.state.robot.room === 'MainOffice'").unwrap();
    tab.wait_until("document.querySelector('#trail .done')?.textContent.includes('main office')").unwrap();
    assert_eq!(tab.evaluate("document.querySelectorAll('#trail .undone').length").unwrap(), json!(0));
    drop((tab, browser));
    play.end().unwrap();
}

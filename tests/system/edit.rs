//! Floor plans and missions are made in a page: by HTTP, by the mouse, and by the keyboard alone.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use cohabit_tests::{Browser, Scratch, Tab, run};
use serde_json::{Value, json};

use crate::{COHABIT, accessibility};

/// The longest that an answer is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// What the program prints, and its exit code.
fn cohabit(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

/// A world pack of its own.
fn pack(scratch: &Scratch) -> String {
    let (text, code) = cohabit(&["new", "world", "my-home", "--into", &scratch.path("")]);
    assert_eq!(code, Some(0), "{text}");
    scratch.path("my-home")
}

/// A running `cohabit edit`. Dropping it ends it.
struct Editor {
    child: Child,
    /// `host:port`.
    host: String,
    /// The path of the page.
    page: String,
}

impl Editor {
    fn start(file: &str) -> Self {
        let mut child = Command::new(COHABIT)
            .args(["edit", file, "--port", "0"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let address = lines.find_map(|line| Some(line.strip_prefix("Open http://")?.to_owned()));
        let address = address.expect("it did not start");
        let (host, page) = address.split_once('/').unwrap();
        let editor = Self { child, host: host.to_owned(), page: format!("/{page}") };
        thread::spawn(move || lines.for_each(drop));
        editor
    }

    fn address(&self) -> String {
        format!("http://{}{}", self.host, self.page)
    }

    /// The status of an answer, and its body.
    fn request(&self, head: &str, host: &str, body: &str) -> (String, Vec<u8>) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        let length = body.len();
        let more = "Connection: close\r\nContent-Type: application/json";
        write!(stream, "{head}\r\nHost: {host}\r\n{more}\r\nContent-Length: {length}\r\n\r\n{body}").unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
        (head.split(' ').nth(1).unwrap().to_owned(), bytes[end + 4..].to_vec())
    }

    fn get(&self, path: &str) -> (String, Vec<u8>) {
        self.request(&format!("GET {path} HTTP/1.1"), &self.host, "")
    }

    fn post(&self, what: &str, body: &Value) -> Value {
        let head = format!("POST {}/{what} HTTP/1.1", self.page);
        serde_json::from_slice(&self.request(&head, &self.host, &body.to_string()).1).unwrap()
    }

    fn state(&self) -> Value {
        serde_json::from_slice(&self.get(&format!("{}/state", self.page)).1).unwrap()
    }

    /// Edits the present text; gives what the page then shows.
    fn edit(&self, edit: &Value) -> Value {
        let revision = self.state()["revision"].clone();
        self.post("edit", &json!({ "revision": revision, "edit": edit }))
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        // It ends its session with it.
        let _ = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status();
        let _ = self.child.wait();
    }
}

/// What draws two rooms with a door between them, a table in each, and a mug on one of them.
fn flat() -> Vec<Value> {
    vec![
        json!({ "do": "add_room", "room": "BreakRoom", "rect_m": [0.0, 0.0, 5.0, 4.0] }),
        json!({ "do": "add_room", "room": "Hallway", "rect_m": [5.0, 0.0, 8.0, 4.0] }),
        json!({ "do": "add_opening", "kind": "door", "at_m": [5.0, 2.0] }),
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [0.6, 2.0] }),
        json!({ "do": "add_thing", "class": "CoffeeMug_Boss", "at_m": [0.6, 2.0] }),
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [7.5, 2.0] }),
        json!({ "do": "complete" }),
    ]
}

#[test]
fn only_who_has_the_token_edits_and_nothing_is_written_before_it_is_saved() {
    let scratch = Scratch::new("edit");
    let file = format!("{}/layouts/Flat.toml", pack(&scratch));
    let editor = Editor::start(&file);
    for path in ["/", "/e/00000000000000000000000000000000", "/e/", &format!("{}x", editor.page)] {
        let (status, body) = editor.get(path);
        let body = String::from_utf8_lossy(&body).into_owned();
        assert!(status == "404" && body.contains("This link is not known"), "{path}: {status}: {body}");
    }
    for path in ["state", "choices", "picture/0/above"] {
        assert_eq!(editor.get(&format!("/e/00000000000000000000000000000000/{path}")).0, "404", "{path}");
    }
    assert_eq!(editor.request(&format!("GET {} HTTP/1.1", editor.page), "evil.example", "").0, "403");
    let origin = format!("POST {}/wish HTTP/1.1\r\nOrigin: http://evil.example", editor.page);
    assert_eq!(editor.request(&origin, &editor.host, "\"save\"").0, "403");

    assert_eq!(editor.get(&format!("{}/picture/0/above", editor.page)).0, "204", "there is nothing to see yet");
    for edit in flat() {
        let state = editor.edit(&edit);
        assert_eq!(state["problem"], Value::Null, "{edit}");
    }
    let state = editor.state();
    assert_eq!((&state["faults"], &state["is_saved"], Path::new(&file).exists()), (&json!([]), &json!(false), false));
    for eye in ["above", "BreakRoom.1"] {
        let (status, picture) = editor.get(&format!("{}/picture/9/{eye}", editor.page));
        assert!(status == "200" && picture.starts_with(&[0xff, 0xd8]), "{eye}");
    }
    let late = editor.post("edit", &json!({ "revision": 0, "edit": { "do": "complete" } }));
    assert!(late["problem"].as_str().unwrap().contains("on another page"), "{late}");
    let refused = editor.edit(&json!({ "do": "add_opening", "kind": "door", "at_m": [0.0, 2.0] }));
    assert!(refused["problem"].as_str().unwrap().contains("none behind this wall"), "{refused}");
    assert_eq!(editor.post("wish", &json!("undo"))["layout"]["views"], json!([]));
    assert_eq!(editor.post("wish", &json!("redo"))["layout"]["views"].as_array().unwrap().len(), 16);
    assert_eq!(editor.post("wish", &json!("save"))["is_saved"], json!(true));
    drop(editor);
    let (text, code) = cohabit(&["check", "--world", &scratch.path("my-home")]);
    assert_eq!(code, Some(0), "{text}");

    // A plan that no world would take is opened all the same.
    fs::write(&file, "room = [\n").unwrap();
    let editor = Editor::start(&file);
    let state = editor.state();
    assert!(state["layout"].is_null() && state["faults"].as_array().unwrap().len() == 1, "{state}");
}

#[test]
fn wrong_files_end_with_one_message() {
    let scratch = Scratch::new("edit-wrong");
    let folder = pack(&scratch);
    let refused = |file: &str, expected: &str| {
        let (text, code) = cohabit(&["edit", file, "--port", "0"]);
        assert!(code == Some(2) && text.contains(expected), "{code:?}: {text}");
    };
    refused(&format!("{folder}/world.txt"), "name a floor plan (.toml) or a mission (.json)");
    refused(&format!("{folder}/world.toml"), "no floor plan of a world pack");
    refused(&scratch.path("Flat.toml"), "`cohabit new world NAME`");
    refused(&format!("{folder}/layouts/OfficeLayout1.toml"), "there is a floor plan `OfficeLayout1` already");
    refused(&format!("{folder}/layouts/Flat_mirror.toml"), "mirror image");
    let many = scratch.path("many.json");
    fs::write(&many, "{\"a\": {\"cdf\": {\"scene\": {}}}, \"b\": {\"cdf\": {\"scene\": {}}}}").unwrap();
    refused(&many, "name a file of one mission");
}

/// Puts a text into a field by the keyboard.
fn fill(tab: &mut Tab, id: &str, words: &str) {
    tab.evaluate(&format!("(() => {{ const it = document.getElementById('{id}'); it.focus(); it.select(); }})()"))
        .unwrap();
    tab.call("Input.insertText", &json!({ "text": words })).unwrap();
}

/// Chooses of a list.
fn choose(tab: &mut Tab, id: &str, value: &str) {
    let choose = format!(
        "(() => {{ const it = document.getElementById('{id}'); it.focus(); it.value = '{value}'; \
         it.dispatchEvent(new Event('change')); return it.value; }})()"
    );
    assert_eq!(tab.evaluate(&choose).unwrap(), json!(value));
}

fn tool(tab: &mut Tab, value: &str) {
    tab.evaluate(&format!("document.querySelector('input[name=tool][value={value}]').click()")).unwrap();
}

/// Presses a key in the element that has the focus; 2 stands for Ctrl.
fn press(tab: &mut Tab, key: &str, modifiers: u8) {
    for kind in ["rawKeyDown", "keyUp"] {
        tab.call("Input.dispatchKeyEvent", &json!({ "type": kind, "key": key, "modifiers": modifiers })).unwrap();
    }
}

fn enter(tab: &mut Tab) {
    for kind in ["keyDown", "keyUp"] {
        let key = json!({ "type": kind, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13, "text": "\r" });
        tab.call("Input.dispatchKeyEvent", &key).unwrap();
    }
}

/// Waits until the plan has this, by the key that the list of the page has for it.
fn wait_for_item(tab: &mut Tab, key: &str) {
    tab.wait_until(&format!("[...document.querySelectorAll('#items option')].some((one) => one.value === '{key}')"))
        .unwrap();
}

fn wait_for_value(tab: &mut Tab, id: &str, value: f64) {
    tab.wait_until(&format!("Math.abs(Number(document.getElementById('{id}')?.value) - {value}) < 0.011")).unwrap();
}

fn begin(browser: &Browser, editor: &Editor) -> Tab {
    let mut tab = browser.open(&editor.address(), 1280, 800).unwrap();
    tab.wait_until("document.getElementById('saved').textContent !== ''").unwrap();
    tab
}

/// Chooses a class to be put.
fn choose_class(tab: &mut Tab, class: &str) {
    fill(tab, "search", class);
    choose(tab, "new-thing", class);
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_flat_is_drawn_and_a_mission_on_it_is_made_and_played_by_the_keyboard() {
    let scratch = Scratch::new("edit-keyboard");
    let folder = pack(&scratch);
    let browser = Browser::start().unwrap();
    let editor = Editor::start(&format!("{folder}/layouts/Flat.toml"));
    let mut tab = begin(&browser, &editor);
    tool(&mut tab, "room");
    for (room, corners) in [("BreakRoom", ["0", "0", "5", "4"]), ("Hallway", ["5", "0", "8", "4"])] {
        choose(&mut tab, "new-room", room);
        for (id, at) in ["x", "y", "x2", "y2"].into_iter().zip(corners) {
            fill(&mut tab, id, at);
        }
        enter(&mut tab);
        wait_for_item(&mut tab, &format!("room:{room}"));
    }
    tool(&mut tab, "door");
    fill(&mut tab, "x", "5");
    fill(&mut tab, "y", "2");
    enter(&mut tab);
    wait_for_item(&mut tab, "opening:0");
    accessibility::check(&mut tab, "the editor with a floor plan that lacks something");
    accessibility::resize(&mut tab, [1280, 800]);
    tool(&mut tab, "thing");
    for (class, at, key) in [
        ("Desk_01", ["0.6", "2"], "thing:Desk_01_10000"),
        ("CoffeeMug_Boss", ["0.6", "2"], "thing:CoffeeMug_Boss_10000"),
        ("Desk_01", ["7.5", "2"], "thing:Desk_01_10001"),
    ] {
        choose_class(&mut tab, class);
        fill(&mut tab, "x", at[0]);
        fill(&mut tab, "y", at[1]);
        enter(&mut tab);
        wait_for_item(&mut tab, key);
    }
    tab.evaluate("document.getElementById('complete').click()").unwrap();
    tab.wait_until("document.querySelectorAll('#faults li').length === 0").unwrap();
    tab.wait_until("document.getElementById('above').naturalWidth === 640").unwrap();
    tab.wait_until("document.getElementById('within').naturalWidth === 640").unwrap();
    // What is chosen is moved and turned on the plan, and the mug goes with its table.
    choose(&mut tab, "items", "thing:Desk_01_10000");
    wait_for_value(&mut tab, "field-east", 0.46);
    tab.evaluate("document.getElementById('plan').focus()").unwrap();
    press(&mut tab, "ArrowUp", 0);
    wait_for_value(&mut tab, "field-north", 2.05);
    press(&mut tab, "r", 0);
    wait_for_value(&mut tab, "field-yaw", 90.0);
    for expected in [0.0, 0.0] {
        press(&mut tab, "z", 2);
        wait_for_value(&mut tab, "field-yaw", expected);
    }
    wait_for_value(&mut tab, "field-north", 2.0);
    press(&mut tab, "s", 2);
    tab.wait_until("document.getElementById('saved').textContent === 'Saved'").unwrap();
    accessibility::check(&mut tab, "the editor with a whole floor plan");
    accessibility::check_keyboard(&mut tab, "the editor with a whole floor plan");
    assert_eq!(tab.problems(), [] as [String; 0]);
    drop((tab, editor));
    let plan = fs::read_to_string(format!("{folder}/layouts/Flat.toml")).unwrap();
    assert!(plan.contains("on = \"Desk_01_10000\""), "{plan}");

    let editor = Editor::start(&format!("{folder}/missions/bring_the_mug.json"));
    let mut tab = begin(&browser, &editor);
    assert_eq!(tab.evaluate("document.getElementById('which-plan').value").unwrap(), json!("Flat"));
    fill(&mut tab, "say-goal", "Bring the mug to the hallway");
    enter(&mut tab);
    tab.wait_until("document.getElementById('redo').disabled && !document.getElementById('undo').disabled").unwrap();
    tab.evaluate("document.getElementById('more-goals').click()").unwrap();
    tab.call("Input.insertText", &json!({ "text": "Put the mug on the table" })).unwrap();
    let row = "document.querySelector('#goals li:last-child')";
    tab.evaluate(&format!("{row}.querySelector('.parts input').focus()")).unwrap();
    tab.call("Input.insertText", &json!({ "text": "Desk_01_10001" })).unwrap();
    let state = "it.focus(); it.value = 'Contains'; it.dispatchEvent(new Event('change'));";
    tab.evaluate(&format!("(() => {{ const it = {row}.querySelector('.parts select'); {state} }})()")).unwrap();
    tab.evaluate(&format!("{row}.querySelectorAll('.parts input')[1].focus()")).unwrap();
    tab.call("Input.insertText", &json!({ "text": "CoffeeMug_Boss_10000" })).unwrap();
    accessibility::check(&mut tab, "the editor with a goal that is begun");
    accessibility::resize(&mut tab, [1280, 800]);
    tab.evaluate(&format!("{row}.querySelector('.chief').focus()")).unwrap();
    enter(&mut tab);
    tab.wait_until("document.querySelector('#goals h3')?.textContent === 'Goal: Put the mug on the table'").unwrap();
    tab.evaluate("document.getElementById('try').click()").unwrap();
    tab.wait_until("document.getElementById('tried').textContent.startsWith('Solved in')").unwrap();
    tab.evaluate("document.getElementById('play').click()").unwrap();
    tab.wait_until("!document.getElementById('session').hidden").unwrap();
    accessibility::check(&mut tab, "the editor with a mission that is played");
    accessibility::check_keyboard(&mut tab, "the editor with a mission that is played");
    let session = tab.evaluate("document.getElementById('session').href").unwrap();
    let mut session = browser.open(session.as_str().unwrap(), 1280, 800).unwrap();
    session.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    assert_eq!(tab.problems(), [] as [String; 0]);
    drop((session, tab, editor));
    let (text, code) = cohabit(&["check", "--world", &folder]);
    assert!(code == Some(0) && text.contains("bring_the_mug.json: playable"), "{text}");
}

/// The pixel of the page at a point of the plan.
fn pixel(tab: &mut Tab, [x, y]: [f64; 2]) -> [f64; 2] {
    let point = tab.evaluate(&format!(
        "(() => {{ const plan = document.getElementById('plan'); plan.scrollIntoView({{ block: 'center' }}); \
         const at = new DOMPoint({x}, {}).matrixTransform(plan.getScreenCTM()); return [at.x, at.y]; }})()",
        -y
    ));
    let point = point.unwrap();
    [point[0].as_f64().unwrap(), point[1].as_f64().unwrap()]
}

/// Drags from a point of the plan to another one; from a point to itself is a click.
fn drag(tab: &mut Tab, from: [f64; 2], to: [f64; 2]) {
    let (from, to) = (pixel(tab, from), pixel(tab, to));
    for (kind, at, buttons) in
        [("mouseMoved", from, 0), ("mousePressed", from, 1), ("mouseMoved", to, 1), ("mouseReleased", to, 0)]
    {
        let button = if kind == "mouseMoved" && buttons == 0 { "none" } else { "left" };
        let event =
            json!({ "type": kind, "x": at[0], "y": at[1], "button": button, "buttons": buttons, "clickCount": 1 });
        tab.call("Input.dispatchMouseEvent", &event).unwrap();
    }
}

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_flat_is_drawn_by_the_mouse() {
    let scratch = Scratch::new("edit-mouse");
    let editor = Editor::start(&format!("{}/layouts/Flat.toml", pack(&scratch)));
    let browser = Browser::start().unwrap();
    let mut tab = begin(&browser, &editor);
    tool(&mut tab, "room");
    choose(&mut tab, "new-room", "BreakRoom");
    drag(&mut tab, [0.02, 0.03], [5.01, 4.02]);
    wait_for_item(&mut tab, "room:BreakRoom");
    choose(&mut tab, "new-room", "Hallway");
    drag(&mut tab, [5.1, 0.1], [8.0, 3.9]);
    wait_for_item(&mut tab, "room:Hallway");
    tool(&mut tab, "door");
    drag(&mut tab, [5.1, 2.0], [5.1, 2.0]);
    wait_for_item(&mut tab, "opening:0");
    tool(&mut tab, "thing");
    choose_class(&mut tab, "Desk_01");
    drag(&mut tab, [0.6, 2.0], [0.6, 2.0]);
    wait_for_item(&mut tab, "thing:Desk_01_10000");
    choose_class(&mut tab, "CoffeeMug_Boss");
    drag(&mut tab, [0.5, 2.0], [0.5, 2.0]);
    wait_for_item(&mut tab, "thing:CoffeeMug_Boss_10000");
    tool(&mut tab, "select");
    drag(&mut tab, [0.46, 1.4], [2.46, 1.4]);
    wait_for_value(&mut tab, "field-east", 2.45);
    let text = |editor: &Editor| editor.state()["text"].as_str().unwrap().to_owned();
    assert!(text(&editor).contains("on = \"Desk_01_10000\""), "the mug went with its table");
    tab.evaluate("document.getElementById('undo').click()").unwrap();
    wait_for_value(&mut tab, "field-east", 0.46);
    tab.evaluate("[...document.querySelectorAll('#deeds button')].at(-1).click()").unwrap();
    tab.wait_until("![...document.querySelectorAll('#items option')].some((one) => one.value.startsWith('thing:'))")
        .unwrap();
    assert_eq!(tab.problems(), [] as [String; 0]);
}

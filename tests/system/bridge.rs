//! A client of the Model Context Protocol plays a body by tools alone, over the stdin and stdout of the bridge's process.

use std::{
    collections::BTreeMap,
    io::{BufRead as _, BufReader, Write as _},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use cohabit_tests::{Page, Play, run};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::COHABIT;

/// The longest that an answer, or the end of the process, is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);
/// What a JPEG begins with, in base64.
const JPEG: &str = "/9j/";

/// A client with the bridge that it has started.
struct Client {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<String>,
    /// Answers that came before somebody asked for them, by the numbers of their requests.
    early: BTreeMap<u64, Value>,
    requests: u64,
}

/// What a tool answered.
struct Said {
    text: String,
    is_refusal: bool,
    content: Vec<Value>,
}

impl Client {
    /// Starts a bridge to a session, and begins as the protocol says.
    fn start(session: &str, options: &[&str]) -> Self {
        let mut child = Command::new(COHABIT)
            .args(["bridge", "mcp", "--session", session])
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let output = BufReader::new(child.stdout.take().unwrap());
        let (sender, lines) = mpsc::channel();
        thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| sender.send(line)));
        let input = child.stdin.take();
        let mut client = Self { child, input, lines, early: BTreeMap::new(), requests: 0 };
        let begun = json!({
            "protocolVersion": "2025-06-18",
            "capabilities": {},
            "clientInfo": { "name": "test", "version": "1" },
        });
        let begun = client.ask("initialize", begun);
        assert_eq!(begun["result"]["protocolVersion"], "2025-06-18", "{begun}");
        client.write(&json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }).to_string());
        client
    }

    fn write(&mut self, line: &str) {
        writeln!(self.input.as_mut().unwrap(), "{line}").unwrap();
    }

    /// The next message: every line is one.
    fn next(&self) -> Value {
        let line = self.lines.recv_timeout(WATCHDOG).unwrap();
        let message: Value = serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"));
        assert_eq!(message["jsonrpc"], "2.0", "{line}");
        message
    }

    fn send(&mut self, method: &str, parameters: Value) -> u64 {
        self.requests += 1;
        let id = self.requests;
        self.write(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": parameters }).to_string());
        id
    }

    fn answer(&mut self, id: u64) -> Value {
        loop {
            if let Some(answer) = self.early.remove(&id) {
                return answer;
            }
            let message = self.next();
            let of = message["id"].as_u64().unwrap_or_else(|| panic!("an answer to nothing: {message}"));
            self.early.insert(of, message);
        }
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        let id = self.send(method, parameters);
        self.answer(id)
    }

    fn begin_call(&mut self, tool: &str, arguments: Value) -> u64 {
        self.send("tools/call", json!({ "name": tool, "arguments": arguments }))
    }

    fn end_call(&mut self, id: u64) -> Said {
        let answer = self.answer(id);
        let result = &answer["result"];
        let content = result["content"].as_array().unwrap_or_else(|| panic!("{answer}")).clone();
        let text = content[0]["text"].as_str().unwrap().to_owned();
        Said { text, is_refusal: result["isError"] == true, content }
    }

    fn call(&mut self, tool: &str, arguments: Value) -> Said {
        let id = self.begin_call(tool, arguments);
        self.end_call(id)
    }

    /// Uses a tool, which does what it is asked.
    fn done(&mut self, tool: &str, arguments: Value) -> String {
        let told = format!("{tool} {arguments}");
        let said = self.call(tool, arguments);
        assert!(!said.is_refusal, "{told}: {}", said.text);
        said.text
    }

    /// Has no more to say, and waits for the end of the process.
    fn leave(mut self) -> ExitStatus {
        drop(self.input.take());
        self.wait()
    }

    fn wait(&mut self) -> ExitStatus {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(Instant::now() < deadline, "the bridge does not end");
            thread::park_timeout(Duration::from_millis(5));
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The robot's own mind does what it is told.
fn check_mind(play: &Play) {
    let mut page = Page::open(play.authority()).unwrap();
    page.do_and_wait("go to the main office").unwrap();
    page.wait("the robot", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
}

#[test]
fn a_client_plays_a_mission_by_tools_alone_and_hands_the_body_back() {
    const CAN: &str = "CanSodaNew_01_1";
    const SHELF: &str = "AP_Prop_Shelf_Wall_04_10000";
    const COMPUTER: &str = "V_Monitor_FreezeRay_10000";
    let play = Play::start(COHABIT, &["cold_soda", "--speed", "3"]).unwrap();
    let mut client = Client::start(&play.session, &["--body", "robot", "--goals"]);
    let listed = client.ask("tools/list", json!({}));
    let names: Vec<&str> =
        listed["result"]["tools"].as_array().unwrap().iter().map(|tool| tool["name"].as_str().unwrap()).collect();
    assert!(["look", "go_to", "put", "toggle", "goals"].iter().all(|name| names.contains(name)), "{names:?}");
    let goals = client.done("goals", json!({}));
    assert!(goals.contains("open: ") && !goals.contains("met: "), "{goals}");

    let empty = client.call("put", json!({ "object": SHELF }));
    assert!(empty.is_refusal && empty.text.starts_with("Refused (ObjectNotPickedUp): my hand"), "{}", empty.text);
    let absent = client.call("go_to", json!({ "object": "zeppelin" }));
    assert!(absent.is_refusal && absent.text.contains("nothing here is `zeppelin`"), "{}", absent.text);

    client.done("go_to", json!({ "object": CAN }));
    let seen = client.call("look", json!({}));
    assert!(seen.text.starts_with("You are in the break room") && seen.text.contains(CAN), "{}", seen.text);
    let picture = &seen.content[1];
    assert_eq!((&picture["type"], &picture["mimeType"]), (&json!("image"), &json!("image/jpeg")));
    assert!(picture["data"].as_str().unwrap().starts_with(JPEG));
    let line = seen.text.lines().find(|line| line.contains(CAN)).unwrap();
    let number = line.split(':').next().unwrap();
    client.done("point_out", json!({ "object": number }));
    client.done("pick_up", json!({ "object": number }));
    let full = client.call("look", json!({}));
    assert!(full.text.lines().next().unwrap().contains(&format!("(number {number})")), "{}", full.text);

    client.done("go_to", json!({ "object": SHELF }));
    client.done("put", json!({ "object": SHELF }));
    client.done("go_to", json!({ "object": COMPUTER }));
    client.done("toggle", json!({ "object": COMPUTER }));
    let deadline = Instant::now() + WATCHDOG;
    while !client.done("goals", json!({})).contains("The mission is complete.") {
        assert!(Instant::now() < deadline, "{}", client.done("goals", json!({})));
        client.done("wait", json!({ "seconds": 0.5 }));
    }
    let told = client.done("listen", json!({}));
    assert!(told.contains("all goals of the mission are met"), "{told}");
    let around = client.call("look_around", json!({}));
    let is_seen = around.text.starts_with("You are in the ") && around.content[1]["type"] == "image";
    assert!(!around.is_refusal && is_seen, "{}", around.text);
    client.done("turn", json!({ "yaw_rad": 0.5 }));
    assert!(client.leave().success());

    check_mind(&play);
    let ended = play.end().unwrap();
    let replayed = run(COHABIT, &["replay", ended.log.to_str().unwrap()]).unwrap();
    let text = String::from_utf8_lossy(&replayed.stdout).into_owned();
    let is_same = replayed.status.success() && text.contains("no tick differs");
    assert!(is_same && text.contains("3 of 3 goals met"), "{text}");
}

#[test]
fn people_hear_what_a_client_says_and_answer_what_it_asks() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    let mut client = Client::start(&play.session, &[]);
    let hears = |page: &Page, part: &str| page.chat.iter().any(|(from, text)| from == "robot" && text.contains(part));
    client.done("say", json!({ "text": "I am played by tools." }));
    let shown = page.wait("the words", |_, message| message["text"] == "I am played by tools.").unwrap();
    assert_eq!((&shown["from"], &shown["name"]), (&json!("robot"), &json!("test")));
    assert_eq!(shown["body"], Value::Null, "there is one robot");
    let asked = client.begin_call("ask", json!({ "text": "Which way to the laser?", "seconds": 50 }));
    page.wait("the question", |page, _| hears(page, "Which way to the laser?")).unwrap();
    page.say("through the robotics lab").unwrap();
    let answer = client.end_call(asked);
    assert!(!answer.is_refusal && answer.text.contains(": through the robotics lab"), "{}", answer.text);
    let nobody = client.done("ask", json!({ "text": "And then?", "seconds": 1 }));
    assert!(nobody.starts_with("Nobody has answered yet"), "{nobody}");
    client.done("turn", json!({ "yaw_rad": 0.1 }));
    page.say("go to the main office").unwrap();
    page.wait("who commands it", |page, _| hears(page, "The program \"test\" commands me now")).unwrap();
    assert!(!page.chat.iter().any(|(_, text)| text.contains("body 0")), "{:?}", page.chat);
    // Goals are told to who may know them.
    let refused = client.ask("tools/call", json!({ "name": "goals" }));
    assert_eq!(refused["error"]["code"], -32602, "{refused}");
    drop(page);
    assert!(client.leave().success());
    play.end().unwrap();
}

#[test]
fn a_bridge_goes_on_after_nonsense_and_ends_when_asked() {
    let play = Play::start(COHABIT, &[]).unwrap();
    let mut client = Client::start(&play.session, &[]);
    let long = "x".repeat((1 << 20) + 1);
    for (line, code) in [("{", -32700), ("[]", -32600), (long.as_str(), -32600)] {
        client.write(line);
        let refused = client.next();
        assert_eq!((&refused["id"], &refused["error"]["code"]), (&Value::Null, &json!(code)));
    }
    assert_eq!(client.ask("resources/list", json!({}))["error"]["code"], -32601);
    // What is under way is stopped by another call; each is answered.
    let walk = client.begin_call("go_to", json!({ "object": "main office" }));
    let ping = client.ask("ping", json!({}));
    assert_eq!(ping["result"], json!({}));
    client.done("look", json!({}));
    client.done("stop", json!({}));
    let walked = client.end_call(walk);
    assert!(walked.is_refusal && walked.text.contains("Interrupted"), "{}", walked.text);
    let pid = Pid::from_raw(i32::try_from(client.child.id()).unwrap()).unwrap();
    kill_process(pid, Signal::TERM).unwrap();
    assert!(client.wait().success());
    drop(client);
    check_mind(&play);
    play.end().unwrap();
}

#[test]
fn a_bridge_to_nowhere_says_why() {
    let check = |arguments: &[&str], part: &str| {
        let ended = run(COHABIT, &[&["bridge", "mcp"], arguments].concat()).unwrap();
        let told = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert!(ended.status.code() == Some(2) && told.contains(part), "{arguments:?}: {told}");
        assert!(ended.stdout.is_empty(), "{arguments:?}");
    };
    check(&["--session", "nowhere"], "there is no such session here");
    let play = Play::start(COHABIT, &[]).unwrap();
    check(&["--session", &play.session, "--body", "3"], "the session has no body 3; its bodies are 0 (robot)");
    check(&["--session", &play.session, "--body", "butler"], "`butler` is no body");
    play.end().unwrap();
    let play = Play::start(COHABIT, &["--lock-step"]).unwrap();
    check(&["--session", &play.session], "the session is in lock-step");
    play.end().unwrap();
}

#[test]
fn calls_of_a_session_that_has_ended_say_so() {
    let mut play = Play::start(COHABIT, &[]).unwrap();
    let mut client = Client::start(&play.session, &[]);
    client.done("turn", json!({ "yaw_rad": 0.1 }));
    let waits = client.begin_call("wait", json!({ "seconds": 50 }));
    client.done("listen", json!({}));
    // The client and its bridge outlive the session.
    play.signal_supervisor(Signal::INT).unwrap();
    assert!(play.wait_for_end().unwrap().success());
    let waited = client.end_call(waits);
    assert!(waited.is_refusal && waited.text.contains("the session has ended"), "{}", waited.text);
    let turn = json!({ "yaw_rad": 0.1 });
    for (tool, arguments) in [("turn", turn), ("say", json!({ "text": "hello" })), ("look", json!({}))] {
        let said = client.call(tool, arguments);
        assert!(said.is_refusal && said.text.contains("the session has ended"), "{tool}: {}", said.text);
    }
    client.leave();
}

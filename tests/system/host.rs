//! Many sessions on one machine: how many fit, and a page that starts and ends them.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use cohabit_tests::{Browser, Page, Scratch};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::{COHABIT, accessibility};

/// The longest that anything is waited for.
const WATCHDOG: Duration = Duration::from_secs(120);

/// A running `cohabit host`. Dropping it kills it.
struct Server {
    child: Child,
    /// `host:port`.
    host: String,
    /// The path of its page.
    page: String,
}

impl Server {
    fn start(scratch: &Scratch, arguments: &[&str]) -> Self {
        let mut child = Command::new(COHABIT)
            .args(["host", "--port", "0"])
            .args(arguments)
            .env("XDG_DATA_HOME", scratch.path("home"))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let line = lines.by_ref().find(|line| line.starts_with("Page of all sessions: ")).expect("it did not start");
        let (host, page) = line.split_once("http://").unwrap().1.split_once('/').unwrap();
        let server = Self { child, host: host.to_owned(), page: format!("/{page}") };
        thread::spawn(move || lines.for_each(drop));
        server
    }

    /// The status of an answer, and its body.
    fn request(&self, method: &str, path: &str, body: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        let (host, length) = (&self.host, body.len());
        let head = format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n");
        let more = format!("Content-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}");
        stream.write_all((head + &more).as_bytes()).unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().to_owned(), body.to_owned())
    }

    fn order(&self, command: &Value) -> Value {
        let body = self.request("POST", &format!("{}/command", self.page), &command.to_string()).1;
        serde_json::from_str(&body).unwrap()
    }

    /// Waits until its sessions are so.
    fn wait(&self, what: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            let state: Value =
                serde_json::from_str(&self.request("GET", &format!("{}/state", self.page), "").1).unwrap();
            if is_so(&state["sessions"]) {
                return state;
            }
            assert!(Instant::now() < deadline, "waited in vain for {what}: {state:#}");
            thread::park_timeout(Duration::from_millis(100));
        }
    }

    /// The supervisors of its sessions.
    fn sessions(&self) -> usize {
        let part = format!("\0--session\0h{}-", self.child.id());
        let processes = fs::read_dir("/proc").unwrap().flatten();
        let lines = processes.filter_map(|process| fs::read_to_string(process.path().join("cmdline")).ok());
        lines.filter(|line| line.contains("\0play\0") && line.contains(&part)).count()
    }

    /// Presses Ctrl-C, and waits for its end.
    fn end(mut self) {
        kill_process(Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap(), Signal::INT).unwrap();
        let deadline = Instant::now() + WATCHDOG;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(Instant::now() < deadline, "it does not end");
            thread::park_timeout(Duration::from_millis(10));
        };
        assert!(status.success(), "{status}");
        assert_eq!(self.sessions(), 0, "sessions are left behind");
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The state of the session of that number.
fn state(sessions: &Value, number: usize) -> &str {
    sessions[number - 1]["state"].as_str().unwrap()
}

#[test]
fn sessions_are_started_and_ended_from_a_page_of_all() {
    let scratch = Scratch::new("host");
    let logs = scratch.path("logs");
    let options = ["--sessions", "2", "--logs", &logs, "cold_soda", "make_cereal", "--", "--understanding", "fast"];
    let server = Server::start(&scratch, &options);
    for path in ["/", "/h/00000000000000000000000000000000", &format!("{}x", server.page)] {
        assert_eq!(server.request("GET", path, "").0, "404", "{path}");
        assert_eq!(server.request("GET", &format!("{path}/state"), "").0, "404", "{path}");
    }
    let (status, page) = server.request("GET", &server.page, "");
    assert!(status == "200" && page.contains("Sessions of this machine"), "{status}: {page}");
    let is_measured = |sessions: &Value| sessions[0]["cores"].is_f64() && sessions[0]["missed"].is_number();
    let open =
        server.wait("a session that is measured", |sessions| state(sessions, 1) == "open" && is_measured(sessions));
    let first = &open["sessions"][0];
    assert_eq!((&first["mission"], &open["sessions"][1]["mission"]), (&json!("cold_soda"), &json!("make_cereal")));
    assert!(first["memory_bytes"].as_u64() > Some(1 << 20) && open["cores"].as_f64() >= Some(1.0), "{open:#}");
    let authority = format!("127.0.0.1:{}/?token={}", first["port"], first["token"].as_str().unwrap());
    let mut session = Page::open(&authority).unwrap();
    session.wait("a frame", |page, _| page.frames > 0).unwrap();
    drop(session);
    assert_eq!(server.order(&json!({ "stop": 1 }))["problem"], Value::Null);
    server.wait("the end of the first session", |sessions| state(sessions, 1) == "stopped");
    // With nobody before it, the second one is admitted however busy the machine is.
    server.wait("the second session", |sessions| state(sessions, 2) == "open");
    let problem = server.order(&json!({ "start": 3 }))["problem"].clone();
    assert_eq!(problem, json!("There is no session 3."));
    assert_eq!(server.sessions(), 1);
    server.end();
    assert_eq!(fs::read_dir(&logs).unwrap().count(), 2, "each session is recorded");
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_page_of_all_sessions() {
    let scratch = Scratch::new("host-browser");
    let logs = scratch.path("logs");
    let options = ["--sessions", "1", "--logs", &logs, "cold_soda", "--", "--understanding", "fast"];
    let server = Server::start(&scratch, &options);
    let browser = Browser::start().unwrap();
    let mut stranger = browser.open(&format!("http://{}/h/unknown", server.host), 390, 844).unwrap();
    stranger.wait_until("document.querySelector('h1')?.textContent === 'This link is not known'").unwrap();
    accessibility::check(&mut stranger, "a link of no page of sessions");
    let mut tab = browser.open(&format!("http://{}{}", server.host, server.page), 1280, 800).unwrap();
    let link = "document.querySelector('#rows a')";
    tab.wait_until(&format!("{link}?.href.includes('/?token=')")).unwrap();
    tab.wait_until("document.querySelector('#rows tr').children[6].textContent.endsWith('%')").unwrap();
    accessibility::check(&mut tab, "the page of all sessions");
    accessibility::check_keyboard(&mut tab, "the page of all sessions");
    let button = "document.querySelector('#rows button')";
    tab.evaluate(&format!("window.confirm = () => true; {button}.focus(); {button}.click()")).unwrap();
    tab.wait_until(&format!("{button}.textContent === 'Start' && {link} === null")).unwrap();
    tab.wait_until("document.querySelector('#rows tr').children[3].textContent === 'stopped'").unwrap();
    assert_eq!(tab.evaluate(&format!("document.activeElement === {button}")).unwrap(), json!(true));
    tab.evaluate(&format!("{button}.click()")).unwrap();
    tab.wait_until(&format!("{button}.textContent === 'Stop' && {link} !== null")).unwrap();
    drop((stranger, tab, browser));
    server.end();
}

#[test]
fn what_a_session_takes_is_measured() {
    let scratch = Scratch::new("capacity");
    let output = Command::new(COHABIT)
        .args(["host", "--measure", "--json", "--most", "1", "--seconds", "2"])
        .env("XDG_DATA_HOME", scratch.path("home"))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let document: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (measured, step) = (&document["measured"], &document["measured"]["steps"][0]);
    assert_eq!((&measured["is_estimate"], &step["sessions"]), (&json!(true), &json!(1)), "{document:#}");
    for figure in ["seconds", "cores", "pictures_per_s"] {
        assert!(step[figure].as_f64() > Some(0.0), "{figure}: {document:#}");
    }
    assert!(step["ticks"].as_u64() > Some(60) && step["memory_bytes"].as_u64() > Some(10 << 20), "{document:#}");
    let noted = fs::read_to_string(scratch.path("home/cohabit/capacity.json"));
    assert!(noted.is_ok_and(|noted| noted.contains("\"is_estimate\": true")), "it is kept for the next command");
    assert!(fs::read_dir(scratch.path("home/cohabit")).unwrap().count() == 1, "the sessions are not");
}

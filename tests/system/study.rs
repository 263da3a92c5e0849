//! A study from its file to its data: two participants, pages, a killed session, a killed server, a withdrawal.

mod accessible;
mod frictionless;
mod pages;
mod pairs;
mod practice;
mod six;
mod wizard;

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    os::unix::fs::PermissionsExt as _,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use cohabit_tests::{Page, Scratch, run};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::COHABIT;

/// The longest that anything is waited for.
const WATCHDOG: Duration = Duration::from_secs(90);

const STUDY: &str = r#"
title = "A short study"
contact = "the lab"
seed = 11
participants = 4
assignment = "balanced_latin_square"
missions = ["cold_soda", "make_cereal"]
completion_code = "DONE-42"

[settings]
understanding = "fast"

[information]
file = "sheet.md"
version = "1"

[consent]
file = "sheet.md"
version = "3"
required = ["I am 18 or older.", "I agree."]
optional = [{ text = "I may be heard.", audio = true }]

[[factor]]
name = "ask"
kind = "within"
level = [
  { name = "never", settings = { ask = "never" } },
  { name = "always", settings = { ask = "always" } },
]

[[factor]]
name = "knowledge"
kind = "between"
level = [
  { name = "seen", settings = { knows = "seen" } },
  { name = "everything", settings = { knows = "everything" } },
]

[[block]]
kind = "missions"
minutes = 5
skip_after_minutes = 0.01
after_mission = ["short.toml"]

[[block]]
kind = "break"

[[block]]
kind = "debriefing"
file = "sheet.md"

[[probe]]
questionnaire = "annoyed.toml"
at = "question_asked"
"#;

const ANNOYED: &str = r#"
title = "A question"
[[item]]
ask = "How annoying was that?"
scale = { least = 1, most = 5, left = "Not at all", right = "Very" }
"#;

const SHORT: &str = r#"
title = "How was it?"
scale = { least = 1, most = 5, left = "Bad", right = "Good" }
[[item]]
ask = "The robot understood me."
[[item]]
ask = "Anything else?"
words = true
optional = true
"#;

/// A running `cohabit study run`. Dropping it kills it.
struct Server {
    child: Child,
    /// `host:port`.
    host: String,
    experimenter: String,
    sign_up: String,
}

impl Server {
    fn start(scratch: &Scratch, port: &str) -> Self {
        Self::start_with(scratch, port, &[])
    }

    /// The same with more arguments.
    fn start_with(scratch: &Scratch, port: &str, arguments: &[&str]) -> Self {
        let child = Command::new(COHABIT)
            .args(["study", "run", &scratch.path("study.toml"), "--folder", &scratch.path("data"), "--port", port])
            .args(["--sessions", "2"])
            .args(arguments)
            .env("XDG_DATA_HOME", scratch.path("home"))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut server = Self { child, host: String::new(), experimenter: String::new(), sign_up: String::new() };
        let mut lines = BufReader::new(server.child.stdout.take().unwrap()).lines().map_while(Result::ok);
        for line in lines.by_ref() {
            let Some((_, address)) = line.split_once("://") else { continue };
            let (host, path) = address.split_once('/').unwrap();
            host.clone_into(&mut server.host);
            if line.starts_with("Experimenter") {
                server.experimenter = format!("/{path}");
            } else {
                server.sign_up = format!("/{path}");
                break;
            }
        }
        thread::spawn(move || lines.for_each(|line| eprintln!("{line}")));
        assert!(!server.sign_up.is_empty(), "it did not start");
        server
    }

    fn port(&self) -> &str {
        self.host.rsplit_once(':').unwrap().1
    }

    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap(), signal).unwrap();
    }

    /// Ends it in order.
    fn end(mut self) {
        self.signal(Signal::INT);
        let deadline = Instant::now() + WATCHDOG;
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(Instant::now() < deadline, "the study does not end");
            thread::park_timeout(Duration::from_millis(10));
        };
        assert!(status.success(), "{status}");
        assert_eq!(self.sessions(), [] as [i32; 0], "sessions are left behind");
    }

    /// The supervisors of its sessions.
    fn sessions(&self) -> Vec<i32> {
        processes("\0play\0", &format!("\0--session\0s{}-", self.child.id()))
    }

    /// The answer to a request: its head, and its body.
    fn request(&self, method: &str, path: &str, body: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        let (host, length) = (&self.host, body.len());
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Type: application/json\r\n"
        );
        write!(stream, "{head}Content-Length: {length}\r\n\r\n{body}").unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        (head.to_owned(), body.to_owned())
    }

    fn get(&self, path: &str) -> Value {
        serde_json::from_str(&self.request("GET", path, "").1).unwrap()
    }

    fn order(&self, command: &Value) -> Value {
        let (_, body) = self.request("POST", &format!("{}/command", self.experimenter), &command.to_string());
        serde_json::from_str(&body).unwrap()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Processes whose command lines, parts separated by zero bytes, contain both.
fn processes(one: &str, other: &str) -> Vec<i32> {
    let pids = fs::read_dir("/proc").unwrap().flatten().filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let line = |pid: &i32| fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
    pids.filter(|pid| {
        let line = String::from_utf8_lossy(&line(pid)).into_owned();
        line.contains(one) && line.contains(other)
    })
    .collect()
}

/// Somebody who takes part, by plain HTTP.
struct Person {
    link: String,
}

impl Person {
    fn sign_up(server: &Server) -> Self {
        let (head, _) = server.request("GET", &server.sign_up, "");
        let link = head.lines().find_map(|line| line.strip_prefix("location: ")).unwrap().to_owned();
        Self { link }
    }

    fn state(&self, server: &Server) -> Value {
        server.get(&format!("{}/state", self.link))
    }

    /// Tells something of the step that is shown.
    fn tell(&self, server: &Server, event: &Value) -> Value {
        let step = self.state(server)["step"].clone();
        let body = json!({ "step": step, "event": event }).to_string();
        let (head, body) = server.request("POST", &format!("{}/event", self.link), &body);
        serde_json::from_str(&body).unwrap_or_else(|_| panic!("{head}: {body}"))
    }

    fn agree(&self, server: &Server) {
        assert_eq!(self.state(server)["page"], "information");
        assert_eq!(self.tell(server, &json!("read"))["page"], "consent");
        let agreed = self.tell(server, &json!({ "consented": { "version": "3", "ticked": [0, 1] } }));
        assert_eq!((&agreed["page"], &agreed["problem"]), (&json!("ready"), &Value::Null), "{agreed}");
    }

    /// Waits, as a page does, until it is shown a page of that name.
    fn wait_for(&self, server: &Server, page: &str) -> Value {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            let state = self.state(server);
            if state["page"] == page {
                return state;
            }
            assert!(Instant::now() < deadline, "waited in vain for {page}: {state}");
            thread::park_timeout(Duration::from_millis(100));
        }
    }

    /// Skips the mission that they play as soon as they may, and answers what is asked about it.
    fn skip(&self, server: &Server) {
        let deadline = Instant::now() + WATCHDOG;
        while self.state(server)["skip_in_s"] != 0.0 {
            assert!(Instant::now() < deadline, "the mission cannot be skipped");
            thread::park_timeout(Duration::from_millis(50));
        }
        self.tell(server, &json!({ "over": { "ending": "skipped" } }));
        self.wait_for(server, "questionnaire");
        let answers = json!([{ "value": 3 }, null]);
        self.tell(server, &json!({ "answered": { "questionnaire": "short", "answers": answers } }));
    }

    /// Opens the page of the session that they play.
    fn session(&self, server: &Server) -> Page {
        let session = self.wait_for(server, "mission")["session"].clone();
        Page::open(&format!("127.0.0.1:{}/?token={}", session["port"], session["token"].as_str().unwrap())).unwrap()
    }
}

/// What the experimenter sees of each participant: between, order, now.
fn conditions(server: &Server) -> Vec<[String; 3]> {
    let overview = server.get(&format!("{}/state", server.experimenter));
    let rows = overview["participants"].as_array().unwrap();
    rows.iter().map(|row| ["between", "order", "now"].map(|part| row[part].to_string())).collect()
}

/// The setting of the robot's asking in a session's log.
fn asked_of(log: &str) -> String {
    cohabit_record::Log::open(log.as_ref()).unwrap().session.settings["ask"].clone()
}

fn study(test: &str) -> Scratch {
    let scratch = Scratch::new(test);
    let _ = scratch.write("study.toml", STUDY);
    let _ = scratch.write("sheet.md", "# What this is about\n\nYou talk to a **robot**.");
    let _ = scratch.write("short.toml", SHORT);
    let _ = scratch.write("annoyed.toml", ANNOYED);
    scratch
}

#[test]
fn everybody_ends_in_the_conditions_they_were_assigned_whatever_is_killed() {
    let scratch = study("study");
    let server = Server::start(&scratch, "0");
    let people = [Person::sign_up(&server), Person::sign_up(&server)];
    people.iter().for_each(|person| person.agree(&server));
    for person in &people {
        person.tell(&server, &json!("goes_on"));
    }
    let mut pages = people.each_ref().map(|person| person.session(&server));
    for page in &mut pages {
        page.do_and_wait("go to the main office").unwrap();
        // Who always asks is told so.
        page.do_and_wait("yes").unwrap();
        page.wait("the main office", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
    }
    let assigned = conditions(&server);
    assert_ne!(assigned[0][0], assigned[1][0], "one of each between-participants condition");

    // Who was asked something by the robot is asked about that, while the mission goes on.
    for (person, condition) in people.iter().zip(&assigned) {
        if !condition[2].contains("ask=always") {
            assert!(person.state(&server)["probe"].is_null());
            continue;
        }
        let deadline = Instant::now() + WATCHDOG;
        while person.state(&server)["probe"]["item"]["ask"] != "How annoying was that?" {
            assert!(Instant::now() < deadline, "nothing is asked");
            thread::park_timeout(Duration::from_millis(50));
        }
        let answered = json!({ "probe_answered": { "probe": 0, "answer": { "value": 5 } } });
        assert!(person.tell(&server, &answered)["probe"].is_null());
    }

    // A session that is killed is started again in the same condition.
    let before = people[0].wait_for(&server, "mission")["session"].clone();
    let of_server = format!("\0--session\0s{}-", server.child.id());
    let [victim, ..] = processes("\0--participant\0P01\0", &of_server)[..] else { panic!("no session of P01") };
    kill_process(Pid::from_raw(victim).unwrap(), Signal::KILL).unwrap();
    let deadline = Instant::now() + WATCHDOG;
    while people[0].wait_for(&server, "mission")["session"] == before {
        assert!(Instant::now() < deadline, "the session is not started again");
        people[1].state(&server);
        thread::park_timeout(Duration::from_millis(100));
    }
    assert_eq!(conditions(&server), assigned);

    // The server is killed, and with it its sessions; the next one goes on where everybody was.
    let old = server.child.id();
    let port = server.port().to_owned();
    let links = [server.experimenter.clone(), server.sign_up.clone()];
    server.signal(Signal::KILL);
    drop((server, pages));
    let server = Server::start(&scratch, &port);
    assert_eq!([server.experimenter.clone(), server.sign_up.clone()], links);
    let mut pages = people.each_ref().map(|person| person.session(&server));
    for page in &mut pages {
        page.wait("where the robot is", |page, _| page.state["robot"]["room"] == "MainOffice").unwrap();
        page.do_and_wait("turn right").unwrap();
    }
    assert_eq!(conditions(&server), assigned);
    assert_eq!(processes("\0play\0", &format!("\0--session\0s{old}-")), [] as [i32; 0]);

    // One goes on to the end.
    let person = &people[0];
    let early = person.tell(&server, &json!({ "over": { "ending": "complete" } }));
    assert_eq!(early["page"], "mission", "that a mission is complete only the session says");
    let answers = json!([{ "value": 4 }, { "text": "=1+1" }]);
    let answered = json!({ "answered": { "questionnaire": "short", "answers": answers } });
    for mission in 0..2 {
        if mission > 0 {
            person.tell(&server, &json!("goes_on"));
        }
        person.wait_for(&server, "mission");
        while person.state(&server)["skip_in_s"] != 0.0 {
            thread::park_timeout(Duration::from_millis(50));
        }
        person.tell(&server, &json!({ "over": { "ending": "skipped" } }));
        assert_eq!(person.wait_for(&server, "questionnaire")["questionnaire"]["name"], "short");
        let none = json!({ "answered": { "questionnaire": "short", "answers": [null, null] } });
        assert_eq!(person.tell(&server, &none)["problem"], "Question 1 has no answer yet.");
        person.tell(&server, &answered);
    }
    assert_eq!(person.state(&server)["page"], "break");
    let end = person.tell(&server, &json!("goes_on"));
    assert_eq!((&end["page"], &end["completion"]["code"]), (&json!("finished"), &json!("DONE-42")));

    // The experimenter's notes are kept; the other one withdraws, and nothing of theirs is.
    server.order(&json!({ "note": { "participant": "P02", "text": "looks bored" } }));
    let noted = server.order(&json!({ "note": { "participant": null, "text": "the lab is cold" } }));
    assert_eq!(noted["notes"].as_array().unwrap().len(), 2);
    assert_eq!(people[1].tell(&server, &json!("withdrew"))["page"], "withdrawn");
    let journal = scratch.path("data/journals/P02.jsonl");
    let deadline = Instant::now() + WATCHDOG;
    while fs::exists(&journal).unwrap() {
        assert!(Instant::now() < deadline, "the data of P02 are still there");
        thread::park_timeout(Duration::from_millis(50));
    }
    drop(pages);
    server.end();

    // The data: consent apart, tables with factors, and no trace of who withdrew but that they did.
    let out = scratch.path("tables");
    let data = scratch.path("data");
    let done = run(COHABIT, &["study", "export", "--folder", &data, "--out", &out]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |name: &str| fs::read_to_string(format!("{out}/{name}.csv")).unwrap();
    let answers = read("answers");
    assert_eq!(answers.lines().count(), 5, "{answers}");
    assert!(answers.contains("'=1+1") && answers.lines().next().unwrap().contains("factor_ask"), "{answers}");
    let sessions = read("sessions");
    let logs: Vec<_> = fs::read_dir(format!("{data}/logs")).unwrap().flatten().map(|entry| entry.path()).collect();
    assert_eq!(sessions.lines().count(), 1 + logs.len(), "{sessions}");
    for log in &logs {
        let name = log.file_stem().unwrap().to_str().unwrap();
        assert!(name.starts_with("P01-"), "{name}");
        let row = sessions.lines().find(|line| line.starts_with(name)).unwrap();
        assert!(row.contains(&asked_of(log.to_str().unwrap())), "{row}");
    }
    assert_eq!(read("missions").lines().count(), 3);
    assert!(read("codebook").contains("factor_knowledge") && read("participants").contains("P02,,,,withdrawn"));
    let consent: Value =
        serde_json::from_str(&fs::read_to_string(format!("{data}/consent/P01.json")).unwrap()).unwrap();
    assert_eq!((&consent["version"], &consent["agreed"][1]), (&json!("3"), &json!("I agree.")));
    assert!(!fs::exists(format!("{data}/consent/P02.json")).unwrap());
    assert!(!fs::read_to_string(format!("{data}/notes.jsonl")).unwrap().contains("bored"));
    assert_eq!(fs::metadata(format!("{data}/private/links.json")).unwrap().permissions().mode() & 0o077, 0);

    // By hand, too.
    let done = run(COHABIT, &["study", "withdraw", "P01", "--folder", &data]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    assert_eq!(fs::read_dir(format!("{data}/logs")).unwrap().count(), 0);
    let again = run(COHABIT, &["study", "withdraw", "P01", "--folder", &data]).unwrap();
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("nothing of `P01`"));
}

#[test]
fn studies_are_checked_with_places_and_the_one_that_ships_can_be_run() {
    let ships = concat!(env!("CARGO_MANIFEST_DIR"), "/../study/studies/clarification.toml");
    let checked = run(COHABIT, &["study", "check", ships]).unwrap();
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
    let schema = run(COHABIT, &["study", "check", "--schema"]).unwrap();
    let schema: Value = serde_json::from_slice(&schema.stdout).unwrap();
    assert_eq!(schema["properties"]["seed"]["type"], "integer");
    let scratch = study("study-check");
    let wrong = STUDY.replace("ask = \"never\"", "ask = \"rarely\"").replace("cold_soda", "warm_soda");
    // A value of the wrong kind keeps nothing else from being looked at.
    let wrong = wrong.replace("minutes = 5", "minutes = \"five\"");
    let wrong = scratch.write("wrong.toml", &wrong);
    for arguments in [vec!["study", "check", &wrong], vec!["study", "run", &wrong, "--folder", &scratch.path("data")]] {
        let checked = run(COHABIT, &arguments).unwrap();
        let said = String::from_utf8_lossy(&checked.stderr).into_owned();
        assert_eq!(checked.status.code(), Some(2), "{said}");
        assert!(said.contains("wrong.toml:7:") && said.contains("warm_soda"), "{said}");
        assert!(said.contains("wrong.toml:27:") && said.contains("rarely"), "{said}");
        assert!(said.contains("`minutes` cannot be this string"), "{said}");
    }
    assert!(!fs::exists(scratch.path("data")).unwrap());
}

#[test]
fn missions_that_the_planner_does_not_solve_are_named() {
    let scratch = study("study-solve");
    let (_, soda) = cohabit_cdf::mission::builtin().iter().find(|(file, _)| *file == "cold_soda.json").unwrap();
    let mut sparks: Value = serde_json::from_str(soda).unwrap();
    sparks["task_goals"][0]["object_states"] = json!([{ "CanSodaNew_01_1": "isSparking=true" }]);
    let _ = scratch.write("sparks.json", &sparks.to_string());
    for (missions, code) in [("[\"cold_soda\", \"make_cereal\"]", 0), ("[\"cold_soda\", \"sparks.json\"]", 2)] {
        let file = STUDY.replacen("[\"cold_soda\", \"make_cereal\"]", missions, 1);
        let checked = run(COHABIT, &["study", "check", &scratch.write("solve.toml", &file), "--solve"]).unwrap();
        let [told, said] = [&checked.stdout, &checked.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
        assert_eq!(checked.status.code(), Some(code), "{told}{said}");
        assert!(told.contains("cold_soda: solved by the planner: "), "{told}");
        if code != 0 {
            assert!(told.contains("sparks.json: not solved by the planner: ") && told.contains("goal 0"), "{told}");
            assert!(said.contains("the planner does not solve sparks.json"), "{said}");
        }
    }
}

#[test]
fn links_let_in_and_nothing_else_does() {
    let scratch = study("study-links");
    let server = Server::start(&scratch, "0");
    for path in [
        "/",
        "/p/x",
        "/p/x/state",
        "/sign-up/x",
        "/experimenter/x",
        "/observer/x",
        "/observer/x/state",
        "/experimenter/x/state",
        "/nowhere",
    ] {
        let (head, body) = server.request("GET", path, "");
        assert!(head.starts_with("HTTP/1.1 404"), "{path}: {head}\n{body}");
    }
    let (head, _) = server.request("GET", &server.experimenter.replace("experimenter", "p"), "");
    assert!(head.starts_with("HTTP/1.1 404"), "{head}");
    // Who observes learns all but what lets somebody in, and changes nothing.
    let person = Person::sign_up(&server);
    person.agree(&server);
    let observer = server.get(&format!("{}/state", server.experimenter))["observer"].as_str().unwrap().to_owned();
    let seen = server.get(&format!("{observer}/state"));
    let row = &seen["participants"][0];
    assert_eq!((&row["participant"], &row["progress"], &row["link"]), (&json!("P01"), &json!("ready"), &Value::Null));
    assert!(!seen.to_string().contains(&person.link) && !seen.to_string().contains(&server.sign_up), "{seen}");
    for path in [format!("{observer}/command"), observer.replace("observer", "experimenter") + "/command"] {
        let (head, _) = server.request("POST", &path, "\"reserve\"");
        assert!(head.starts_with("HTTP/1.1 404"), "{path}: {head}");
    }
    let mut stream = TcpStream::connect(&server.host).unwrap();
    write!(stream, "GET {} HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n", server.experimenter).unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    assert!(text.starts_with("HTTP/1.1 403"), "{text}");
    let second =
        run(COHABIT, &["study", "run", &scratch.path("study.toml"), "--folder", &scratch.path("data"), "--port", "0"]);
    let second = second.unwrap();
    assert_eq!(second.status.code(), Some(4), "{}", String::from_utf8_lossy(&second.stderr));
    server.end();
}

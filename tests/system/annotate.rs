//! People annotate a data set: on pages, in a browser, and what comes of it.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

use cohabit_tests::{Browser, Scratch, Tab, files, run};
use serde_json::{Value, json};

use crate::{COHABIT, accessibility};

/// The longest that an answer is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);
const MISSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions/make_cereal.json");

/// What the program prints, and its exit code.
fn cohabit(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

/// A data set of one episode.
fn dataset(scratch: &Scratch, modalities: &str) -> String {
    let folder = scratch.path("data");
    let size = ["--size", "64x48", "--modalities", modalities];
    let (text, code) = cohabit(&[&["demonstrate", MISSION, "--out", &folder], &size[..]].concat());
    assert_eq!(code, Some(0), "{text}");
    folder
}

/// A running `cohabit annotate`. Dropping it kills it.
struct Server {
    child: Child,
    /// `host:port`.
    host: String,
    /// The path of each annotator's page.
    pages: Vec<String>,
}

impl Server {
    /// Serves a data set to these annotators, of whom one writes each text.
    fn start(folder: &str, names: &str) -> Self {
        Self::start_by(&mut Command::new(COHABIT), folder, names)
    }

    /// The same by a command that starts the program with the arguments that follow its own.
    fn start_by(command: &mut Command, folder: &str, names: &str) -> Self {
        let mut child = command
            .args(["annotate", folder, "--port", "0", "--names", names, "--per-segment", "1", "--watch", "episodes"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let mut server = Self { child, host: String::new(), pages: Vec::new() };
        for line in lines.by_ref().take_while(|line| !line.starts_with("Ctrl-C")) {
            let Some((_, address)) = line.split_once("http://") else { continue };
            let (host, path) = address.split_once('/').unwrap();
            host.clone_into(&mut server.host);
            server.pages.push(format!("/{path}"));
        }
        thread::spawn(move || lines.for_each(drop));
        assert_eq!(server.pages.len(), names.split(',').count(), "it did not start");
        server
    }

    /// The status of an answer, and its body.
    fn request(&self, head: &str, host: &str, body: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        let length = body.len();
        let more = "Connection: close\r\nContent-Type: application/json";
        write!(stream, "{head}\r\nHost: {host}\r\n{more}\r\nContent-Length: {length}\r\n\r\n{body}").unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let answer = String::from_utf8_lossy(&bytes).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().to_owned(), body.to_owned())
    }

    fn get(&self, path: &str) -> (String, String) {
        self.request(&format!("GET {path} HTTP/1.1"), &self.host, "")
    }

    /// What an annotator's page shows.
    fn state(&self, page: &str) -> Value {
        serde_json::from_str(&self.get(&format!("{page}/task")).1).unwrap()
    }

    fn send(&self, page: &str, what: &Value) -> Value {
        let head = format!("POST {page}/send HTTP/1.1");
        serde_json::from_str(&self.request(&head, &self.host, &what.to_string()).1).unwrap()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn only_who_has_a_link_gets_in_and_a_killed_server_loses_nothing() {
    let scratch = Scratch::new("annotate");
    let folder = dataset(&scratch, "color");
    let server = Server::start(&folder, "ana,bo");
    let ana = server.pages[0].clone();
    for path in ["/", "/a/00000000000000000000000000000000", "/a/", &format!("{ana}x")] {
        let (status, body) = server.get(path);
        assert!(status == "404" && body.contains("This link is not known"), "{path}: {status}: {body}");
    }
    for path in ["task", "picture/0/0"] {
        assert_eq!(server.get(&format!("/a/00000000000000000000000000000000/{path}")).0, "404", "{path}");
    }
    assert_eq!(server.request(&format!("GET {ana} HTTP/1.1"), "evil.example", "").0, "403");
    let origin = format!("POST {ana}/send HTTP/1.1\r\nOrigin: http://evil.example");
    assert_eq!(server.request(&origin, &server.host, "{}").0, "403");
    let (status, picture) = server.get(&format!("{ana}/picture/0/0"));
    assert!(status == "200" && picture.contains("PNG"));
    assert_eq!(server.get(&format!("{ana}/picture/0/9999")).0, "404");

    let before = server.state(&ana);
    let claim = &before["task"]["claim"];
    assert_eq!((&before["task"]["kind"], &before["annotator"]), (&json!("instruction"), &json!("ana")), "{before}");
    for (text, problem) in [(" \n".to_owned(), "Please write something"), ("x".repeat(501), "501 characters")] {
        let answer = server.send(&ana, &json!({ "annotation": { "claim": claim, "what": { "text": text } } }));
        assert!(answer["problem"].as_str().unwrap().contains(problem), "{answer}");
        assert_eq!(&answer["task"]["claim"], claim, "the task is still theirs");
    }
    let written = json!({ "annotation": { "claim": claim, "what": { "text": "Make me\ncereal" } } });
    for _ in 0..2 {
        let answer = server.send(&ana, &written);
        assert_eq!((&answer["problem"], &answer["done"], &answer["task"]), (&Value::Null, &json!(1), &Value::Null));
    }
    // One at a time serves a data set.
    let (text, code) = cohabit(&["annotate", &folder, "--port", "0", "--per-segment", "1"]);
    assert!(code == Some(4) && text.contains("in use by another `cohabit annotate`"), "{code:?}: {text}");
    drop(server);

    let server = Server::start(&folder, "ana,bo");
    assert_eq!(server.pages[0], ana, "links stay");
    let state = server.state(&ana);
    assert_eq!(state["own"], json!([{ "id": 0, "kind": "instruction", "text": "Make me cereal" }]));
    let corrected = server.send(&ana, &json!({ "correction": { "id": 0, "text": "Make cereal" } }));
    assert_eq!((&corrected["problem"], &corrected["own"][0]["text"]), (&Value::Null, &json!("Make cereal")));
    let foreign = server.send(&server.pages[1], &json!({ "correction": { "id": 0, "text": "mine" } }));
    assert!(foreign["problem"].as_str().unwrap().contains("no such text of yours"), "{foreign}");
    let asked = server.state(&server.pages[1]);
    assert_eq!((&asked["task"]["kind"], &asked["task"]["instruction"]), (&json!("question"), &json!("Make cereal")));
    drop(server);

    for _ in 0..2 {
        let (text, code) = cohabit(&["annotate", &folder, "--export"]);
        assert!(code == Some(0) && text.contains("1 instructions, 0 questions and 0 answers in 1 episodes"), "{text}");
    }
    let (text, code) = cohabit(&["annotate", &folder, "--agreement"]);
    assert!(code == Some(0) && text.contains("instructions: 1 texts, 0 skipped"), "{text}");
    assert!(files(folder.as_ref()).keys().any(|path| path.ends_with("annotations/agreement.csv")));
}

#[test]
#[cfg_attr(not(mounts), ignore = "optional: the right to mount a file system (`unshare -rm`)")]
fn on_a_full_disk_the_page_hears_that_nothing_was_saved() {
    let scratch = Scratch::new("annotate-full");
    let folder = dataset(&scratch, "color");
    let annotations = format!("{folder}/annotations");
    fs::create_dir(&annotations).unwrap();
    // Room for the links and 4096 bytes of the journal.
    let small = "mount -t tmpfs -o size=8k tmpfs \"$1\" && shift && exec \"$0\" \"$@\"";
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", small, COHABIT, &annotations]);
    let server = Server::start_by(&mut command, &folder, "ana");
    let ana = &server.pages[0];
    let claim = server.state(ana)["task"]["claim"].clone();
    let mut kept = "Make cereal".to_owned();
    let written = server.send(ana, &json!({ "annotation": { "claim": claim, "what": { "text": kept } } }));
    assert_eq!(written["problem"], Value::Null);
    let problem = (0..10).find_map(|number| {
        let text = format!("{number}{}", "\u{1f600}".repeat(490));
        let answer = server.send(ana, &json!({ "correction": { "id": 0, "text": text } }));
        if answer["problem"].is_null() {
            kept = text;
        }
        answer["problem"].as_str().map(str::to_owned)
    });
    assert!(problem.as_ref().is_some_and(|problem| problem.starts_with("Nothing was saved")), "{problem:?}");
    assert_eq!(server.state(ana)["own"][0]["text"], json!(kept), "what was saved before is there");
}

#[test]
fn wrong_calls_end_with_one_message() {
    let scratch = Scratch::new("annotate-wrong");
    let refused = |arguments: &[&str], expected_code: i32, expected: &str| {
        let (text, code) = cohabit(&[&["annotate"], arguments].concat());
        assert!(code == Some(expected_code) && text.contains(expected), "{code:?}: {text}");
    };
    let none = scratch.path("none");
    for more in [&["--agreement"][..], &["--export"], &[]] {
        refused(&[&[none.as_str()], more].concat(), 2, "no finished data set of `cohabit demonstrate`");
    }
    let folder = dataset(&scratch, "color");
    refused(&[&folder, "--agreement"], 2, "nobody has annotated it yet");
    refused(&[&folder, "--names", "a b"], 2, "`a b` cannot be a pseudonym");
    refused(&[&folder, "--annotators", "2"], 2, "by 3 people, and there are 2");
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    refused(&[&folder, "--annotators", "3", "--port", &port], 4, "choose another with `--port`");
    let journal = format!("{folder}/annotations/journal.jsonl");
    fs::write(&journal, "nonsense\n").unwrap();
    refused(&[&folder], 2, "journal.jsonl:1: ");
    fs::remove_file(&journal).unwrap();
    let steps = format!("{folder}/episodes/000000/steps.jsonl");
    let whole = fs::read(&steps).unwrap();
    fs::write(&steps, &whole[..whole.len() / 2]).unwrap();
    refused(&[&folder], 2, "steps.jsonl");
    let bare = Scratch::new("annotate-bare");
    refused(&[&dataset(&bare, "none")], 2, "make it anew with `--modalities color`");
}

/// Types a text into the page's field, and sends it.
fn write(tab: &mut Tab, text: &str) {
    tab.evaluate("document.querySelector('#text').focus()").unwrap();
    tab.call("Input.insertText", &json!({ "text": text })).unwrap();
    tab.evaluate("document.querySelector('#send').click()").unwrap();
}

fn wait_for_title(tab: &mut Tab, title: &str) {
    tab.wait_until(&format!("document.querySelector('#title').textContent === '{title}'")).unwrap();
}

/// Presses a key in the element that has the focus.
fn press(tab: &mut Tab, key: &str) {
    for kind in ["keyDown", "keyUp"] {
        tab.call("Input.dispatchKeyEvent", &json!({ "type": kind, "key": key })).unwrap();
    }
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn two_people_annotate_an_episode_in_a_browser() {
    let scratch = Scratch::new("annotate-browser");
    let folder = dataset(&scratch, "color");
    let server = Server::start(&folder, "ana,bo");
    let browser = Browser::start().unwrap();
    let address = |number: usize| format!("http://{}{}", server.host, server.pages[number]);
    let mut stranger = browser.open(&format!("http://{}/a/unknown", server.host), 390, 844).unwrap();
    stranger.wait_until("document.querySelector('h1')?.textContent === 'This link is not known'").unwrap();
    accessibility::check(&mut stranger, "a link that no annotator has");
    let mut ana = browser.open(&address(0), 390, 844).unwrap();
    wait_for_title(&mut ana, "What would you tell the robot?");
    // The pictures are there, and are played by the keyboard alone.
    ana.wait_until("document.querySelector('#picture').naturalWidth === 64").unwrap();
    accessibility::check(&mut ana, "an annotator's page with a segment");
    accessibility::check_keyboard(&mut ana, "an annotator's page with a segment");
    let at = "document.querySelector('#scrub').value";
    ana.evaluate("document.querySelector('#film').focus()").unwrap();
    press(&mut ana, "ArrowRight");
    assert_eq!(ana.evaluate(at).unwrap(), json!("1"));
    press(&mut ana, "Home");
    assert_eq!(ana.evaluate(at).unwrap(), json!("0"));
    press(&mut ana, " ");
    ana.wait_until(&format!("Number({at}) > 0")).unwrap();
    press(&mut ana, " ");
    assert_eq!(ana.evaluate("document.querySelector('#play').textContent").unwrap(), json!("Play"));
    assert_eq!(ana.evaluate("document.documentElement.scrollWidth <= 390").unwrap(), json!(true));
    // What is typed outlasts a reload.
    ana.evaluate("document.querySelector('#text').focus()").unwrap();
    ana.call("Input.insertText", &json!({ "text": "Make me " })).unwrap();
    ana.call("Page.reload", &json!({})).unwrap();
    ana.wait_until("document.querySelector('#text')?.value === 'Make me '").unwrap();
    write(&mut ana, "cereal");
    wait_for_title(&mut ana, "Nothing to do at the moment");
    accessibility::check(&mut ana, "an annotator's page without a task");

    let mut bo = browser.open(&address(1), 1280, 800).unwrap();
    wait_for_title(&mut bo, "What would you ask?");
    assert_eq!(bo.evaluate("document.querySelector('#read dd').textContent").unwrap(), json!("Make me cereal"));
    assert_eq!(bo.evaluate("document.querySelector('#scrub').max").unwrap(), json!("0"), "before the first step");
    bo.evaluate("document.querySelector('#send').click()").unwrap();
    bo.wait_until("document.querySelector('#problem').textContent.startsWith('Please write something')").unwrap();
    accessibility::check(&mut bo, "an annotator's page that lacks a text");
    bo.evaluate("document.querySelector('#skip').click()").unwrap();
    bo.wait_until("document.querySelectorAll('#reasons [data-reason]').length === 3").unwrap();
    accessibility::check(&mut bo, "the question why a task is skipped");
    press(&mut bo, "Escape");
    bo.evaluate("document.querySelector('#skip-card').close()").unwrap();
    write(&mut bo, "Which bowl?");
    wait_for_title(&mut bo, "Nothing to do at the moment");

    // Her page goes on by itself; she corrects what she wrote before.
    wait_for_title(&mut ana, "What is the answer?");
    assert_eq!(ana.evaluate("document.querySelectorAll('#read dd')[1].textContent").unwrap(), json!("Which bowl?"));
    ana.evaluate("document.querySelector('#own-list button').click()").unwrap();
    ana.wait_until("document.querySelector('#own-card').open").unwrap();
    accessibility::check(&mut ana, "a text of an annotator's that is corrected");
    ana.evaluate("document.querySelector('#own-text').value = 'Make cereal'").unwrap();
    ana.evaluate("document.querySelector('#own-form .chief').click()").unwrap();
    ana.wait_until("!document.querySelector('#own-card').open").unwrap();
    write(&mut ana, "The \"red\" one");
    wait_for_title(&mut ana, "Nothing to do at the moment");
    let problems: Vec<_> = ana.problems().iter().chain(bo.problems()).collect();
    assert_eq!(problems, [] as [&String; 0]);

    drop((ana, bo, stranger, browser, server));
    let (text, code) = cohabit(&["annotate", &folder, "--export", "--agreement"]);
    assert!(code == Some(0) && text.contains("1 instructions, 1 questions and 1 answers"), "{text}");
    let episode = fs::read_to_string(format!("{folder}/episodes/000000/episode.json")).unwrap();
    let human = &serde_json::from_str::<Value>(&episode).unwrap()["human"];
    assert_eq!(human["instructions"][0]["text"], json!("Make cereal"), "{human}");
    let asked = &human["questions"][0];
    assert_eq!((&asked["annotator"], &asked["instruction"]), (&json!("bo"), &json!("Make me cereal")), "{human}");
    let answer = json!([{ "annotator": "ana", "question": "Which bowl?", "text": "The \"red\" one" }]);
    assert_eq!(asked["answers"], answer, "{human}");
}

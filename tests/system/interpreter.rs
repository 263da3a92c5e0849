//! A language model says what people mean where the robot is not sure, or always; here one that was recorded.

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    thread,
};

use cohabit_record::Log;
use cohabit_tests::{Page, Play};
use serde_json::Value;

use crate::COHABIT;

const RECORDED: &str = include_str!("data/language_model.json");
const KEY: &str = "a-secret-key";

/// Serves the recorded answers for as long as the test runs; its address.
fn model() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/v1", listener.local_addr().unwrap());
    thread::spawn(move || {
        for stream in listener.incoming() {
            answer(stream.unwrap());
        }
    });
    address
}

fn answer(stream: TcpStream) {
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let mut head = String::new();
    while !head.ends_with("\r\n\r\n") {
        reader.read_line(&mut head).unwrap();
    }
    let head = head.to_lowercase();
    let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")).unwrap().parse().unwrap();
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    let question: Value = serde_json::from_slice(&body).unwrap();
    let asked = question["messages"].as_array().unwrap().last().unwrap()["content"].clone();
    let recorded: Vec<Value> = serde_json::from_str(RECORDED).unwrap();
    let known = recorded.iter().find(|one| one["utterance"] == asked);
    let is_let_in =
        head.starts_with("post /v1/chat/completions ") && head.contains(&format!("authorization: bearer {KEY}"));
    let (status, text) = match known.filter(|_| is_let_in) {
        Some(one) => ("200 OK", one["answer"].to_string()),
        None => ("404 Not Found", "{}".to_owned()),
    };
    let mut stream = stream;
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n{text}",
        text.len()
    )
    .unwrap();
}

fn robot_says(page: &Page, part: &str) -> bool {
    page.chat.iter().any(|(from, text)| from == "robot" && text.contains(part))
}

#[test]
fn a_language_model_proposes_and_the_robot_checks() {
    let address = model();
    let environment =
        [("COHABIT_MODEL_URL", address.as_str()), ("COHABIT_MODEL", "recorded"), ("COHABIT_MODEL_KEY", KEY)];
    let play =
        Play::start_in(COHABIT, &["make_cereal", "--knows", "everything", "--speed", "4"], &environment).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    // What the robot understands nobody is asked about.
    page.do_and_wait("where is the milk?").unwrap();
    assert!(!robot_says(&page, "let me think"), "{:?}", page.chat);
    page.do_and_wait("My tummy is grumbling, be a hero and get yourself over to where the milk lives").unwrap();
    for said in [
        "One moment, let me think.",
        "I take that as: \"go to the break room, then open the fridge\".",
        "the fridge is open",
    ] {
        let is_said = robot_says(&page, said) || robot_says(&page, &said.replace("the fridge", "The fridge"));
        assert!(is_said, "{said}: {:?}", page.chat);
    }
    // What it proposes must be understood, or else nothing is done.
    page.do_and_wait("Blorp the zargle").unwrap();
    assert!(robot_says(&page, "I do not know the words"), "{:?}", page.chat);
    // One that is not to be had costs a moment.
    page.do_and_wait("Snorf the wibble").unwrap();
    let refusals = page.chat.iter().filter(|(_, text)| text.contains("I do not know the words")).count();
    assert_eq!(refusals, 2, "{:?}", page.chat);
    play.end().unwrap();
}

#[test]
fn a_language_model_is_asked_always_where_it_shall_be_and_what_it_said_is_in_the_log() {
    let address = model();
    let environment =
        [("COHABIT_MODEL_URL", address.as_str()), ("COHABIT_MODEL", "recorded"), ("COHABIT_MODEL_KEY", KEY)];
    let arguments = ["make_cereal", "--knows", "everything", "--speed", "4", "--model", "always"];
    let play = Play::start_in(COHABIT, &arguments, &environment).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for (said, answer) in [
        // What both take for the same is done without a word about it.
        ("where is the milk?", "The milk is in the fridge"),
        ("do robots dream of electric sheep?", "Of full batteries, I suppose."),
        ("fetch me the whatsit", "Do you mean the spoon?"),
    ] {
        page.do_and_wait(said).unwrap();
        assert!(robot_says(&page, answer), "{said}: {:?}", page.chat);
    }
    assert!(!robot_says(&page, "I take that as"), "{:?}", page.chat);
    let ended = play.end().unwrap();
    let log = Log::open(&ended.log).unwrap();
    let notes: Vec<&str> =
        log.dialog.iter().filter(|entry| entry.kind == "Interpreted").map(|entry| entry.text.as_str()).collect();
    assert_eq!(notes.len(), 3, "{notes:?}");
    assert!(notes[0].contains(" ms: ") && notes[0].contains("\"total_tokens\":1321"), "{notes:?}");
    assert!(notes.iter().all(|note| !note.contains(KEY)), "{notes:?}");
    let settings = &log.session.settings;
    assert_eq!((settings["model"].as_str(), settings["model_asked"].as_str()), ("recorded", "always"));
    assert_eq!(settings["model_address"], format!("{address}/chat/completions"));
    assert!(settings.contains_key("recognizer") && settings.contains_key("synthesizer"), "{settings:?}");
    assert!(settings.values().all(|value| !value.contains(KEY)), "{settings:?}");
}

#[test]
fn a_language_model_without_a_name_is_refused_at_the_start() {
    let environment = [("COHABIT_MODEL_URL", "http://127.0.0.1:1/v1"), ("COHABIT_MODEL", "")];
    let error = Play::start_in(COHABIT, &["make_cereal"], &environment).err().unwrap();
    assert!(format!("{error:#}").contains("COHABIT_MODEL is not: name the model to ask"), "{error:#}");
}

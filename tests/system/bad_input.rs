//! What is wrong with what a user gave is said in one message, with exit code 2, what the machine lacks with exit code 4, and
//! nothing is left running.

use std::{
    fs,
    net::TcpListener,
    path::PathBuf,
    sync::atomic::{AtomicU32, Ordering},
};

use cohabit_tests::run;

use crate::COHABIT;

/// A mission file with this text, in a folder of its own.
fn file(name: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cohabit-bad-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

/// Plays with these arguments, and finds exit code 2 and a message that names `parts`.
fn check(arguments: &[&str], parts: &[&str]) {
    check_code(2, arguments, parts);
}

fn check_code(code: i32, arguments: &[&str], parts: &[&str]) {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let session = format!("bad{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let mut all = vec!["play", "--session", &session];
    all.extend(arguments);
    let output = run(COHABIT, &all).unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    for part in parts {
        assert!(text.contains(part), "{arguments:?}: no `{part}` in {text}");
    }
    assert!(!text.contains("panicked"), "{text}");
    let left = fs::read_dir("/dev/shm").unwrap().flatten();
    assert_eq!(left.filter(|entry| entry.file_name().to_string_lossy().contains(&session)).count(), 0);
}

const MISSION: &str = r#"{"goal_text": "g", "task_description": "d", "scene": {"floor_plan": "0", "scene_id": "s",
 "simbot_init": [], "roomLocation": ["BreakRoom"], "layoutOverride": "LAYOUT", "required_objects": [{"name": "OBJECT",
 "state": [], "location": [], "roomLocation": ["BreakRoom"], "colors": []}], "sticky_notes": null}, "task_goals": [],
 "stateconditions": []}"#;

#[test]
fn each_mistake_is_named() {
    let mission = |layout: &str, object: &str| MISSION.replace("LAYOUT", layout).replace("OBJECT", object);
    let path = |name: &str, text: &str| file(name, text).to_str().unwrap().to_owned();
    check(&["/nowhere/mission.json"], &["/nowhere/mission.json"]);
    check(&[&path("broken.json", "{\"scene\": [1, 2")], &["broken.json:1:"]);
    check(&[&path("object.json", &mission("OfficeLayout1", "Bowl_1"))], &["object.json", "Bowl_1", "Bowl_01"]);
    check(&[&path("layout.json", &mission("OfficeLayout9", "Bowl_01_1"))], &["layout.json", "OfficeLayout9"]);
    check(&["--log", &path("taken.mcap", "x")], &["taken.mcap"]);
    check(&["--log", "/nowhere/logs/x.mcap"], &["/nowhere/logs: there is no such folder: make it first"]);
    check(&["--tls-certificate", "/nowhere/c.pem", "--tls-key", "/nowhere/k.pem"], &["/nowhere/c.pem"]);
    let _ = fs::remove_dir_all(file("x", "").parent().unwrap());
}

#[test]
fn a_session_name_that_cannot_be_one_is_named() {
    let output = run(COHABIT, &["play", "--session", "no/such name"]).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no/such name"));
}

#[test]
fn a_port_in_use_is_named() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    // That is the machine's matter: the same command may succeed later.
    check_code(4, &["--port", &port], &[&port, "--port"]);
    let log = std::env::temp_dir().join(format!("cohabit-refused-{}.mcap", std::process::id()));
    let output = run(COHABIT, &["play", "--port", &port, "--log", log.to_str().unwrap()]).unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(!said.contains("Playing") && !log.exists(), "nothing is started: {said}");
}

#[test]
fn a_camera_that_cannot_be_is_named() {
    check(&["--camera", "door=drone"], &["--camera", "drone", "third-person, fixed, top-down"]);
    check(&["--camera", "door=fixed,x=4"], &["needs `y=`"]);
    check(&["--camera", "a=egocentric,size=5000"], &["5000x5000", "16 to 4096"]);
    check(&["--camera", "a=egocentric,body=4", "--port", "0"], &["body 4", "bodies 0 to 0", "--body"]);
    check(&["--camera", "a=egocentric", "--camera", "a=panorama"], &["two cameras are called `a`"]);
}

#[test]
fn the_help_has_all_options_that_every_camera_has() {
    for command in ["play", "sim"] {
        let output = run(COHABIT, &[command, "--help"]).unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        for option in ["size=", "rate=", "planes=", "smooth="] {
            assert!(text.contains(option), "{command}: no `{option}` in {text}");
        }
    }
}

#[test]
fn an_agent_that_cannot_be_is_named() {
    check(&["--agent", "butler"], &["butler", "dialog, random, scripted, helper"]);
    check(&["--agent", "helper@3"], &["`--agent helper@3`", "bodies 0 to 0", "--body"]);
    check(&["--agent", "dialog", "--agent", "random"], &["`--agent random@0`", "`dialog@0`"]);
    let script = file("steps.txt", "wait 1\njump\n");
    let name = script.to_str().unwrap();
    check(&["--agent", &format!("scripted={name}")], &[&format!("{name}:2: there is no `jump`")]);
}

#[test]
fn a_name_for_nobody_is_named() {
    check(&["--name", "1=Rosie"], &["`--name 1=Rosie`", "bodies 0 to 0", "--body"]);
}

#[test]
fn a_world_pack_that_rerun_cannot_show_is_said_at_once() {
    check(&["make_tea", "--world", "homes", "--rerun"], &["`--rerun` cannot show a session of a world pack"]);
}

#[test]
fn a_file_that_is_no_log_is_not_replayed() {
    let path = file("no-log.mcap", "hello");
    let output = run(COHABIT, &["replay", path.to_str().unwrap()]).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no-log.mcap"));
}

#[test]
fn what_is_made_of_a_log_overwrites_no_log() {
    const LOG: &[u8] = b"\x89MCAP0\r\nwhat was recorded";
    let path = file("recorded.mcap", "");
    fs::write(&path, LOG).unwrap();
    let recorded = path.to_str().unwrap();
    for arguments in [
        &["replay", "--rerun", recorded, "other.mcap"][..],
        &["replay", "other.mcap", "--video", recorded],
        &["compare", "one.mcap", "other.mcap", "--out", recorded],
    ] {
        let output = run(COHABIT, arguments).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("recorded.mcap: this is a session log"), "{arguments:?}: {text}");
        assert_eq!(fs::read(&path).unwrap(), LOG, "{arguments:?}");
    }
}

#[test]
fn what_a_replay_would_pass_over_is_named() {
    for (arguments, parts) in [
        (&["--camera", "eyes/0"][..], &["--frames", "--video"][..]),
        (&["--modality", "depth"], &["--frames", "--video"]),
        (&["--size", "64x48"], &["--frames", "--video"]),
        (&["--branch", "0:20", "--renderer", "cpu"], &["--branch", "--renderer"]),
    ] {
        let output = run(COHABIT, &[&["replay", "no.mcap"], arguments].concat()).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(parts.iter().all(|part| text.contains(part)) && !text.contains("no such file"), "{text}");
    }
}

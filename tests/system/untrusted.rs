//! Files that nobody should trust: logs in which little or nothing is to be compared, text that would control a terminal, and
//! missions of any size.

use std::{fs, path::Path};

use cohabit_cdf::mission::builtin;
use cohabit_record::{Log, LogWriter, SessionEntry, TickEntry};
use cohabit_tests::{Play, Scratch, run};
use serde_json::{Value, json};

use crate::COHABIT;

/// What would clear a terminal, change its title, and turn letters round.
const CONTROLS: &str = "\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\u{202e}Soup\r\n";

/// What is printed when a command runs with these arguments, and its exit code.
fn printed(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

fn mission() -> Value {
    let (_, text) = builtin().iter().find(|(name, _)| *name == "cold_soda.json").unwrap();
    serde_json::from_str(text).unwrap()
}

fn session(mission: &Value) -> SessionEntry {
    let entry = json!({
        "format": SessionEntry::FORMAT, "program": "0", "session": "s", "mission_file": format!("{CONTROLS}.json"),
        "mission_text": mission.to_string(), "seed": 7,
    });
    serde_json::from_value(entry).unwrap()
}

fn write_log(path: &str, mission: &Value, ticks: &[u64]) {
    let mut log = LogWriter::create(Path::new(path), &session(mission), 1).unwrap();
    for number in ticks {
        log.tick(&TickEntry { tick: *number, digest: "00".to_owned(), wall_nanos: *number, inputs: Vec::new() })
            .unwrap();
    }
    log.finish().unwrap();
}

fn check_is_plain(text: &str) {
    let found = text.chars().find(|character| character.is_control() && *character != '\n' || *character == '\u{202e}');
    assert_eq!(found, None, "{text:?}");
}

#[test]
fn nothing_is_said_to_agree_where_nothing_was_compared() {
    let scratch = Scratch::new("compared");
    for (name, ticks, part) in [
        ("empty", &[][..], "nothing was compared: the log has no tick"),
        ("disorder", &[2, 1], "not in their order: tick 1 follows tick 2"),
        ("twice", &[1, 1], "not in their order: tick 1 follows tick 1"),
        ("late", &[7, 8], "begins after tick 6 without a snapshot"),
        ("other", &[1, 2], "tick 1 differs"),
    ] {
        let path = scratch.path(name);
        write_log(&path, &mission(), ticks);
        let (text, code) = printed(&["replay", &path]);
        assert!(matches!(code, Some(1 | 2)), "{name}: {code:?}: {text}");
        assert!(text.contains(part) && !text.contains("no tick differs"), "{name}: {text}");
        check_is_plain(&text);
    }
}

#[test]
fn text_of_missions_and_logs_controls_no_terminal() {
    let scratch = Scratch::new("terminal");
    let mut mission = mission();
    mission["goal_text"] = json!(CONTROLS);
    mission["task_goals"][0]["description"] = json!(CONTROLS);
    mission["task_goals"][0]["nonsense\u{1b}[2J"] = json!(CONTROLS);
    let log = scratch.path("log");
    write_log(&log, &mission, &[1]);
    let (text, _) = printed(&["replay", &log, "--at", "tick:0"]);
    assert!(text.contains("Soup") && text.contains(r"\u{1b}[2J"), "{text}");
    check_is_plain(&text);
    let file = scratch.write("\u{1b}[2Jmission.json", &mission.to_string());
    for arguments in [&["check", &file][..], &["check", "--json", &file], &["check", "--quiet", &scratch.path("")]] {
        let (text, _) = printed(arguments);
        check_is_plain(&text);
    }
    let mut play = Play::spawn(COHABIT, &[&file]).unwrap();
    let line = play.wait_for_line("Playing").unwrap();
    assert!(line.contains("Soup"), "{line}");
    check_is_plain(&line);
    play.wait_until_ready().unwrap();
    let ended = play.end().unwrap();
    let (text, code) = printed(&["replay", ended.log.to_str().unwrap()]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("no tick differs: compared all "), "{text}");
    assert!(Log::open(&ended.log).unwrap().problems().is_empty());
    check_is_plain(&text);
}

/// A mission with so many apples, notes, or levels, or so long a text.
#[test]
fn missions_beyond_all_size_are_refused_with_their_place() {
    let scratch = Scratch::new("size");
    let with = |pointer: &str, key: &str, value: Value| {
        let mut mission = mission();
        mission.pointer_mut(pointer).unwrap()[key] = value;
        mission.to_string()
    };
    let apples = |count: usize| {
        let apple = |number| json!({"name": format!("Apple_{number}"), "roomLocation": ["BreakRoom"]});
        Value::from((1..=count).map(apple).collect::<Vec<_>>())
    };
    let note = |number| json!({"name": format!("StickyNote_{number}"), "text": "x", "room": "Lab1", "location": 0});
    let notes: Vec<_> = (0..8000).map(note).collect();
    let deep = format!("{{\"scene\": {}1{}}}", "{\"a\":".repeat(100_000), "}".repeat(100_000));
    for (name, text, place) in [
        ("apples", with("/scene", "required_objects", apples(2000)), "/scene/required_objects: the list is too long"),
        ("notes", with("/scene", "sticky_notes", notes.into()), "/scene/sticky_notes: the list is too long"),
        ("text", with("", "goal_text", json!("x".repeat(500_000))), "/goal_text: the text is too long"),
        ("deep", deep, "nested too deep"),
        ("million", with("/scene", "required_objects", apples(1_000_000)), "the mission has "),
        ("long", with("", "goal_text", json!("x".repeat(30_000_000))), "the mission has "),
    ] {
        let file = scratch.write(&format!("{name}.json"), &text);
        let (told, code) = printed(&["check", &file]);
        assert_eq!(code, Some(2), "{name}: {told}");
        assert!(told.contains(place) && told.contains("at most"), "{name}: {told}");
        let (told, code) = printed(&["play", &file]);
        assert_eq!(code, Some(2), "{name}: {told}");
        assert!(told.contains("most"), "{name}: {told}");
        fs::remove_file(file).unwrap();
    }
}

/// What `play` finds no place for, `check` does not call playable.
#[test]
fn what_cannot_be_laid_out_is_not_playable() {
    let scratch = Scratch::new("room");
    let mut mission = mission();
    // No surface takes so many computers, nor does the floor of the room.
    let desk = |number: usize| json!({"name": format!("ForkLift_{}", number + 2), "roomLocation": ["SmallOffice"]});
    let objects = mission["scene"]["required_objects"].as_array_mut().unwrap();
    let before = objects.len();
    objects.extend((0..100).map(desk));
    let file = scratch.write("crowded.json", &mission.to_string());
    let (told, code) = printed(&["check", &file]);
    assert_eq!(code, Some(2), "{told}");
    let line = told.lines().find(|line| line.contains("no free place")).unwrap_or_else(|| panic!("{told}"));
    let index: usize =
        line.split_once("/scene/required_objects/").unwrap().1.split(':').next().unwrap().parse().unwrap();
    assert!((before..before + 100).contains(&index), "{line}");
    assert!(told.contains("crowded.json: not playable: 1 error"), "{told}");
    let lines = scratch.write("many.jsonl", &format!("{{\"id\": \"a\", \"cdf\": {mission}}}\n"));
    let (told, _) = printed(&["check", &lines]);
    assert!(told.contains("/cdf/scene/required_objects/"), "{told}");
}

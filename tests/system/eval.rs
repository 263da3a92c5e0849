//! Missions played by the program headless, in many ways.

use std::path::{Path, PathBuf};

use cohabit_tests::{reference_data, run};
use serde_json::Value;

use crate::COHABIT;

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cohabit-eval-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn builtin() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cdf/missions").to_str().unwrap().to_owned()
}

/// Runs `cohabit eval` and gives its report and what it printed.
fn eval(folder: &Path, arguments: &[&str]) -> (Value, String) {
    let report = folder.join("report.json");
    let all = [&["eval"], arguments, &["--report", report.to_str().unwrap()]].concat();
    let output = run(COHABIT, &all).unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(&report).unwrap();
    (serde_json::from_str(&text).unwrap(), String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn the_built_in_missions_are_solved_and_their_logs_replay() {
    let folder = folder("builtin");
    let (report, printed) = eval(&folder, &[&builtin(), "--workers", "2", "--record", folder.to_str().unwrap()]);
    let missions = report["missions"].as_array().unwrap();
    assert!(missions.len() >= 4, "{printed}");
    for mission in missions {
        assert_eq!(mission["success"], true, "{mission:#}");
        assert_eq!(mission["goals_met"], mission["goals"]);
        assert!(mission["actions"].as_u64().unwrap() > 0 && mission["ticks"].as_u64().unwrap() > 0, "{mission:#}");
        let replayed = run(COHABIT, &["replay", mission["log"].as_str().unwrap()]).unwrap();
        let text = String::from_utf8_lossy(&replayed.stdout).into_owned();
        assert!(text.contains("no tick differs"), "{text}");
    }
    assert_eq!(report["total"]["solved"], missions.len());
    assert!(printed.contains("95 % interval"), "{printed}");
}

#[test]
fn a_mission_stops_at_its_caps() {
    let folder = folder("caps");
    let (report, _) = eval(&folder, &[&builtin(), "--only", "make_cereal", "--caps=3,10"]);
    let mission = &report["missions"][0];
    assert_eq!(
        (&mission["success"], &mission["ended_early"]),
        (&false.into(), &"too many actions".into()),
        "{mission:#}"
    );
    assert!(!mission["open_goals"].as_array().unwrap().is_empty());
}

#[test]
fn a_log_of_an_earlier_call_is_said_before_anything_is_played() {
    let folder = folder("twice");
    std::fs::write(folder.join("make_cereal.mcap"), "of an earlier call").unwrap();
    let record = ["--only", "make_cereal", "--record", folder.to_str().unwrap()];
    let again = run(COHABIT, &[&["eval", builtin().as_str()], &record[..]].concat()).unwrap();
    let text = String::from_utf8_lossy(&again.stderr).into_owned();
    assert!(again.status.code() == Some(2) && text.contains("make_cereal.mcap: there is a log"), "{again:?}");
}

#[test]
fn what_failed_first_is_told() {
    let folder = folder("trouble");
    let mission = Path::new(&builtin()).join("cold_soda.json");
    let script = folder.join("wrong.script");
    std::fs::write(&script, "pick up the soda can\npick up the unicorn\n{\"type\": \"Toggle\", \"toggle\": {\"object\": {\"id\": \"Nothing_1\"}}}\n").unwrap();
    std::fs::copy(&mission, folder.join("alone.json")).unwrap();
    let alone = folder.join("alone.json");
    let (report, _) = eval(&folder, &[alone.to_str().unwrap(), "--script", script.to_str().unwrap()]);
    let trouble = &report["missions"][0]["first_trouble"];
    assert_eq!(trouble["line"], "pick up the unicorn");
    let why = trouble["why"].as_str().unwrap();
    assert!(why.starts_with("nobody answers: ") && why.contains("unicorn"), "{trouble}");
}

#[test]
fn the_expert_solves_missions_from_their_goals_alone_and_its_logs_replay() {
    let folder = folder("expert");
    let missions = folder.join("missions");
    std::fs::create_dir_all(&missions).unwrap();
    for entry in std::fs::read_dir(builtin()).unwrap() {
        let path = entry.unwrap().path();
        // No script goes along: nothing is said.
        if path.extension().is_some_and(|extension| extension == "json") {
            std::fs::copy(&path, missions.join(path.file_name().unwrap())).unwrap();
        }
    }
    let logs = folder.join("logs");
    let arguments =
        [missions.to_str().unwrap(), "--agent", "expert", "--workers", "2", "--record", logs.to_str().unwrap()];
    let (report, printed) = eval(&folder, &arguments);
    let played = report["missions"].as_array().unwrap();
    assert!(played.len() >= 4, "{printed}");
    for mission in played {
        assert_eq!(mission["success"], true, "{mission:#}");
        let replayed = run(COHABIT, &["replay", mission["log"].as_str().unwrap()]).unwrap();
        let text = String::from_utf8_lossy(&replayed.stdout).into_owned();
        assert!(text.contains("no tick differs"), "{text}");
    }
    let line = serde_json::json!({ "id": "one", "cdf": { "scene": {} } });
    let file = folder.join("silent.jsonl");
    std::fs::write(&file, format!("{line}\n")).unwrap();
    let silent = run(COHABIT, &["eval", file.to_str().unwrap()]).unwrap();
    let text = String::from_utf8_lossy(&silent.stderr).into_owned();
    assert!(text.contains("silent.jsonl:1: nothing says what to do in it"), "{text}");
}

#[test]
fn a_report_for_which_there_is_no_room_is_said() {
    let arguments = ["eval", &builtin(), "--agent", "expert", "--only", "cold_soda", "--report", "/dev/full"];
    let output = run(COHABIT, &arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(4) && text.contains("/dev/full"), "{output:?}");
}

#[test]
fn bad_sources_are_refused_with_their_place() {
    let folder = folder("bad");
    let bad = folder.join("missions.jsonl");
    std::fs::write(&bad, "{\"id\": \"one\", \"utterances\": [], \"cdf\": {}}\n{\"id\": \"two\"\n").unwrap();
    for (arguments, expected) in [
        (vec![bad.to_str().unwrap()], "missions.jsonl:2"),
        (vec!["/nowhere/at/all.jsonl"], "/nowhere/at/all.jsonl"),
        (vec![folder.to_str().unwrap()], "no missions in it"),
    ] {
        let output = run(COHABIT, &[&["eval"], arguments.as_slice()].concat()).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn nearly_all_real_missions_are_solved_by_what_their_users_said() {
    let data = reference_data();
    let folder = folder("missions");
    let (report, printed) = eval(&folder, &[data.join("missions-dev.jsonl").to_str().unwrap()]);
    let solved = report["total"]["solved"].as_u64().unwrap();
    println!("{solved} solved");
    // 376 of 382 when this was written.
    assert!(solved >= 375, "{printed}");
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_expert_solves_nearly_all_real_missions() {
    let folder = folder("expert-missions");
    let data = reference_data().join("missions-dev.jsonl");
    let (report, printed) = eval(&folder, &[data.to_str().unwrap(), "--agent", "expert"]);
    let (solved, all) = (report["total"]["solved"].as_u64().unwrap(), report["total"]["missions"].as_u64().unwrap());
    println!("{solved} of {all} solved");
    assert!(solved * 100 >= all * 99, "{printed}");
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_data_set_of_sessions_is_played() {
    let data = reference_data();
    let folder = folder("sessions");
    let (report, printed) = eval(&folder, &[data.join("human-sessions-dev.json").to_str().unwrap()]);
    let missions = report["missions"].as_array().unwrap();
    let of =
        |kind: &str| missions.iter().filter(|task| task["id"].as_str().unwrap().contains(kind)).collect::<Vec<_>>();
    assert_eq!(of("#human").len(), 6);
    assert!(of("#expert").iter().all(|task| task["success"] == true), "{printed}");
}

//! Mission files as whole: the project's own, real ones where they are at hand, and broken ones.

#![allow(clippy::unwrap_used)]

use std::{fs, path::Path};

use cohabit_cdf::{
    Catalog, Layout,
    mission::{Cdf, builtin, read_mission},
};
use serde_json::Value;

/// Real missions beside the project's folder, as `(name, text)`; said when they are not there.
fn real_missions() -> Vec<(String, String)> {
    let arena = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/arena");
    let mut missions = Vec::new();
    for name in ["mission_01.json", "mission_07.json", "mission_08.json"] {
        missions.extend(fs::read_to_string(arena.join("cdf").join(name)).ok().map(|text| (name.to_owned(), text)));
    }
    for line in fs::read_to_string(arena.join("missions-dev.jsonl")).unwrap_or_default().lines() {
        let record: Value = serde_json::from_str(line).unwrap();
        missions.push((record["id"].to_string(), record["cdf"].to_string()));
    }
    let sessions = fs::read_to_string(arena.join("human-sessions-dev.json")).unwrap_or_default();
    let sessions: Value = serde_json::from_str(&sessions).unwrap_or_default();
    for (name, session) in sessions.as_object().into_iter().flatten() {
        missions.push((name.clone(), session["CDF"].to_string()));
    }
    if missions.is_empty() {
        eprintln!("no real missions at {}: nothing to compare with", arena.display());
    }
    missions
}

#[test]
fn own_missions_have_no_problems() {
    let catalog = Catalog::builtin();
    let names: Vec<_> = builtin().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["cold_soda.json", "laser_lab.json", "make_cereal.json", "warm_coffee.json"]);
    for (name, text) in builtin() {
        let checked = read_mission(name, text, &catalog).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(checked.warnings, [], "{name}");
        assert!(checked.mission.goals.iter().all(|goal| !goal.description.is_empty()), "{name}");
        assert_eq!(checked.mission.messages.len(), 2, "{name}");
    }
}

#[test]
fn real_missions_are_read_without_a_word() {
    let catalog = Catalog::builtin();
    let plans = Layout::builtin_ids();
    for (name, text) in real_missions() {
        let checked = read_mission(&name, &text, &catalog).unwrap_or_else(|problems| panic!("{problems}"));
        // Some layouts of the format may have no floor plan; nothing else is to be said.
        let expected = usize::from(!plans.contains(&checked.mission.layout));
        let warnings: Vec<_> = checked.warnings.iter().map(ToString::to_string).collect();
        assert_eq!(warnings.len(), expected, "{}", warnings.join("\n"));
        let raw: Value = serde_json::from_str(&text).unwrap();
        let count = |pointer: &str| raw.pointer(pointer).and_then(Value::as_array).map_or(0, Vec::len);
        let mission = &checked.mission;
        assert_eq!(mission.objects.len(), count("/scene/required_objects"), "{name}");
        assert_eq!(mission.notes.len(), count("/scene/sticky_notes"), "{name}");
        assert_eq!(mission.goals.len(), count("/task_goals"), "{name}");
        assert_eq!(mission.conditions.len(), count("/stateconditions"), "{name}");
    }
}

#[test]
fn writing_what_was_read_gives_the_same_values() {
    let own = builtin().iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    for (name, text) in real_missions().into_iter().chain(own) {
        let value: Value = serde_json::from_str(&text).unwrap();
        let cdf: Cdf = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_value(&cdf).unwrap(), value, "{name}");
    }
}

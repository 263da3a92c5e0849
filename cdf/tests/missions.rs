//! Mission files as whole: the project's own, real ones where they are at hand, and broken ones.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::LazyLock;

use cohabit_cdf::{
    Catalog, Layout,
    mission::{Cdf, builtin, read_mission, sources},
};
use proptest::prelude::*;
use serde_json::{Value, json};
use support::{own_missions, real_files, real_missions};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

#[test]
fn own_missions_have_no_problems() {
    let names: Vec<_> = builtin().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["cold_soda.json", "laser_lab.json", "make_cereal.json", "warm_coffee.json"]);
    for (name, text) in builtin() {
        let checked = read_mission(name, text, &CATALOG).unwrap_or_else(|problems| panic!("{problems}"));
        assert_eq!(checked.warnings, [], "{name}");
        assert!(checked.mission.goals.iter().all(|goal| !goal.description.is_empty()), "{name}");
        assert_eq!(checked.mission.messages.len(), 2, "{name}");
    }
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn real_missions_are_read_without_a_word() {
    let plans = Layout::builtin_ids();
    for (name, text) in real_missions() {
        let checked = read_mission(&name, &text, &CATALOG).unwrap_or_else(|problems| panic!("{problems}"));
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

#[track_caller]
fn check_writing(missions: Vec<(String, String)>) {
    for (name, text) in missions {
        let value: Value = serde_json::from_str(&text).unwrap();
        let cdf: Cdf = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_value(&cdf).unwrap(), value, "{name}");
    }
}

#[test]
fn writing_what_was_read_gives_the_same_values() {
    check_writing(own_missions());
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn writing_real_missions_that_were_read_gives_the_same_values() {
    check_writing(real_missions());
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn files_of_many_missions_are_read_mission_by_mission() {
    for (file, text) in real_files() {
        let found = sources(&file, &text).len();
        let expected = match file.as_str() {
            "missions-dev.jsonl" => text.lines().filter(|line| !line.trim().is_empty()).count(),
            "human-sessions-dev.json" => serde_json::from_str::<Value>(&text).unwrap().as_object().unwrap().len(),
            _ => 1,
        };
        assert_eq!(found, expected, "{file}");
    }
}

/// The objects in `value`, as JSON pointers.
fn objects(value: &Value, at: &str, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            all.push(at.to_owned());
            for (key, value) in fields {
                objects(value, &format!("{at}/{}", key.replace('~', "~0").replace('/', "~1")), all);
            }
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, item)| objects(item, &format!("{at}/{index}"), all));
        }
        _ => {}
    }
}

/// Objects whose keys the mission chooses: what is put into them means something.
fn is_open(pointer: &str) -> bool {
    ["/state/", "/location/", "/object_states/", "/expression", "/condition", "/game_interactions/", "/simbot_init/"]
        .iter()
        .any(|part| pointer.contains(part))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(100) })]

    #[test]
    fn unknown_fields_are_warned_of_and_kept(
        mission in any::<prop::sample::Index>(),
        fields in prop::collection::vec(
            (any::<prop::sample::Index>(), "x_[a-z~/ü]{1,12}", prop_oneof![
                Just(json!(null)), Just(json!([1, "a", {"b": 0.1}])), any::<f64>().prop_map(Value::from),
                ".{0,9}".prop_map(Value::from),
            ]),
            1..6,
        ),
    ) {
        let (name, text) = mission.get(builtin());
        let mut value: Value = serde_json::from_str(text).unwrap();
        let mut places = Vec::new();
        objects(&value, "", &mut places);
        places.retain(|place| !is_open(&format!("{place}/")));
        let mut put = Vec::new();
        for (place, key, field) in fields {
            let place = place.get(&places);
            let entry = value.pointer_mut(place).and_then(Value::as_object_mut).unwrap();
            if entry.insert(key.clone(), field).is_none() {
                put.push(format!("{place}/{}", key.replace('~', "~0").replace('/', "~1")));
            }
        }
        let text = serde_json::to_string_pretty(&value).unwrap();
        let checked = read_mission(name, &text, &CATALOG).unwrap_or_else(|problems| panic!("{problems}"));
        prop_assert_eq!(serde_json::to_value(&checked.raw).unwrap(), value);
        let mut warned: Vec<_> = checked.warnings.iter().map(|warning| warning.pointer.as_str().to_owned()).collect();
        warned.sort();
        put.sort();
        prop_assert_eq!(warned, put);
        for warning in &checked.warnings {
            let (line, column) = warning.position.unwrap();
            let rest: String = text.lines().nth(line - 1).unwrap().chars().skip(column - 1).collect();
            prop_assert!(rest.starts_with("\"x_"), "{}: {}", warning, rest);
        }
    }
}

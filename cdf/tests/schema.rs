//! The JSON Schema of mission files: sound missions conform to it, broken ones do not.

#![allow(clippy::unwrap_used)]

mod support;

use cohabit_cdf::{
    Catalog,
    mission::{builtin, read_mission, schema::schema},
};
use serde_json::{Value, json};

fn validator() -> jsonschema::Validator {
    let schema = schema(&Catalog::builtin());
    assert!(jsonschema::draft202012::meta::is_valid(&schema), "the schema is no schema");
    jsonschema::draft202012::new(&schema).unwrap()
}

#[test]
fn sound_missions_conform() {
    check_conformance(support::own_missions());
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn real_missions_conform() {
    check_conformance(support::real_missions());
}

#[track_caller]
fn check_conformance(missions: Vec<(String, String)>) {
    let validator = validator();
    for (name, text) in missions {
        let mission: Value = serde_json::from_str(&text).unwrap();
        let errors: Vec<_> = validator.iter_errors(&mission).collect();
        let said: Vec<_> = errors.iter().map(|error| format!("{}: {error}", error.instance_path())).collect();
        assert!(errors.is_empty(), "{name}: {}", said.join("\n"));
    }
}

#[test]
fn broken_missions_do_not() {
    let validator = validator();
    let (_, text) = builtin().iter().find(|(name, _)| *name == "make_cereal.json").unwrap();
    for (pointer, value) in [
        ("/scene/layoutOverride", json!("OfficeLayout9")),
        ("/scene/roomLocation/0", json!(["Kitchen"])),
        ("/scene/floor_plan", json!("one")),
        ("/scene/required_objects/1/name", json!("Bwl_01_1")),
        ("/scene/required_objects/1/state/1", json!({"isBrokn": "true"})),
        ("/scene/required_objects/1/state/1", json!({"isBroken": "perhaps"})),
        ("/scene/required_objects/1/location/0/TableRound_02_1", json!("under")),
        ("/task_goals/0/goal_id", json!([])),
        ("/task_goals/0/object_states/0/Bowl_01_1", json!("isPickedUp")),
        ("/task_goals/0/object_states/0/Bowl_01_1", json!("isFilled=Tea")),
        ("/task_goals/0/object_states_relation", json!("xor")),
        ("/stateconditions", json!([{"stateName": "A", "expression": {"isHawt": {"target": "Bowl_01_1"}}}])),
        ("/stateconditions", json!([{"stateName": "A", "expression": {"NOT": {"expression": {"isHot": {}}}}}])),
    ] {
        let mut mission: Value = serde_json::from_str(text).unwrap();
        *mission.pointer_mut(pointer).unwrap() = value;
        assert!(!validator.is_valid(&mission), "{pointer} may be {}", mission.pointer(pointer).unwrap());
    }
}

#[test]
fn every_field_and_word_is_described() {
    let schema = schema(&Catalog::builtin());
    let count = |name: &str| schema["$defs"][name]["enum"].as_array().map_or(0, Vec::len);
    assert_eq!(count("ObjectClass"), Catalog::builtin().classes().len());
    assert_eq!((count("Layout"), count("StateKey")), (10, 28));
    assert_eq!(schema["$defs"]["Room"]["examples"].as_array().map(Vec::len), Some(8));
    assert_eq!((count("Verb"), count("Status")), (10, 20));
    let mut objects = vec![("mission".to_owned(), &schema)];
    objects.extend(schema["$defs"].as_object().unwrap().iter().map(|(name, schema)| (name.clone(), schema)));
    let written = ["Cdf", "mission", "Scene", "RequiredObject", "StickyNote", "TaskGoal", "Visibility", "Condition"];
    for (name, object) in objects {
        assert!(object["description"].is_string(), "{name} is not described");
        if !written.contains(&name.as_str()) {
            continue;
        }
        for (field, schema) in object["properties"].as_object().unwrap() {
            assert!(schema["description"].is_string(), "{name}.{field} is not described");
        }
    }
}

/// References lead somewhere.
#[test]
fn every_reference_is_defined() {
    fn references<'v>(value: &'v Value, all: &mut Vec<&'v str>) {
        match value {
            Value::Object(fields) => {
                all.extend(fields.get("$ref").and_then(Value::as_str));
                fields.values().for_each(|value| references(value, all));
            }
            Value::Array(items) => items.iter().for_each(|value| references(value, all)),
            _ => {}
        }
    }
    let schema = schema(&Catalog::builtin());
    let mut all = Vec::new();
    references(&schema, &mut all);
    assert!(all.len() > 50);
    for reference in all {
        assert!(schema.pointer(reference.trim_start_matches('#')).is_some(), "{reference} is not defined");
    }
}

/// What the schema says of sizes is what reading holds to.
#[test]
fn sizes_are_bounded_as_in_reading() {
    let catalog = Catalog::builtin();
    let (schema, validator) = (schema(&catalog), validator());
    let (_, text) = builtin().iter().find(|(name, _)| *name == "make_cereal.json").unwrap();
    let note = |index: usize| json!({"name": format!("StickyNote_{index}"), "text": "x", "room": "Lab1"});
    let apple = |index: usize| json!({"name": format!("Apple_{index}"), "roomLocation": ["Lab1"]});
    let many = |item: &dyn Fn(usize) -> Value, count: usize| (0..count).map(item).collect::<Vec<_>>();
    for (pointer, key, value) in [
        ("/scene/sticky_notes", "sticky_notes", json!(many(&note, 100_000))),
        ("/scene/required_objects", "required_objects", json!(many(&apple, 1001))),
        ("/task_goals", "task_goals", json!(vec![json!({"goal_id": 1}); 201])),
        ("/goal_text", "goal_text", json!("x".repeat(10_001))),
        ("/task_description", "task_description", json!("ы".repeat(10_001))),
        ("/stateconditions", "stateconditions", json!(vec![json!({}); 501])),
        ("/pastPortals", "pastPortals", json!(vec![json!({}); 101])),
    ] {
        let mut mission: Value = serde_json::from_str(text).unwrap();
        let parent = pointer.strip_suffix(key).unwrap().trim_end_matches('/');
        mission.pointer_mut(parent).unwrap()[key] = value;
        let found: Vec<_> = validator.iter_errors(&mission).map(|error| error.to_string()).collect();
        assert!(!found.is_empty(), "{pointer}: the schema has no limit");
        let problems = read_mission("m.json", &mission.to_string(), &catalog).unwrap_err().0;
        assert_eq!(problems.len(), 1, "{problems:?}");
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        assert!(problem.remedy.as_ref().is_some_and(|remedy| remedy.contains("at most")), "{problem}");
        let is_too_large = mission.to_string().len() > schema["x-limits"]["bytes"].as_u64().unwrap() as usize;
        assert_eq!(problem.pointer.as_str(), if is_too_large { "" } else { pointer });
        assert!(problem.position.is_some_and(|place| is_too_large == (place == (1, 1))), "{problem}");
    }
    assert!(schema["description"].as_str().unwrap().contains("bytes"));
}

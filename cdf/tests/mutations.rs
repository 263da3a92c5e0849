//! Whatever is done to the text of a mission, reading it gives a mission or says what is wrong, and never fails otherwise.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::LazyLock;

use cohabit_cdf::{
    Catalog,
    mission::{Severity, builtin, read_mission, sources},
};
use proptest::{prelude::*, sample::Index};
use serde_json::{Value, json};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

/// Reads `text`: a mission without errors, or problems with at least one; every problem is one line, and has a place in
/// the text.
#[track_caller]
fn read(text: &str) -> bool {
    let (playable, problems) = match read_mission("m.json", text, &CATALOG) {
        Ok(checked) => (true, checked.warnings),
        Err(problems) => (false, problems.0),
    };
    assert_eq!(playable, problems.iter().all(|problem| problem.severity == Severity::Warning));
    let lines = text.lines().count().max(1) + 1;
    for problem in &problems {
        assert_eq!(problem.to_string().lines().count(), 1, "{problem}");
        let (line, column) = problem.position.unwrap();
        assert!((1..=lines).contains(&line) && column >= 1, "{problem}");
    }
    assert!(problems.is_sorted_by_key(|problem| problem.position));
    for source in sources("m.jsonl", text) {
        assert!(text.contains(source.text));
    }
    playable
}

fn mission() -> impl Strategy<Value = &'static str> {
    any::<Index>().prop_map(|index| index.get(builtin()).1)
}

/// All places in `value`, the outermost first.
fn places(value: &Value) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut next = 0;
    while let Some(at) = all.get(next).cloned() {
        next += 1;
        match value.pointer(&at) {
            Some(Value::Object(fields)) => {
                all.extend(fields.keys().map(|key| format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"))));
            }
            Some(Value::Array(items)) => all.extend((0..items.len()).map(|index| format!("{at}/{index}"))),
            _ => {}
        }
    }
    all
}

/// What is done to one place of a mission.
#[derive(Clone, Debug)]
enum Change {
    Delete,
    Duplicate,
    Retype(Value),
    Rename(String),
    SwapWith(Index),
    Nest(usize),
}

fn change() -> impl Strategy<Value = Change> {
    let other = prop_oneof![
        Just(json!(null)),
        Just(json!([])),
        Just(json!({})),
        Just(json!([[{}]])),
        Just(json!("")),
        Just(json!("*")),
        Just(json!("_Spawned_*")),
        Just(json!("=")),
        Just(json!({"NOT": {"NOT": []}})),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<u64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        "\\PC{0,20}".prop_map(Value::from),
    ];
    prop_oneof![
        Just(Change::Delete),
        Just(Change::Duplicate),
        other.prop_map(Change::Retype),
        "\\PC{0,12}".prop_map(Change::Rename),
        any::<Index>().prop_map(Change::SwapWith),
        (1_usize..90).prop_map(Change::Nest),
    ]
}

fn apply(mission: &mut Value, at: &str, change: &Change, others: &[String]) {
    let Some(value) = mission.pointer(at).cloned() else { return };
    match change {
        Change::Retype(other) => *mission.pointer_mut(at).unwrap() = other.clone(),
        Change::SwapWith(other) => {
            let other = mission.pointer(other.get::<String>(others)).cloned().unwrap_or_default();
            *mission.pointer_mut(at).unwrap() = other;
        }
        Change::Nest(depth) => {
            let nested = (0..*depth)
                .fold(value, |inner, level| if level % 2 == 0 { json!([inner]) } else { json!({"AND": inner}) });
            *mission.pointer_mut(at).unwrap() = nested;
        }
        Change::Delete | Change::Duplicate | Change::Rename(_) => {
            let Some((parent, key)) = at.rsplit_once('/') else { return };
            let key = key.replace("~1", "/").replace("~0", "~");
            match (mission.pointer_mut(parent).unwrap(), change) {
                (Value::Object(fields), Change::Delete) => drop(fields.shift_remove(&key)),
                (Value::Object(fields), Change::Rename(name)) => {
                    fields.shift_remove(&key);
                    fields.insert(name.clone(), value);
                }
                (Value::Object(fields), _) => drop(fields.insert(format!("{key}_1"), value)),
                (Value::Array(items), Change::Delete) => drop(items.remove(key.parse().unwrap())),
                (Value::Array(items), _) => items.insert(key.parse().unwrap(), value),
                _ => {}
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn changed_values(text in mission(), changes in prop::collection::vec((any::<Index>(), change()), 1..5)) {
        let mut mission: Value = serde_json::from_str(text).unwrap();
        for (place, change) in changes {
            let all = places(&mission);
            apply(&mut mission, place.get::<String>(&all), &change, &all);
        }
        read(&serde_json::to_string_pretty(&mission).unwrap());
    }

    #[test]
    fn changed_bytes(text in mission(), changes in prop::collection::vec((any::<Index>(), any::<u8>(), any::<bool>()), 1..8)) {
        let mut bytes = text.as_bytes().to_vec();
        for (place, byte, insert) in changes {
            let at = place.index(bytes.len());
            if insert { bytes.insert(at, byte) } else { bytes[at] = byte }
        }
        read(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn cut_off_anywhere(text in mission(), at in any::<Index>()) {
        let mut end = at.index(text.trim_end().len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        prop_assert!(!read(&text[..end]));
    }

    #[test]
    fn keys_written_twice(text in mission(), place in any::<Index>()) {
        let value: Value = serde_json::from_str(text).unwrap();
        let keys: Vec<_> = value.as_object().unwrap().keys().cloned().collect();
        let key = place.get(&keys);
        // The same again at the end: the values stay the same.
        let again = format!(",\n{}: {}}}", json!(key), value[key]);
        let twice = format!("{}{again}", text.trim_end().strip_suffix('}').unwrap());
        let checked = read_mission("m.json", &twice, &CATALOG).unwrap();
        let warnings: Vec<_> = checked.warnings.iter().map(|warning| warning.message.as_str()).collect();
        let expected = format!("`{key}` is there more than once; only the last counts");
        prop_assert_eq!(warnings, [expected.as_str()]);
        prop_assert_eq!(serde_json::to_value(&checked.raw).unwrap(), value);
    }
}

#[test]
fn bombs_are_told_off() {
    let deep = |open: &str, close: &str, depth: usize| format!("{}1{}", open.repeat(depth), close.repeat(depth));
    for text in [
        deep("[", "]", 200_000),
        deep("{\"scene\":", "}", 200_000),
        format!("{{\"scene\": {}}}", deep("{\"AND\":", "}", 100_000)),
        format!("{{\"stateconditions\": [{{\"expression\": {}}}]}}", deep("{\"NOT\":", "}", 120)),
        "[".repeat(1_000_000),
        "{\"a\":".repeat(1_000_000),
        format!("{{\"scene\": {{\"floor_plan\": {}}}}}", "9".repeat(100_000)),
        format!("{{\"scene\": {{\"floor_plan\": \"{}\"}}}}", "9".repeat(100_000)),
        "{\"scene\": {\"floor_plan\": 1e400}}".to_owned(),
        "{\"scene\": {\"floor_plan\": -1e-400, \"layoutOverride\": \"".to_owned() + &"Office".repeat(50_000) + "\"}}",
    ] {
        assert!(!read(&text), "{} bytes are read", text.len());
    }
}

#[test]
fn deep_expressions_are_read() {
    let expression =
        (0..50).fold(json!({"isHot": {"target": "Bowl_01_1"}}), |inner, _| json!({"NOT": {"expression": inner}}));
    let mission = json!({
        "scene": {"roomLocation": ["BreakRoom"], "required_objects": [{"name": "Bowl_01_1"}]},
        "task_goals": [{"goal_id": 0, "object_states": [{"Bowl_01_1": "Deep=true"}]}],
        "stateconditions": [{"stateName": "Deep", "context": "Bowl_01_1", "expression": expression}],
    });
    assert!(read(&mission.to_string()));
}

#[test]
fn broken_escapes_are_told_off() {
    for escape in ["\\ud800", "\\udc00\\ud800", "\\ud83d\\u0041", "\\u12", "\\uZZZZ", "\\x41", "\\", "\u{1}", "\u{0}"] {
        let text = format!("{{\"scene\": {{\"scene_id\": \"{escape}\"}}}}");
        let problems = read_mission("m.json", &text, &CATALOG).unwrap_err();
        assert_eq!(problems.0.len(), 1, "{escape}");
        assert!(problems.0[0].message.starts_with("no JSON: "), "{}", problems.0[0]);
    }
    let text = "{\"scene\": {\"scene_id\": \"\\ud83d\\ude00 \\u0000\", \"roomLocation\": [\"Lab1\"]}}";
    assert_eq!(read_mission("m.json", text, &CATALOG).unwrap().mission.name, "😀 \0");
}

#[test]
fn the_form_of_the_text_does_not_matter() {
    check_forms(support::own_missions());
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_form_of_real_missions_does_not_matter() {
    check_forms(support::real_missions());
}

/// Every mission is still what it was with a byte order mark, other line ends, or no space at all.
#[track_caller]
fn check_forms(missions: Vec<(String, String)>) {
    for (name, text) in missions {
        let expected = read_mission("m.json", &text, &CATALOG).unwrap().mission;
        let value: Value = serde_json::from_str(&text).unwrap();
        for other in [format!("\u{feff}{text}"), text.replace('\n', "\r\n"), value.to_string()] {
            assert_eq!(read_mission("m.json", &other, &CATALOG).unwrap().mission, expected, "{name}");
        }
    }
}

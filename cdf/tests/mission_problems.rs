//! What is said of broken missions; and that no text whatever makes reading panic.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_cdf::{
    Catalog, RoomId, StateFlag,
    mission::{Cdf, MessageTime, Problem, Severity, builtin, read_mission},
};
use proptest::prelude::*;
use serde_json::{Value, json};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

/// A mission without problems.
fn sound() -> Value {
    json!({
        "scene": {
            "layoutOverride": "OfficeLayout1",
            "floor_plan": "-1",
            "roomLocation": ["Breakroom"],
            "required_objects": [
                {"name": "TableRound_02_1", "roomLocation": ["BreakRoom"]},
                {"name": "FoodPlate_01_1", "state": [{"isDirty": "true"}], "location": [{"TableRound_02_1": "on"}]},
                {"name": "Laser_CircuitBoard_01"},
                {"name": "Printer_3D_1"}
            ],
            "sticky_notes": [{"name": "StickyNote_3", "text": "Hello", "room": "Lab1", "location": "1"}]
        },
        "task_goals": [
            {"goal_id": 0, "object_states": [{"FoodPlate_01_1": "isPickedUp=true"}]},
            {"goal_id": "1", "object_states": [{"FoodPlate_01_1": "Tidy=true"}, {"Printer_3D_1_Spawned_Hammer_*": "isPickedUp=true"}]}
        ],
        "stateconditions": [
            {"stateName": "Tidy", "context": "TableRound_02_1", "expression": {"NOT": {"isDirty": {"target": "FoodPlate_01_1"}}}}
        ]
    })
}

/// Puts `value` at `pointer`, whose parent must be there.
fn put(mission: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match mission.pointer_mut(parent).unwrap() {
        Value::Object(fields) => {
            fields.insert(key.replace("~1", "/"), value);
        }
        Value::Array(items) if key == "-" => items.push(value),
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        other => panic!("{parent} is {other}"),
    }
}

/// What is said of the sound mission with `value` at `pointer`, one line a problem.
fn said(pointer: &str, value: Value) -> String {
    let mut mission = sound();
    put(&mut mission, pointer, value);
    let problems = match read_mission("m.json", &mission.to_string(), &CATALOG) {
        Ok(checked) => checked.warnings,
        Err(problems) => {
            assert!(problems.count(Severity::Error) > 0);
            problems.0
        }
    };
    let unplaced = |problem: Problem| Problem { position: None, ..problem }.to_string();
    problems.into_iter().map(unplaced).collect::<Vec<_>>().join("\n")
}

#[track_caller]
fn check(pointer: &str, value: Value, expected: &str) {
    assert_eq!(said(pointer, value), expected, "at {pointer}");
}

#[test]
fn generous_shapes_are_no_problem() {
    let bowl = "/scene/required_objects/1";
    check("/scene/sticky_notes", Value::Null, "");
    check("/scene/layoutOverride", Value::Null, "");
    check("/scene/floor_plan", json!(7), "");
    check("/scene/roomLocation", json!("Lab1"), "");
    check(&format!("{bowl}/colors"), json!(["Red"]), "");
    check(
        &format!("{bowl}/state"),
        json!([{"isFilled": "Coffee"}, {"circuitId": -1}, {"Unique": 1}, {"isBroken": true}]),
        "",
    );
    check(&format!("{bowl}/location"), json!([{"KitchenCounterTop_02_1": "in"}]), "");
    check(&format!("{bowl}/yesterdayState"), json!("Toast_03"), "");
    check(
        "/task_goals/0/object_states",
        json!([{"Bowl_01_*": "isFilled=Milk", "ReceptionDesk_7": "Contains=FoodPlate_01_*"}]),
        "",
    );
    check("/task_goals/1/preconditions", json!(["0"]), "");
    check("/task_goals/0/object_states_relation", json!("OR"), "");
    for negation in [
        json!({"expression": {"isHot": {"target": "FoodPlate_01_1", "value": "true"}}}),
        json!({"expressions": [{"isHot": {"target": "FoodPlate_01_1", "value": 1}}]}),
        json!([{"CanBeSeen": {"target": "FoodPlate_01_1", "distance": "2.5", "message": ""}}]),
    ] {
        check("/stateconditions/0/expression", json!({"NOT": negation}), "");
    }
}

const PLATE: &str = "/scene/required_objects/1";

#[test]
fn scenes_are_checked() {
    check("/scene", json!([]), "m.json: /scene: expected an object, found a list");
    check("/scene/required_objects", json!("all"), "m.json: /scene/required_objects: expected a list, found a text");
    check(
        "/scene/layoutOverride",
        json!("OfficeLayout1_miror"),
        "m.json: /scene/layoutOverride: unknown layout `OfficeLayout1_miror`; did you mean `OfficeLayout1_mirror`?",
    );
    check("/scene/floor_plan", json!("one"), "m.json: /scene/floor_plan: expected a whole number, found `one`");
    check(
        "/scene/roomLocation",
        json!(["Lab3", "Lab2"]),
        "m.json: /scene/roomLocation/0: unknown room `Lab3`; did you mean `Lab1`?\n\
         m.json: /scene/roomLocation/1: warning: only the first is used",
    );
    check("/scene/roomLocation", json!(["robotics lab"]), "");
    check(
        "/scene/roomLocation",
        json!(["attic"]),
        "m.json: /scene/roomLocation/0: unknown room `attic`; there are BreakRoom, MainOffice, SmallOffice, Lab1, Lab2, Reception, Warehouse, Hallway",
    );
    check(
        "/scene/roomLocation",
        json!([]),
        "m.json: /scene/roomLocation: warning: the mission does not say where the robot starts; taken as `BreakRoom`",
    );
    check(
        "/scene/sticky_note",
        json!([]),
        "m.json: /scene/sticky_note: warning: unknown field `sticky_note` is ignored; did you mean `sticky_notes`?",
    );
    check("/a~1b", json!(1), "m.json: /a~1b: warning: unknown field `a/b` is ignored");
    check(
        "/scene/sticky_notes/0/name",
        json!("Hammer_1"),
        "m.json: /scene/sticky_notes/0/name: `Hammer_1` is no `StickyNote`",
    );
    check("/scene/sticky_notes/0/room", json!(""), "m.json: /scene/sticky_notes/0/room: the note has no room");
}

#[test]
fn objects_are_checked() {
    let name = "/scene/required_objects/2/name";
    for (value, expected) in [
        (json!("Bowl_1"), "unknown object `Bowl_1`; did you mean `Bowl_01`?"),
        (json!("Bwl_01_7"), "unknown object `Bwl_01_7`; did you mean `Bowl_01_7`?"),
        (json!("FoodPlate_01_1"), "there is already an object `FoodPlate_01_1`"),
        (
            json!("Toast_04_Jamm_1"),
            "warning: `Toast_04_Jamm_1` is taken as a `Toast_04`: `Jamm_1` is no number; did you mean `Toast_04_Jam`?",
        ),
        (json!(["x"]), "expected a text, found a list"),
        (json!(""), "the object has no name"),
    ] {
        check(name, value, &format!("m.json: {name}: {expected}"));
    }
    for (state, key, expected) in [
        (json!("true"), "isHott", "unknown state `isHott`; did you mean `isHot`?"),
        (json!("Tea"), "isFilled", "unknown fluid `Tea`; it is one of `None`, `Water`, `Milk`, `Coffee`"),
        (json!("perhaps"), "isDirty", "expected true or false, found `perhaps`"),
        (json!("x"), "circuitId", "expected a whole number, found `x`"),
        (json!(null), "isOpen", "expected a value, found null"),
        (json!("true"), "isOpen", "warning: `FoodPlate_01_1` never gets into this state: Plate is not openable"),
    ] {
        check(&format!("{PLATE}/state"), json!([{key: state}]), &format!("m.json: {PLATE}/state/0/{key}: {expected}"));
    }
    for (place, way, expected) in [
        ("Desk_01_10006", "under", "expected `in` or `on`, found `under`"),
        ("WallClock_01_10000", "in", "nothing can be in or on `WallClock_01_10000`: Clock is no receptacle"),
        ("Desk_01_*", "on", "`Desk_01_*` may be several objects; a place is one"),
        ("TableRund_02_1", "on", "unknown object `TableRund_02_1`; did you mean `TableRound_02_1`?"),
    ] {
        let expected = format!("m.json: {PLATE}/location/0/{place}: {expected}");
        check(&format!("{PLATE}/location"), json!([{place: way}]), &expected);
    }
    check(
        &format!("{PLATE}/location"),
        json!([{"FoodPlate_01_1": "in"}]),
        &format!("m.json: {PLATE}/location: `FoodPlate_01_1` is inside itself"),
    );
    check(
        &format!("{PLATE}/colors"),
        json!(["Pink"]),
        &format!("m.json: {PLATE}/colors/0: unknown colour `Pink`; it is one of `Original`, `Red`, `Green`, `Blue`"),
    );
    check(
        &format!("{PLATE}/yesterdayState"),
        json!("Toast_3"),
        &format!("m.json: {PLATE}/yesterdayState: unknown object `Toast_3`; did you mean `Toast_03`?"),
    );
}

#[test]
fn goals_are_checked() {
    for (instance, state, expected) in [
        ("FodPlate_01_1", json!("isDirty=true"), "unknown object `FodPlate_01_1`; did you mean `FoodPlate_01_1`?"),
        ("Unicorn_*", json!("isHot=true"), "unknown object `Unicorn_*`"),
        (
            "Handsaw_4",
            json!("isPickedUp=true"),
            "no object `Handsaw_4`: neither the mission lists one, nor has layout `OfficeLayout1`; \
             add it to `required_objects`",
        ),
        ("FoodPlate_01_1", json!("isHot"), "expected `key=value`, found `isHot`; write `isHot=true`"),
        ("FoodPlate_01_1", json!("Tidi=true"), "unknown key or condition `Tidi`; did you mean `Tidy`?"),
        ("FoodPlate_01_1", json!("isDirty=maybe"), "expected true or false, found `maybe`"),
        ("FoodPlate_01_1", json!(3), "expected `key=value`, found a number; write a text such as `isHot=true`"),
        (
            "FoodPlate_01_1",
            json!("Contains=Printer_3D_7"),
            "no object `Printer_3D_7`: the layout's is `Printer_3D_10000`; did you mean `Printer_3D_1`?",
        ),
    ] {
        let expected = format!("m.json: /task_goals/0/object_states/0/{instance}: {expected}");
        check("/task_goals/0/object_states", json!([{instance: state}]), &expected);
    }
    for (key, value, expected) in [
        ("object_states", json!([]), ": warning: the goal asks for nothing"),
        ("object_states_relation", json!("xor"), ": unknown relation `xor`; did you mean `or`?"),
        ("preconditions", json!([7]), "/0: there is no goal 7; there are 0, 1"),
        ("preconditions", json!(["first"]), "/0: expected a whole number, found `first`"),
        ("preconditions", json!([0]), ": goal 0 waits for itself"),
        ("goal_id", json!("last"), ": expected a whole number, found `last`"),
        ("goal_id", json!(null), ": the goal has no number"),
    ] {
        check(&format!("/task_goals/0/{key}"), value, &format!("m.json: /task_goals/0/{key}{expected}"));
    }
    check("/task_goals/1/goal_id", json!(0), "m.json: /task_goals/1/goal_id: there is already a goal 0");
    check("/task_goals", json!([]), "m.json: /task_goals: warning: the mission has no goals: it never ends");
}

#[test]
fn conditions_are_checked() {
    let at = "/stateconditions/0/expression";
    for (expression, place, expected) in [
        (json!({}), "", "the expression is empty"),
        (
            json!({"isHawt": {"target": "FoodPlate_01_1"}}),
            "/isHawt",
            "unknown kind of expression `isHawt`; did you mean `isHot`?",
        ),
        (json!({"isHot": {}}), "/isHot", "`target` is missing"),
        (json!({"isHot": true}), "/isHot", "expected an object with a `target`, found true or false"),
        (json!({"AND": {"expressions": []}}), "/AND/expressions", "there is nothing to combine"),
        (
            json!({"OR": [{"IsInRange": {"target": "FoodPlate_01_1", "value": "near"}}]}),
            "/OR/0/IsInRange/value",
            "expected a distance in metres, found `near`",
        ),
        (
            json!({"NOT": {"expression": {"isHot": {"target": "Cofee_1"}}}}),
            "/NOT/expression/isHot/target",
            "unknown object `Cofee_1`",
        ),
    ] {
        check(at, expression, &format!("m.json: {at}{place}: {expected}"));
    }
    check(
        "/stateconditions/-",
        json!({"stateName": "Tidy", "context": "TableRound_02_1", "expression": {"isHot": {"target": "Printer_3D_1"}}}),
        "m.json: /stateconditions/1/stateName: there is already a condition `Tidy` of `TableRound_02_1`",
    );
}

#[test]
fn messages_are_read_in_many_shapes() {
    let messages = json!({
        "task_beginning": ["Hello", {"message": "World"}, {"id": 1}],
        "task_procedure": [{"goal_id": 1, "text": "Good"}, {"messageText": ["One", "Two"]}],
        "task_ending": [{"messages": [{"text": "Bye"}]}]
    });
    let mut mission = sound();
    put(&mut mission, "/game_interactions", json!({"game_messages": messages}));
    let checked = read_mission("m.json", &mission.to_string(), &CATALOG).unwrap();
    let said: Vec<_> = checked.mission.messages.iter().map(|message| (&message.when, message.text.as_str())).collect();
    let goal = MessageTime::GoalMet(1);
    let expected = [
        (&MessageTime::Beginning, "Hello"),
        (&MessageTime::Beginning, "World"),
        (&goal, "Good"),
        (&goal, "One\nTwo"),
        (&MessageTime::Ending, "Bye"),
    ];
    assert_eq!(said, expected);
    assert_eq!(checked.warnings.len(), 1, "{:?}", checked.warnings);
}

#[test]
fn what_is_no_json_has_a_line_and_a_column() {
    for (text, expected) in [
        ("{\n  \"scene\": oops\n}", "m.json:2:12: no JSON: expected value"),
        ("", "m.json:1:1: no JSON: EOF while parsing a value"),
        ("{\"é\": \"\\ud800\"}", "m.json:1:14: no JSON: unexpected end of hex escape"),
        ("[]", "m.json:1:1: a mission is an object, not a list"),
    ] {
        let problems = read_mission("m.json", text, &CATALOG).unwrap_err();
        assert_eq!(problems.to_string(), expected);
    }
}

#[test]
fn what_was_read_is_what_was_written() {
    let checked = read_mission("m.json", &sound().to_string(), &CATALOG).unwrap();
    let mission = &checked.mission;
    assert_eq!((mission.name.as_str(), mission.layout.as_str()), ("m.json", "OfficeLayout1"));
    assert_eq!((mission.seed, mission.start_room), (None, RoomId::BREAK_ROOM));
    assert_eq!(mission.objects[1].inside.as_deref(), Some("TableRound_02_1"));
    assert_eq!(mission.objects[1].flags, [(StateFlag::Dirty, true)]);
    assert_eq!((mission.notes[0].room, mission.notes[0].place), (RoomId::LAB1, 1));
    let states: Vec<_> = mission.goals.iter().flat_map(|goal| &goal.states).map(ToString::to_string).collect();
    let hammer = "Printer_3D_1_Spawned_Hammer_*: isPickedUp=true";
    assert_eq!(states, ["FoodPlate_01_1: isPickedUp=true", "FoodPlate_01_1: Tidy=true", hammer]);
    let tidy = mission.condition("Tidy", "FoodPlate_01_1").unwrap();
    assert_eq!(tidy.expression.to_string(), "NOT FoodPlate_01_1: isDirty=true");
}

/// Any JSON, with the keys of mission files among its keys.
fn any_json() -> impl Strategy<Value = Value> {
    let text = prop_oneof![
        "[a-zA-Z0-9_*=~/ ]{0,12}",
        prop::sample::select(vec!["Bowl_01_1", "isHot=true", "true", "-1", "Lab1", "x_Spawned_*", "*", "_*", "and"])
            .prop_map(str::to_owned),
        ".{0,6}",
    ];
    let key = prop_oneof![prop::sample::select(keys()), "[a-zA-Z_]{0,8}"];
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        text.prop_map(Value::from),
    ];
    leaf.prop_recursive(5, 40, 6, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::from),
            prop::collection::vec((key.clone(), inner), 0..6)
                .prop_map(|fields| Value::Object(fields.into_iter().collect())),
        ]
    })
}

/// All keys of the project's own missions.
fn keys() -> Vec<String> {
    fn gather(value: &Value, keys: &mut Vec<String>) {
        match value {
            Value::Object(fields) => fields.iter().for_each(|(key, value)| {
                keys.push(key.clone());
                gather(value, keys);
            }),
            Value::Array(items) => items.iter().for_each(|item| gather(item, keys)),
            _ => {}
        }
    }
    let mut keys = vec!["NOT".to_owned(), "Contains".to_owned(), "Bowl_01_1".to_owned()];
    builtin().iter().for_each(|(_, text)| gather(&serde_json::from_str(text).unwrap(), &mut keys));
    keys.sort();
    keys.dedup();
    keys
}

/// All places in `value`, as JSON pointers.
fn places(value: &Value, at: &str, all: &mut Vec<String>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let at = format!("{at}/{}", key.replace('~', "~0").replace('/', "~1"));
                all.push(at.clone());
                places(value, &at, all);
            }
        }
        Value::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                let at = format!("{at}/{index}");
                all.push(at.clone());
                places(value, &at, all);
            }
        }
        _ => {}
    }
}

/// Problems point at what is there, or at a field missing in what is there; printed they are one line each.
fn read_any(value: &Value) {
    let text = value.to_string();
    // The last bit of a number may be lost in writing and reading it.
    let value: &Value = &serde_json::from_str(&text).unwrap();
    let (raw, problems) = match read_mission("m.json", &text, &CATALOG) {
        Ok(checked) => (Some(checked.raw), checked.warnings),
        Err(problems) => (None, problems.0),
    };
    if let Some(raw) = raw {
        assert_eq!(&serde_json::to_value(raw).unwrap(), value);
    }
    for problem in problems {
        let pointer = problem.pointer.as_str();
        let parent = pointer.rsplit_once('/').map_or("", |(parent, _)| parent);
        assert!(value.pointer(parent).is_some(), "{problem}");
        assert_eq!(problem.to_string().lines().count(), 1, "{problem}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn any_json_is_read_or_told_off(value in any_json()) {
        read_any(&value);
        let cdf: Result<Cdf, _> = serde_json::from_value(value.clone());
        prop_assert_eq!(cdf.is_ok(), value.is_object());
    }

    #[test]
    fn changed_missions_are_read_or_told_off(
        index in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any_json()), 1..4),
    ) {
        let (_, text) = index.get(builtin());
        let mut mission: Value = serde_json::from_str(text).unwrap();
        for (place, value) in changes {
            let mut all = Vec::new();
            places(&mission, "", &mut all);
            if all.is_empty() {
                break;
            }
            *mission.pointer_mut(&all[place.index(all.len())]).unwrap() = value;
        }
        read_any(&mission);
    }

    #[test]
    fn cut_off_missions_are_told_off(index in any::<prop::sample::Index>(), at in any::<prop::sample::Index>()) {
        let (_, text) = index.get(builtin());
        let mut end = at.index(text.trim_end().len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let problems = read_mission("m.json", &text[..end], &CATALOG).unwrap_err();
        prop_assert_eq!(problems.0.len(), 1);
        prop_assert!(problems.0[0].position.is_some());
    }
}

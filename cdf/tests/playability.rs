//! Missions of which every piece reads well, and which cannot be played all the same.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_cdf::{
    Catalog, WorldData, WorldPack,
    mission::{Problem, Severity, read_mission},
};
use serde_json::{Value, json};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

/// What is said of a mission with these objects, goal states and conditions, one line a problem; whether it is playable.
fn said(objects: &Value, states: &Value, conditions: &Value) -> (String, bool) {
    let mission = json!({
        "scene": {"roomLocation": ["BreakRoom"], "required_objects": objects},
        "task_goals": [{"goal_id": 0, "object_states": states, "object_states_relation": "and"}],
        "stateconditions": conditions,
    });
    let (problems, playable) = match read_mission("m", &mission.to_string(), &CATALOG) {
        Ok(checked) => (checked.warnings, true),
        Err(problems) => (problems.0, false),
    };
    let line = |problem: Problem| {
        let kind = if problem.severity == Severity::Warning { "warning: " } else { "" };
        let remedy = problem.remedy.map(|remedy| format!("; {remedy}")).unwrap_or_default();
        format!("{kind}{}{remedy}", problem.message)
    };
    (problems.into_iter().map(line).collect::<Vec<_>>().join("\n"), playable)
}

/// A goal that cannot be met, for this reason; playable if there is none.
#[track_caller]
fn check_goal(states: Value, reason: &str) {
    let objects = json!([{"name": "Bowl_01_1"}, {"name": "Apple_1"}, {"name": "Laser_1"}, {"name": "Hammer_1"}]);
    let expected = if reason.is_empty() { String::new() } else { format!("goal 0 cannot be met: {reason}") };
    assert_eq!(said(&objects, &states, &json!([])), (expected, reason.is_empty()), "{states}");
}

#[test]
fn goals_that_cannot_be_met() {
    for (states, reason) in [
        (json!([{"Bowl_01_1": "isHot=true"}]), ""),
        (json!([{"Bowl_01_1": "isOpen=false"}]), ""),
        (json!([{"Bowl_01_1": "isEmpty=false"}]), ""),
        (json!([{"Apple_1": "isEmpty=false"}]), "nothing can be in or on `Apple_1`: Apple is no receptacle"),
        (json!([{"Bowl_01_1": "isOpen=true"}]), "`Bowl_01_1` never gets into this state: Bowl is not openable"),
        (json!([{"Bowl_01_*": "isOpen=true"}]), "`Bowl_01_*` never gets into this state: Bowl is not openable"),
        (json!([{"Apple_1": "isWet=true"}]), "`Apple_1` never gets into this state: nothing gets a Apple into it"),
        (json!([{"Apple_1": "isWet=false"}]), ""),
        (json!([{"Apple_1": "isFilled=Milk"}]), "`Apple_1` never gets into this state: Apple is not fillable"),
        (json!([{"Apple_1": "isFilled=true"}]), "`Apple_1` never gets into this state: Apple is not fillable"),
        (json!([{"Apple_1": "Contains=Bowl_01_1"}]), "nothing can be in or on `Apple_1`: Apple is no receptacle"),
        (json!([{"Apple_1": "ContainsCereal=true"}]), "cereal does not belong into `Apple_1`: Apple is no bowl"),
        (
            json!([{"Laser_1": "Contains=Apple_1"}]),
            "`Laser_1` never contains `Apple_1`: it takes only `Laser_Tip`, `Laser_CircuitBoard`, `Laser_ControlPanel`",
        ),
        (
            json!([{"Bowl_01_1": "isHot=true"}, {"Bowl_01_1": "isCold=true"}]),
            "`Bowl_01_1` is never isHot=true and isCold=true at once",
        ),
        (
            json!([{"Bowl_01_1": "isFilled=Milk"}, {"Bowl_01_1": "isFilled=Water"}]),
            "`Bowl_01_1` is never filled with Milk and Water at once",
        ),
        (
            json!([{"Apple_1": "isPickedUp=true"}, {"Apple_1": "isPickedUp=false"}]),
            "`Apple_1` is never isPickedUp=true and isPickedUp=false at once",
        ),
        (
            json!([{"Bowl_01_1": "isHot=true"}, {"Hammer_1": "isCold=true"}]),
            "`Hammer_1` never gets into this state: Hammer is not chillable",
        ),
    ] {
        check_goal(states, reason);
    }
}

#[test]
fn some_states_are_of_some_things_alone() {
    let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    for (thing, state, start, expected) in [
        ("Towel_1", "isWet", false, true),
        ("Flower_Pot_1", "isWet", false, true),
        ("Kettle_1", "isWet", false, false),
        ("Kettle_1", "isWet", true, true),
        ("Shirt_1", "isCreased", false, true),
        ("Flower_Pot_1", "isCreased", false, false),
        ("Shirt_1", "isFolded", false, true),
        ("Kettle_1", "isFolded", false, false),
        ("Curtains_1", "isOpen", false, true),
    ] {
        let states = if start { json!([{ state: "true" }]) } else { json!([]) };
        let mission = json!({
            "scene": {"roomLocation": ["BreakRoom"], "required_objects": [{"name": thing, "state": states}]},
            "task_goals": [{"goal_id": 0, "object_states": [{ thing: format!("{state}=true") }]}],
        });
        let read = read_mission("m", &mission.to_string(), homes.catalog());
        assert_eq!(read.is_ok(), expected, "{thing} {state}");
    }
}

/// A goal by a condition with this expression.
#[track_caller]
fn check_condition(expression: Value, reason: &str) {
    let objects = json!([{"name": "Bowl_01_1"}, {"name": "Apple_1"}, {"name": "FridgeLower_02_10000"}]);
    let conditions = json!([{"stateName": "Done", "context": "Bowl_01_1", "expression": expression}]);
    let expected =
        if reason.is_empty() { String::new() } else { format!("goal 0 cannot be met: of condition `Done`: {reason}") };
    let found = said(&objects, &json!([{"Bowl_01_1": "Done=true"}]), &conditions);
    assert_eq!(found, (expected, reason.is_empty()), "{expression}");
}

#[test]
fn conditions_that_never_hold() {
    let flag = |key: &str, target: &str, value: bool| json!({key: {"target": target, "value": value}});
    let open_bowl = || flag("isOpen", "Bowl_01_1", true);
    let why = "`Bowl_01_1` never gets into this state: Bowl is not openable";
    for (expression, reason) in [
        (flag("isHot", "Bowl_01_1", true), ""),
        (flag("isOpen", "Bowl_01_1", false), ""),
        (open_bowl(), why),
        (json!({"AND": {"expressions": [flag("isHot", "Bowl_01_1", true), open_bowl()]}}), why),
        (json!({"OR": {"expressions": [flag("isHot", "Bowl_01_1", true), open_bowl()]}}), ""),
        (json!({"OR": {"expressions": [open_bowl(), flag("isToggledOn", "Bowl_01_1", true)]}}), why),
        (json!({"NOT": {"expression": open_bowl()}}), ""),
        (json!({"NOT": {"expression": flag("isOpen", "Bowl_01_1", false)}}), "Bowl_01_1: isOpen=false always holds"),
        (
            json!({"isFullOfItems": {"target": "Apple_1", "value": true}}),
            "nothing can be in or on `Apple_1`: Apple is no receptacle",
        ),
        (json!({"IsReceptacle": {"target": "Apple_1", "value": true}}), "`Apple_1` is no receptacle"),
        (
            json!({"isFilledWith": {"target": "Apple_1", "fluid": "Milk"}}),
            "`Apple_1` never gets into this state: Apple is not fillable",
        ),
        (
            json!({"AND": [flag("isHot", "Bowl_01_1", true), flag("isHot", "Bowl_01_1", false)]}),
            "`Bowl_01_1` is never isHot=true and isHot=false at once",
        ),
    ] {
        check_condition(expression, reason);
    }
}

#[test]
fn one_of_several_ways_may_be_closed() {
    let mission = |states: Value| {
        json!({
            "scene": {"roomLocation": ["BreakRoom"], "required_objects": [{"name": "Bowl_01_1"}]},
            "task_goals": [{"goal_id": 0, "object_states": states, "object_states_relation": "or"}],
        })
    };
    let open_or_hot = mission(json!([{"Bowl_01_1": "isOpen=true"}, {"Bowl_01_1": "isHot=true"}]));
    let checked = read_mission("m", &open_or_hot.to_string(), &CATALOG).unwrap();
    assert_eq!(checked.warnings.len(), 1);
    let open_or_on = mission(json!([{"Bowl_01_1": "isOpen=true"}, {"Bowl_01_1": "isToggledOn=true"}]));
    let problems = read_mission("m", &open_or_on.to_string(), &CATALOG).unwrap_err();
    assert_eq!(problems.count(Severity::Error), 2);
}

/// What is said of these objects, with a goal that is fine.
#[track_caller]
fn check_objects(objects: Value, expected: &str, playable: bool) {
    let all: Vec<Value> =
        [json!({"name": "Cake_02_9"})].into_iter().chain(objects.as_array().unwrap().clone()).collect();
    let found = said(&json!(all), &json!([{"Cake_02_9": "isPickedUp=true"}]), &json!([]));
    assert_eq!(found, (expected.to_owned(), playable), "{objects}");
}

#[test]
fn places_that_are_not_there_or_take_nothing_more() {
    let mugs = |count: u32| -> Vec<Value> {
        (1..=count)
            .map(|number| json!({"name": format!("CoffeeMug_Yellow_{number}"), "location": [{"CoffeeMaker_01_1": "in"}]}))
            .collect()
    };
    check_objects(json!(mugs(1)), "", true);
    let anchors = CATALOG.class(CATALOG.find("CoffeeMaker_01").unwrap()).receptacle.as_ref().map_or(0, |receptacle| {
        receptacle.surfaces.iter().map(|surface| surface.anchors[0] * surface.anchors[1]).sum::<u32>()
    });
    let full = format!(
        "`CoffeeMaker_01_1` has {anchors} places: there is none left for `CoffeeMug_Yellow_{}`; put it elsewhere",
        anchors + 1
    );
    check_objects(json!(mugs(anchors + 1)), &full, false);
    check_objects(
        json!([{"name": "Apple_1", "location": [{"Laser_1": "in"}]}, {"name": "Laser_1"}]),
        "warning: `Laser_1` does not take a Apple; it is one of `Laser_Tip`, `Laser_CircuitBoard`, `Laser_ControlPanel`",
        true,
    );
    check_objects(
        json!([
            {"name": "Apple_1", "location": [{"FoodPlate_01_1": "on"}]},
            {"name": "FoodPlate_01_1", "state": [{"Removed": "true"}]}
        ]),
        "`FoodPlate_01_1` is not there: it is taken out of the world; take its `Removed` out",
        false,
    );
    check_objects(
        json!([{"name": "Apple_1", "roomLocation": ["Lab1"], "location": [{"Microwave_01_10000": "in"}]}]),
        "warning: `Microwave_01_10000` is in the break room, not in the robotics lab; the receptacle counts",
        true,
    );
    check_objects(
        json!([{"name": "Microwave_01_10000", "roomLocation": ["Lab1"]}]),
        "warning: `Microwave_01_10000` is in the break room, not in the robotics lab; the layout counts",
        true,
    );
    // What can be carried is brought there.
    check_objects(json!([{"name": "Apple_10000", "roomLocation": ["Lab1"]}]), "", true);
    check_objects(
        json!([{"name": "Apple_1", "printingObject": "Hammer"}]),
        "warning: a Apple prints nothing; say it of a `Printer_Cartridge`",
        true,
    );
}

#[test]
fn names_of_what_is_not_there() {
    let objects = json!([{"name": "Bowl_01_1"}, {"name": "Apple_1", "state": [{"Removed": "true"}]}]);
    for (states, expected) in [
        (json!([{"TAM_1": "isHappy=true"}]), ""),
        (json!([{"Carrot_01_*": "isPickedUp=true"}]), ""),
        (json!([{"Microwave_01_1": "isOpen=true"}]), ""),
        (
            json!([{"Apple_1": "isPickedUp=true"}]),
            "goal 0 cannot be met: `Apple_1` is taken out of the world: it is `Removed`",
        ),
        (json!([{"Light_Ceiling_77_*": "isToggledOn=true"}]), "unknown object `Light_Ceiling_77_*`"),
    ] {
        assert_eq!(said(&objects, &states, &json!([])).0, expected, "{states}");
    }
}

/// A name that is wrong where it is introduced is not held against those who write it well.
#[test]
fn a_misspelt_object_is_told_once() {
    let (found, _) = said(&json!([{"name": "Appel_1"}]), &json!([{"Apple_1": "isPickedUp=true"}]), &json!([]));
    assert_eq!(found, "unknown object `Appel_1`; did you mean `Apple_1`?");
}

#[test]
fn goals_that_wait_in_a_circle() {
    let goal = |id: u32, after: u32| json!({"goal_id": id, "object_states": [{"Apple_1": "isPickedUp=true"}], "preconditions": [after]});
    let mission = json!({
        "scene": {"roomLocation": ["BreakRoom"], "required_objects": [{"name": "Apple_1"}]},
        "task_goals": [goal(0, 2), goal(1, 0), goal(2, 1)],
    });
    let problems = read_mission("m", &mission.to_string(), &CATALOG).unwrap_err();
    let said: Vec<_> = problems.iter().map(|problem| problem.message.as_str()).collect();
    assert_eq!(said, ["goal 0 waits for itself", "goal 1 waits for itself", "goal 2 waits for itself"]);
}

#[test]
fn a_condition_that_nothing_names_is_warned_of() {
    let conditions =
        json!([{"stateName": "Idle", "context": "Apple_1", "expression": {"isPickedUp": {"target": "Apple_1"}}}]);
    let found = said(&json!([{"name": "Apple_1"}]), &json!([{"Apple_1": "isPickedUp=true"}]), &conditions);
    assert_eq!(found, ("warning: nothing names the condition `Idle`".to_owned(), true));
}

#[test]
fn problems_stand_where_they_are() {
    let text = "{\n  \"scene\": {\n    \"roomLocation\": [\"BreakRoom\"],\n    \"required_objects\": [\n      \
                {\"state\": [], \"name\": \"Bwl_01_1\"}, {}\n    ]\n  },\n  \"task_goals\": [], \"task_goals\": []\n}";
    let problems = read_mission("m.json", text, &CATALOG).unwrap_err();
    let said: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "m.json:5:21: /scene/required_objects/0/name: unknown object `Bwl_01_1`; did you mean `Bowl_01_1`?",
            "m.json:5:42: /scene/required_objects/1/name: the object has no name",
            "m.json:8:21: /task_goals: warning: the mission has no goals: it never ends",
            "m.json:8:21: /task_goals: warning: `task_goals` is there more than once; only the last counts; keep one of them",
        ]
    );
}

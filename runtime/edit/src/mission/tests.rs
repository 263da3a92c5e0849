//! Each edit of a mission, and a whole one that is made by edits alone.
#![allow(clippy::unwrap_used)]

use super::*;

fn document() -> MissionDocument {
    MissionDocument::new("missions/new.json", Arc::new(Catalog::builtin()))
}

/// The text after edits as the page sends them.
fn edited(text: &str, edits: &[Value]) -> String {
    let mission = document();
    let apply =
        |text: String, edit: &Value| mission.edited(&text, edit.clone()).unwrap_or_else(|why| panic!("{edit}: {why}"));
    edits.iter().fold(text.to_owned(), apply)
}

fn empty() -> String {
    document().empty("OfficeLayout1").unwrap()
}

/// A mug in the break room is to be on a desk.
fn mug() -> String {
    let mug = json!({ "name": "CoffeeMug_Boss", "on": "TableRound_02_1", "states": [["Unique", "true"]] });
    let goal = json!({
        "description": "Put the mug on the desk",
        "states": [["ManagerDesk_10000", "Contains", "CoffeeMug_Boss_1"]],
    });
    let edits = [
        json!({ "do": "say", "what": "goal", "words": "Bring the mug" }),
        json!({ "do": "say", "what": "beginning", "words": "The boss wants coffee." }),
        json!({ "do": "start", "room": "BreakRoom" }),
        json!({ "do": "add_object", "object": mug }),
        json!({ "do": "add_goal", "goal": goal }),
    ];
    edited(&empty(), &edits)
}

#[test]
fn a_mission_of_forms_alone_is_solved() {
    let (mission, text) = (document(), mug());
    let shown = mission.shown(&text);
    assert!(shown["faults"].as_array().unwrap().iter().all(|fault| fault["is_warning"] == true), "{shown}");
    assert_eq!((&shown["is_drawn"], mission.is_sound(&text)), (&json!(true), true));
    let form = &shown["form"];
    assert_eq!(
        (&form["goal"], &form["start"], &form["plan"]),
        (&json!("Bring the mug"), &json!("BreakRoom"), &json!("OfficeLayout1"))
    );
    assert_eq!(form["beginning"], "The boss wants coffee.");
    assert_eq!(form["objects"][0]["name"], "CoffeeMug_Boss_1");
    assert_eq!(form["goals"][0]["states"], json!([["ManagerDesk_10000", "Contains", "CoffeeMug_Boss_1"]]));
    let tried = mission.tried(&text).unwrap().unwrap();
    assert!(tried.steps.len() > 1 && tried.seconds > 0, "{tried:?}");
    assert!(mission.drawn(&text).is_some_and(|drawn| drawn.instances.len() > 100));
    // What cannot be is told where it stands, and why.
    let impossible = json!({ "states": [["ManagerDesk_10000", "isCut", "true"]] });
    let text = edited(&text, &[json!({ "do": "add_goal", "goal": impossible })]);
    let shown = mission.shown(&text);
    let fault = shown["faults"].as_array().unwrap().iter().find(|fault| fault["is_warning"] == false).unwrap();
    assert!(fault["at"].as_str().unwrap().starts_with("/task_goals/1"), "{fault}");
    assert!(!mission.is_sound(&text) && mission.tried(&text).unwrap().is_err());
    assert!(mission.tried(&empty()).unwrap().unwrap_err().contains("no goal"));
}

#[test]
fn what_forms_do_not_have_stays_as_it_is() {
    let text = include_str!("../../../../cdf/missions/warm_coffee.json");
    let before: Value = serde_json::from_str(text).unwrap();
    let same = edited(text, &[json!({ "do": "say", "what": "goal", "words": before["goal_text"] })]);
    assert_eq!(serde_json::from_str::<Value>(&same).unwrap(), before);
    let form = document().shown(text)["form"].clone();
    let object = form["objects"][0].clone();
    let kept = edited(text, &[json!({ "do": "set_object", "index": 0, "object": object })]);
    let kept: Value = serde_json::from_str(&kept).unwrap();
    let own = |mission: &Value| mission["scene"]["required_objects"][0].clone();
    assert_eq!(
        (&own(&kept)["name"], kept["task_goals"].clone()),
        (&own(&before)["name"], before["task_goals"].clone())
    );
}

#[test]
fn objects_and_goals_are_changed_one_by_one() {
    let second = json!({ "description": "Then", "states": [["CoffeeMug_Boss_1", "isDirty", "true"]], "any": true, "after": [0] });
    let edits = [
        json!({ "do": "add_object", "object": { "name": "CoffeeMug_Boss", "room": "Lab1" } }),
        json!({ "do": "add_goal", "goal": second }),
        json!({ "do": "set_object", "index": 0, "object": { "name": "CoffeeMug_Boss_1", "on": "FridgeLower_02_10000" } }),
        json!({ "do": "plan", "id": "OfficeLayout2" }),
    ];
    let text = edited(&mug(), &edits);
    let value: Value = serde_json::from_str(&text).unwrap();
    let objects = &value["scene"]["required_objects"];
    assert_eq!((&objects[1]["name"], &objects[1]["roomLocation"]), (&json!("CoffeeMug_Boss_2"), &json!(["Lab1"])));
    assert_eq!(objects[0]["location"], json!([{ "FridgeLower_02_10000": "in" }]));
    let goal = &value["task_goals"][1];
    assert_eq!(
        (&goal["goal_id"], &goal["preconditions"], &goal["object_states_relation"]),
        (&json!(1), &json!([0]), &json!("or"))
    );
    let fewer =
        edited(&text, &[json!({ "do": "remove_goal", "index": 0 }), json!({ "do": "remove_object", "index": 1 })]);
    let value: Value = serde_json::from_str(&fewer).unwrap();
    assert_eq!(
        (&value["task_goals"][0]["preconditions"], value["scene"]["required_objects"].as_array().unwrap().len()),
        (&json!([]), 1)
    );
}

#[test]
fn what_cannot_be_is_said_in_words() {
    let mission = document();
    for (text, edit, said) in [
        (empty(), json!({ "do": "plan", "id": "Nowhere" }), "there is no layout `Nowhere`"),
        (empty(), json!({ "do": "add_goal", "goal": {} }), "at least one state"),
        (empty(), json!({ "do": "remove_object", "index": 3 }), "gone already"),
        (empty(), json!({ "do": "set_goal", "index": 3, "goal": {} }), "no such goal"),
        (empty(), json!({ "do": "dance" }), "no edit of a mission"),
        ("{".to_owned(), json!({ "do": "start", "room": "Lab1" }), "no JSON"),
        ("[]".to_owned(), json!({ "do": "start", "room": "Lab1" }), "no mission"),
        ("{\"scene\": 1}".to_owned(), json!({ "do": "start", "room": "Lab1" }), "`scene` in the file"),
    ] {
        let told = mission.edited(&text, edit).unwrap_err();
        assert!(told.contains(said), "`{said}` is not in {told}");
    }
    let shown = mission.shown("{");
    assert!(shown["form"].is_null() && shown["faults"][0]["message"].as_str().unwrap().contains("no JSON"), "{shown}");
    assert!(mission.misfit("{\"a\": {\"cdf\": {\"scene\": {}}}, \"b\": {\"cdf\": {\"scene\": {}}}}").is_some());
    assert!(mission.misfit(&mug()).is_none());
}

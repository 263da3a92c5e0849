//! Missions with one goal.

use serde_json::{Value, json};

/// A mission in the break room with these objects and one goal, which may open again.
pub fn mission(objects: &[Value], instance: &str, state: &str, can_reset: bool) -> String {
    json!({
        "task_description": "", "goal_text": "one",
        "scene": {
            "floor_plan": "1", "scene_id": "one", "roomLocation": ["BreakRoom"], "required_objects": objects,
            "layoutOverride": "OfficeLayout1",
        },
        "task_goals": [{
            "goal_id": 4, "description": "Get it done", "object_states": [{ instance: state }],
            "object_states_relation": "and", "preconditions": [],
            "visibility": { "isHidden": false, "activationInteractable": "ALWAYS UNLOCKED", "stickyNoteIndex": 0 },
            "canReset": can_reset,
        }],
        "stateconditions": [],
    })
    .to_string()
}

/// An object in the break room, with its states.
pub fn object(name: &str, states: &[(&str, &str)]) -> Value {
    let states: Vec<Value> = states.iter().map(|(key, value)| json!({ *key: value })).collect();
    json!({ "name": name, "state": states, "roomLocation": ["BreakRoom"] })
}

//! A mission as the forms of the page show it, and what they offer.

use cohabit_cdf::{
    Catalog, Layout,
    mission::{GoalForm, Problem, Severity, goal_kinds},
};
use serde_json::{Map, Value, json};

/// The forms of a mission, as far as its text can be read, and what is wrong in it.
pub fn mission(text: &str, problems: &[Problem], unbuilt: Option<&str>, catalog: &Catalog) -> Value {
    let problem = |problem: &Problem| {
        json!({
            "message": problem.message,
            "remedy": problem.remedy,
            "at": problem.pointer,
            "is_warning": problem.severity == Severity::Warning,
        })
    };
    // What has no room in the world stands at what the forms are of as a whole.
    let unbuilt = unbuilt.map(|message| json!({ "message": message, "at": "/scene" }));
    let faults: Vec<Value> = problems.iter().map(problem).chain(unbuilt).collect();
    let value: Value = serde_json::from_str(text.trim_start_matches('\u{feff}')).unwrap_or_default();
    let scene = &value["scene"];
    let messages = &value["game_interactions"]["game_messages"];
    let layout = scene["layoutOverride"].as_str().and_then(|id| Layout::find(id, catalog).ok());
    json!({
        "faults": faults,
        "form": value.is_object().then(|| json!({
            "goal": value["goal_text"],
            "story": value["task_description"],
            "beginning": messages["task_beginning"][0]["message"],
            "ending": messages["task_ending"][0]["message"],
            "plan": scene["layoutOverride"],
            "start": scene["roomLocation"][0],
            "objects": all(&scene["required_objects"], object),
            "goals": all(&value["task_goals"], goal),
        })),
        "layout": layout.map(|layout| of_plan(&layout, catalog)),
    })
}

fn all(list: &Value, shown: impl Fn(&Value) -> Value) -> Vec<Value> {
    list.as_array().into_iter().flatten().map(shown).collect()
}

/// `{"isHot": "true", …}` as pairs of texts.
fn pairs(entry: &Map<String, Value>) -> impl Iterator<Item = [String; 2]> + '_ {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    entry.iter().map(move |(key, value)| [key.clone(), text(value)])
}

fn object(object: &Value) -> Value {
    let states = object["state"].as_array().into_iter().flatten().filter_map(Value::as_object).flat_map(pairs);
    let place = object["location"][0].as_object().and_then(|place| place.keys().next());
    json!({
        "name": object["name"],
        "room": object["roomLocation"][0],
        "on": place,
        "states": states.collect::<Vec<_>>(),
    })
}

fn goal(goal: &Value) -> Value {
    let states = goal["object_states"].as_array().into_iter().flatten().filter_map(Value::as_object).flat_map(pairs);
    let states = states.map(|[object, state]| {
        let (key, value) = state.split_once('=').unwrap_or((state.as_str(), ""));
        [object, key.trim().to_owned(), value.trim().to_owned()]
    });
    json!({
        "number": goal["goal_id"],
        "description": goal["description"],
        "states": states.collect::<Vec<_>>(),
        "any": goal["object_states_relation"] == "or",
        "after": goal["preconditions"],
    })
}

/// What a floor plan has that missions name.
fn of_plan(layout: &Layout, catalog: &Catalog) -> Value {
    let rooms = layout.rooms.iter().map(|room| json!({ "id": room.id, "name": room.id.name_in(catalog) }));
    let things = layout.placements.iter().map(|placement| {
        let class = catalog.class_of_instance(&placement.instance).map(|class| catalog.class(class));
        json!({
            "instance": placement.instance,
            "name": class.map(|class| &class.name),
            "room": placement.room.name_in(catalog),
            "holds": class.is_some_and(|class| class.receptacle.is_some()),
        })
    });
    let views = layout.viewpoints.iter().map(|view| json!(view));
    json!({
        "rooms": rooms.collect::<Vec<_>>(),
        "things": things.collect::<Vec<_>>(),
        "views": views.collect::<Vec<_>>(),
    })
}

/// The values that a state takes; none, where it takes an object.
fn values(key: &str) -> &'static [&'static str] {
    match key {
        "isFilled" | "ContainsFluid" => &["Water", "Milk", "Coffee", "None"],
        "ColorMetaDataChange" => &["Red", "Green", "Blue", "Original"],
        "Contains" => &[],
        _ => &["true", "false"],
    }
}

/// What missions can name and ask for.
pub fn choices(catalog: &Catalog) -> Value {
    let classes = catalog
        .classes()
        .iter()
        .map(|class| json!({ "id": class.id, "name": class.name, "holds": class.receptacle.is_some() }));
    let states = goal_kinds().filter(|kind| kind.form == GoalForm::State);
    let states = states.map(|kind| json!({ "key": kind.key, "meaning": kind.meaning, "values": values(kind.key) }));
    json!({
        "plans": Layout::ids(catalog),
        "classes": classes.collect::<Vec<_>>(),
        "states": states.collect::<Vec<_>>(),
    })
}

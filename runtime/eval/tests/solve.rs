//! Missions played by the expert, from their goals alone.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cohabit_cdf::{Catalog, mission};
use cohabit_eval::{Caps, Played, Settings, Task, solve};
use serde_json::{Value, json};

fn task(id: &str, cdf: String) -> Task {
    Task { id: id.to_owned(), family: None, cdf, preparation: Vec::new(), script: Vec::new() }
}

fn played(task: &Task, settings: &Settings) -> Played {
    solve(task, settings, &Arc::new(Catalog::builtin())).unwrap()
}

/// The built-in mission of that name.
fn builtin(name: &str) -> String {
    let (_, text) = mission::builtin().iter().find(|(file, _)| file.starts_with(name)).unwrap();
    (*text).to_owned()
}

#[test]
fn the_missions_of_the_project_are_solved_and_the_same_again() {
    for (name, text) in mission::builtin() {
        let task = task(name, (*text).to_owned());
        let (one, other) = (played(&task, &Settings::default()), played(&task, &Settings::default()));
        assert!(one.success && one.ended_early.is_none(), "{name}: {:?}, {:?}", one.first_trouble, one.ended_early);
        assert!(one.actions > 0 && one.failed_actions == 0 && one.questions == 0, "{name}: {one:?}");
        assert_eq!((one.ticks, &one.statuses), (other.ticks, &other.statuses), "{name}");
    }
}

#[test]
fn a_goal_that_cannot_be_reached_is_named_with_the_reason() {
    let mut cdf: Value = serde_json::from_str(&builtin("cold_soda")).unwrap();
    cdf["task_goals"][0]["object_states"] = json!([{ "CanSodaNew_01_1": "isSparking=true" }]);
    let played = played(&task("sparks", cdf.to_string()), &Settings::default());
    assert!(!played.success);
    let why = played.ended_early.unwrap();
    assert!(why.contains("goal 0") && why.contains("cannot be reached"), "{why}");
    assert!(!played.open_goals.is_empty());
}

#[test]
fn caps_and_missions_that_cannot_be_read_end_it() {
    let settings = Settings { caps: Some(Caps { actions: 2, failed: 5 }), ..Settings::default() };
    let capped = played(&task("capped", builtin("make_cereal")), &settings);
    assert_eq!(capped.ended_early.as_deref(), Some("too many actions"));
    let unread = played(&task("unread", "no mission".to_owned()), &Settings::default());
    assert!(unread.ended_early.unwrap().starts_with("not playable: "));
}

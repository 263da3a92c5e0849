//! A world pack of floor plans.

use std::fmt::Write as _;

use cohabit_cdf::{
    RoomEntry, RoomId,
    world_pack::{HEAD, builtin_names, is_name},
};

use crate::plans::{FloorPlan, FloorPlans, PlanError};

/// The most plans of a pack, which has at most 1,000 files.
pub const MOST_PLANS: usize = 990;

/// Whether a pack may have this name and so many plans.
///
/// # Errors
/// [`PlanError::Name`], [`PlanError::Taken`] or [`PlanError::Count`].
pub fn check(name: &str, count: usize) -> Result<(), PlanError> {
    if !is_name(name) {
        return Err(PlanError::Name { name: name.to_owned() });
    }
    if builtin_names().any(|other| other == name) {
        return Err(PlanError::Taken { name: name.to_owned() });
    }
    if !(1..=MOST_PLANS).contains(&count) {
        return Err(PlanError::Count { count, most: MOST_PLANS });
    }
    Ok(())
}

/// The files of a pack with these plans, as `(path from its folder, text)`.
#[must_use]
pub fn files(name: &str, plans: &FloorPlans, made: &[FloorPlan]) -> Vec<(String, String)> {
    let head = (HEAD.to_owned(), head(name, plans, made));
    let layouts = made.iter().map(|plan| (format!("layouts/{}.toml", plan.id), plan.text.clone()));
    let first = made.first().and_then(|plan| Some((plan, *plan.rooms.first()?)));
    let mission = first.map(|(plan, room)| look_around(name, &plan.id, room));
    std::iter::once(head).chain(layouts).chain(mission).collect()
}

fn head(name: &str, plans: &FloorPlans, made: &[FloorPlan]) -> String {
    let (kind, rooms, seed) = (plans.kind(), plans.rooms(), plans.seed());
    let needs =
        kind.pack().map_or_else(String::new, |pack| format!(" Load it behind {pack}: --world {pack} --world {name}."));
    let mut text = format!(
        "# Made by `cohabit generate-world --kind {kind} --rooms {rooms} --seed {seed} --count {count}`.\n\
         name = \"{name}\"\nversion = \"0.1.0\"\nlicence = \"CC0-1.0\"\n\
         description = \"{count} floor plans of {kind}s with {rooms} rooms each, made at random from the seed {seed}.{needs}\"\n",
        count = made.len()
    );
    let is_there = |entry: &RoomEntry| made.iter().any(|plan| plan.rooms.contains(&entry.id));
    for entry in plans.room_entries().filter(is_there) {
        text.push_str(&room(&entry));
    }
    text
}

/// A room as the head of a pack declares it.
#[must_use]
pub fn room(entry: &RoomEntry) -> String {
    let list = |words: &[String]| words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ");
    let RoomEntry { id, name, words, kind, color, .. } = entry;
    let mut text = format!("\n[[room]]\nid = \"{id}\"\nname = \"{name}\"\nwords = [{}]\n", list(words));
    if !kind.is_empty() {
        let _ = writeln!(text, "kind = [{}]", list(kind));
    }
    if let Some(color) = color {
        let _ = writeln!(text, "color = \"{color}\"");
    }
    text
}

/// The file of a mission without goals that begins in a room of a plan, so that there is something to play.
#[must_use]
pub fn look_around(name: &str, plan: &str, room: RoomId) -> (String, String) {
    let text = format!(
        r#"{{
  "task_description": "Walk around and look at what is there. There is nothing to do.",
  "goal_text": "Look around",
  "game_id": "1",
  "scene": {{
    "floor_plan": "1",
    "scene_id": "Look around",
    "simbot_init": [],
    "roomLocation": ["{room}"],
    "required_objects": [],
    "sticky_notes": [],
    "blacklisted_layouts": null,
    "layoutOverride": "{plan}",
    "completelyRandomVisual": false
  }},
  "task_goals": [],
  "stateconditions": []
}}
"#
    );
    (format!("missions/look_around_{name}.json"), text)
}

//! A mission that is edited: forms of the page become parts of its file (CDF); what the forms do not have stays as it is.

mod shown;

use std::sync::Arc;

use cohabit_cdf::{
    Catalog, Layout, RoomId,
    mission::{Checked, Problem, read_mission, sources},
};
use cohabit_engine::furnishings;
use cohabit_generate::{certify, world_of};
use cohabit_world::World;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::document::{Document, Drawn, Tried};

/// The seed of what missions leave to chance.
const SEED: u64 = 0;
/// Ticks of a second.
const TICKS_PER_SECOND: u64 = 60;
/// The longest text of a form, bytes.
const LONGEST: usize = 4000;

/// A change of a mission.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "do", rename_all = "snake_case")]
pub enum MissionEdit {
    /// Another text of the file.
    Text {
        /// All of it.
        text: String,
    },
    /// Other words.
    Say {
        /// Which.
        what: Words,
        /// What they are.
        words: String,
    },
    /// Another floor plan.
    Plan {
        /// Its id.
        id: String,
    },
    /// Another room where the robot begins.
    Start {
        /// Which.
        room: RoomId,
    },
    /// One more object.
    AddObject {
        /// What the form says of it.
        object: ObjectForm,
    },
    /// Another object in the place of one, or the same one otherwise.
    SetObject {
        /// Its place in the file.
        index: usize,
        /// What the form says of it.
        object: ObjectForm,
    },
    /// An object less.
    RemoveObject {
        /// Its place in the file.
        index: usize,
    },
    /// One more goal.
    AddGoal {
        /// What the form says of it.
        goal: GoalForm,
    },
    /// Another goal in the place of one.
    SetGoal {
        /// Its place in the file.
        index: usize,
        /// What the form says of it.
        goal: GoalForm,
    },
    /// A goal less; no other one waits for it any more.
    RemoveGoal {
        /// Its place in the file.
        index: usize,
    },
}

/// What people read of a mission.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Words {
    /// What is to be got done, in a line.
    Goal,
    /// The story around it.
    Story,
    /// What the robot says first.
    Beginning,
    /// What it says last.
    Ending,
}

/// An object of a mission.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default)]
pub struct ObjectForm {
    /// An instance, or a class, of which it becomes a new one.
    pub name: String,
    /// Its room; any, if it is none.
    pub room: Option<RoomId>,
    /// What it is in or on, if it is.
    pub on: Option<String>,
    /// Its states: key and value.
    pub states: Vec<[String; 2]>,
}

/// A goal of a mission.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default)]
pub struct GoalForm {
    /// What people read.
    pub description: String,
    /// What must hold: object, key and value.
    pub states: Vec<[String; 3]>,
    /// Whether any of these is enough.
    pub any: bool,
    /// The numbers of goals that are met before this one counts.
    pub after: Vec<i64>,
}

/// The mission of a file, and what it is checked against.
#[derive(Clone, Debug)]
pub struct MissionDocument {
    file: String,
    catalog: Arc<Catalog>,
}

impl MissionDocument {
    /// The mission of `file`, in the world that the catalogue is of.
    #[must_use]
    pub fn new(file: &str, catalog: Arc<Catalog>) -> Self {
        Self { file: file.to_owned(), catalog }
    }

    /// The text of a mission on a floor plan that has no file yet.
    ///
    /// # Errors
    /// [`cohabit_cdf::LayoutError`] in words.
    pub fn empty(&self, plan: &str) -> Result<String, String> {
        let layout = Layout::find(plan, &self.catalog).map_err(|error| error.to_string())?;
        let start = layout.rooms.first().map(|room| room.id);
        Ok(pretty(&blank("", plan, start)))
    }

    /// Why the forms of the page do not fit a text, if so: they are of one mission.
    #[must_use]
    pub fn misfit(&self, text: &str) -> Option<String> {
        match sources(&self.file, text).as_slice() {
            [one] if one.pointer.is_root() => None,
            _ => Some("the file holds records of missions, or several ones: name a file of one mission".to_owned()),
        }
    }

    /// The text after an edit.
    ///
    /// # Errors
    /// Why that cannot be, in words.
    pub fn apply(&self, text: &str, edit: MissionEdit) -> Result<String, String> {
        if let MissionEdit::Text { text } = edit {
            return Ok(text);
        }
        let value: Value = serde_json::from_str(text.trim_start_matches('\u{feff}'))
            .map_err(|error| format!("the text of the file is no JSON: mend it first, or undo ({error})"))?;
        if !value.is_object() {
            return Err("the text of the file is no mission: mend it first, or undo".to_owned());
        }
        let mut work = Work { mission: value, catalog: &self.catalog };
        match edit {
            MissionEdit::Text { .. } => {}
            MissionEdit::Say { what, words } => work.say(what, &words)?,
            MissionEdit::Plan { id } => work.plan(&id)?,
            MissionEdit::Start { room } => work.scene()?["roomLocation"] = json!([room]),
            MissionEdit::AddObject { object } => {
                let entry = work.object(&object, None)?;
                work.list("required_objects")?.push(entry);
            }
            MissionEdit::SetObject { index, object } => {
                let before = work.list("required_objects")?.get(index).cloned().ok_or("there is no such object")?;
                let entry = work.object(&object, Some(before))?;
                work.list("required_objects")?[index] = entry;
            }
            MissionEdit::RemoveObject { index } => remove(work.list("required_objects")?, index)?,
            MissionEdit::AddGoal { goal } => {
                let entry = work.goal(&goal, None)?;
                work.goals()?.push(entry);
            }
            MissionEdit::SetGoal { index, goal } => {
                let before = work.goals()?.get(index).cloned().ok_or("there is no such goal")?;
                let entry = work.goal(&goal, Some(before))?;
                work.goals()?[index] = entry;
            }
            MissionEdit::RemoveGoal { index } => work.remove_goal(index)?,
        }
        Ok(pretty(&work.mission))
    }

    /// The mission, if it can be read, and all that is wrong in it, also as it is laid out.
    fn looked_over(&self, text: &str) -> (Option<Checked>, Vec<Problem>, Option<String>) {
        let checked = match read_mission(&self.file, text, &self.catalog) {
            Ok(checked) => checked,
            Err(problems) => return (None, problems.0, None),
        };
        let layout = match Layout::find(&checked.mission.layout, &self.catalog) {
            Ok(layout) => layout,
            Err(error) => return (None, checked.warnings, Some(error.to_string())),
        };
        let mission = Arc::new(checked.mission.clone());
        let built = World::new(Arc::clone(&self.catalog), Arc::new(layout), mission, SEED);
        let warnings = checked.warnings.clone();
        (Some(checked), warnings, built.err().map(|error| error.to_string()))
    }
}

impl Document for MissionDocument {
    fn kind(&self) -> &'static str {
        "mission"
    }

    fn edited(&self, text: &str, edit: Value) -> Result<String, String> {
        let edit = serde_json::from_value(edit).map_err(|error| format!("this is no edit of a mission: {error}"))?;
        self.apply(text, edit)
    }

    fn shown(&self, text: &str) -> Value {
        let (checked, problems, unbuilt) = self.looked_over(text);
        let mut shown = shown::mission(text, &problems, unbuilt.as_deref(), &self.catalog);
        shown["is_drawn"] = json!(checked.is_some() && unbuilt.is_none());
        shown
    }

    fn choices(&self) -> Value {
        shown::choices(&self.catalog)
    }

    fn drawn(&self, text: &str) -> Option<Drawn> {
        let world = world_of(&self.file, text, &self.catalog, SEED).ok()?;
        let instances = furnishings(&world).collect();
        Some(Drawn { layout: world.layout().as_ref().clone(), instances })
    }

    fn is_sound(&self, text: &str) -> bool {
        world_of(&self.file, text, &self.catalog, SEED).is_ok()
    }

    fn mission(&self, text: &str) -> String {
        text.to_owned()
    }

    fn tried(&self, text: &str) -> Option<Result<Tried, String>> {
        let has_goals = |checked: Checked| !checked.mission.goals.is_empty();
        if !read_mission(&self.file, text, &self.catalog).is_ok_and(has_goals) {
            return Some(Err("there is no goal to be met yet, or the mission cannot be read".to_owned()));
        }
        let tried = certify(&self.file, text, &self.catalog, SEED).map(|certificate| Tried {
            steps: certificate.plan.iter().map(|step| step.said.clone()).collect(),
            seconds: certificate.ticks / TICKS_PER_SECOND,
        });
        Some(tried)
    }
}

/// A mission without objects and goals, which begins in a room of a floor plan.
pub fn blank(goal: &str, plan: &str, start: Option<RoomId>) -> Value {
    let none = json!({ "task_beginning": [], "task_procedure": [], "task_ending": [], "object_conditions": [] });
    json!({
        "task_description": "",
        "goal_text": goal,
        "game_id": "1",
        "scene": {
            "floor_plan": "1",
            "scene_id": goal,
            "simbot_init": [],
            "roomLocation": start.iter().collect::<Vec<_>>(),
            "required_objects": [],
            "sticky_notes": [],
            "blacklisted_layouts": null,
            "layoutOverride": plan,
            "completelyRandomVisual": false,
        },
        "task_goals": [],
        "stateconditions": [],
        "game_interactions": { "camera_movements": none, "game_messages": none },
    })
}

/// As the project writes missions.
fn pretty(mission: &Value) -> String {
    format!("{mission:#}\n")
}

fn remove(list: &mut Vec<Value>, index: usize) -> Result<(), String> {
    if index >= list.len() {
        return Err("it is gone already".to_owned());
    }
    list.remove(index);
    Ok(())
}

/// A part of a mission, which is made where it lacks or is null; what is something else is not written over.
fn part<'a>(of: &'a mut Value, key: &str, empty: Value) -> Result<&'a mut Value, String> {
    let misfit = || format!("`{key}` in the file is not what it should be: mend its text first");
    let parts = of.as_object_mut().ok_or_else(misfit)?;
    let part = parts.entry(key).or_insert(Value::Null);
    if part.is_null() {
        *part = empty;
    }
    Ok(part)
}

fn list<'a>(of: &'a mut Value, key: &str) -> Result<&'a mut Vec<Value>, String> {
    let misfit = || format!("`{key}` in the file is no list: mend its text first");
    part(of, key, json!([]))?.as_array_mut().ok_or_else(misfit)
}

/// A mission at work.
struct Work<'a> {
    mission: Value,
    catalog: &'a Catalog,
}

impl Work<'_> {
    fn scene(&mut self) -> Result<&mut Value, String> {
        let scene = part(&mut self.mission, "scene", json!({}))?;
        if scene.is_object() {
            Ok(scene)
        } else {
            Err("`scene` in the file is no object: mend its text first".to_owned())
        }
    }

    fn list(&mut self, key: &str) -> Result<&mut Vec<Value>, String> {
        list(self.scene()?, key)
    }

    fn goals(&mut self) -> Result<&mut Vec<Value>, String> {
        list(&mut self.mission, "task_goals")
    }

    fn say(&mut self, what: Words, words: &str) -> Result<(), String> {
        if words.len() > LONGEST {
            return Err(format!("write at most {LONGEST} bytes"));
        }
        let when = match what {
            Words::Goal => {
                // The name of a new mission is what it asks for.
                let scene = self.scene()?;
                if scene["scene_id"].as_str().is_none_or(str::is_empty) {
                    scene["scene_id"] = json!(words);
                }
                self.mission["goal_text"] = json!(words);
                return Ok(());
            }
            Words::Story => {
                self.mission["task_description"] = json!(words);
                return Ok(());
            }
            Words::Beginning => "task_beginning",
            Words::Ending => "task_ending",
        };
        let interactions = part(&mut self.mission, "game_interactions", json!({}))?;
        let messages = list(part(interactions, "game_messages", json!({}))?, when)?;
        if words.trim().is_empty() {
            messages.clear();
        } else if let Some(Value::Object(first)) = messages.first_mut() {
            first.insert("message".to_owned(), json!(words));
        } else {
            *messages = vec![json!({ "message": words })];
        }
        Ok(())
    }

    /// Another plan; the robot begins in a room that this one has.
    fn plan(&mut self, id: &str) -> Result<(), String> {
        let layout = Layout::find(id, self.catalog).map_err(|error| error.to_string())?;
        let scene = self.scene()?;
        scene["layoutOverride"] = json!(id);
        let start = scene["roomLocation"][0].as_str().and_then(RoomId::new);
        if start.is_none_or(|start| layout.room(start).is_none()) {
            scene["roomLocation"] = json!(layout.rooms.first().map(|room| room.id).iter().collect::<Vec<_>>());
        }
        Ok(())
    }

    /// The entry of an object; what the form does not have stays as it was before.
    fn object(&mut self, form: &ObjectForm, before: Option<Value>) -> Result<Value, String> {
        let catalog = self.catalog;
        let is_same = before.as_ref().is_some_and(|before| before["name"].as_str() == Some(form.name.as_str()));
        let is_class = catalog.find(&form.name).is_some() && !is_same;
        let name = if is_class { self.new_instance(&form.name)? } else { form.name.clone() };
        let mut entry = match before {
            Some(Value::Object(entry)) => entry,
            _ => Map::new(),
        };
        let states = form.states.iter().filter(|[key, _]| !key.is_empty());
        let states: Vec<Value> = states.map(|[key, value]| json!({ key: value })).collect();
        let location = form.on.iter().filter(|on| !on.is_empty()).map(|on| {
            let class = catalog.class_of_instance(on).map(|class| catalog.class(class));
            let is_enclosed = class.and_then(|class| class.receptacle.as_ref()).is_some_and(|place| place.enclosed);
            json!({ on: if is_enclosed { "in" } else { "on" } })
        });
        entry.insert("name".to_owned(), json!(name));
        entry.insert("state".to_owned(), json!(states));
        entry.insert("location".to_owned(), json!(location.collect::<Vec<_>>()));
        entry.insert("roomLocation".to_owned(), json!(form.room.iter().collect::<Vec<_>>()));
        Ok(Value::Object(entry))
    }

    /// A name that neither the mission nor its floor plan has; the class alone, if that is what an object of the plan is called.
    fn new_instance(&mut self, class: &str) -> Result<String, String> {
        let plan = self.scene()?["layoutOverride"].as_str().map(str::to_owned);
        let layout = plan.and_then(|plan| Layout::find(&plan, self.catalog).ok());
        if layout.as_ref().is_some_and(|layout| layout.placement(class).is_some()) {
            return Ok(class.to_owned());
        }
        let listed = self.list("required_objects")?;
        let is_free = |name: &String| {
            let is_placed = layout.as_ref().is_some_and(|layout| layout.placement(name).is_some());
            !is_placed && listed.iter().all(|object| object["name"].as_str() != Some(name.as_str()))
        };
        let free = (1..10_000).map(|number| format!("{class}_{number}")).find(is_free);
        free.ok_or_else(|| format!("there are too many `{class}` already"))
    }

    /// The entry of a goal; what the form does not have stays as it was before.
    fn goal(&mut self, form: &GoalForm, before: Option<Value>) -> Result<Value, String> {
        let incomplete = form.states.iter().any(|state| state.iter().any(|part| part.trim().is_empty()));
        if form.states.is_empty() || incomplete {
            return Err("a goal asks for at least one state: choose an object, a state and its value".to_owned());
        }
        let numbers = self.goals()?.iter().filter_map(|goal| goal["goal_id"].as_i64());
        let number = numbers.max().map_or(0, |last| last + 1);
        let mut entry = match before {
            Some(Value::Object(entry)) => entry,
            _ => {
                let visibility =
                    json!({ "isHidden": false, "activationInteractable": "ALWAYS UNLOCKED", "stickyNoteIndex": 0 });
                let pairs = [("goal_id", json!(number)), ("visibility", visibility), ("canReset", json!(false))];
                pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
            }
        };
        let state = |[object, key, value]: &[String; 3]| json!({ object: format!("{key}={value}") });
        entry.insert("description".to_owned(), json!(form.description));
        entry.insert("object_states".to_owned(), json!(form.states.iter().map(state).collect::<Vec<_>>()));
        entry.insert("object_states_relation".to_owned(), json!(if form.any { "or" } else { "and" }));
        entry.insert("preconditions".to_owned(), json!(form.after));
        Ok(Value::Object(entry))
    }

    fn remove_goal(&mut self, index: usize) -> Result<(), String> {
        let goals = self.goals()?;
        let number = goals.get(index).and_then(|goal| goal["goal_id"].as_i64());
        remove(goals, index)?;
        let waiting = goals.iter_mut().filter_map(|goal| goal.get_mut("preconditions")?.as_array_mut());
        waiting.for_each(|before| before.retain(|other| number.is_none() || other.as_i64() != number));
        Ok(())
    }
}

#[cfg(test)]
mod tests;

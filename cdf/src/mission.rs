//! A mission, checked: what a world is built from, and how it is read from a CDF file.

mod expression;
mod goals;
mod key;
mod messages;
mod names;
mod nearest;
mod objects;
pub mod problem;
pub mod raw;
mod reader;
mod scene;

use serde::{Deserialize, Serialize};

use self::{goals::Named, raw::Loose, reader::Reader};
pub use self::{
    key::{flag_key, flag_of_key},
    problem::{Pointer, Problem, Problems, Severity},
    raw::Cdf,
};
use crate::{
    builtin,
    catalog::Catalog,
    goal::{Goal, StateCondition},
    layout::RoomId,
    state::{Color, Fluid, StateFlag},
};

/// A mission, read from a CDF file and checked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mission {
    /// `scene_id`, such as `01 (Make_Cereal)`.
    pub name: String,
    /// What people are asked to get done, one line (`goal_text`).
    pub goal_text: String,
    /// The story around it (`task_description`).
    pub description: String,
    /// The floor plan's id.
    pub layout: String,
    /// The seed of what is placed at random; `None` is random.
    pub seed: Option<u64>,
    /// Where the robot starts.
    pub start_room: RoomId,
    /// What must be there, in the order of the file.
    pub objects: Vec<ObjectRequest>,
    /// Sticky notes at named places.
    pub notes: Vec<NoteRequest>,
    /// What must be reached.
    pub goals: Vec<Goal>,
    /// Conditions that the goals name.
    pub conditions: Vec<StateCondition>,
    /// What people are told, and when.
    pub messages: Vec<Message>,
}

impl Mission {
    /// The condition that a goal means which names it for `instance`: the one of that context, else the first of that name.
    #[must_use]
    pub fn condition(&self, name: &str, instance: &str) -> Option<&StateCondition> {
        let named = || self.conditions.iter().filter(|condition| condition.name == name);
        named().find(|condition| condition.context == instance).or_else(|| named().next())
    }
}

/// One of `required_objects`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ObjectRequest {
    /// Its instance id, such as `Bowl_01_1`.
    pub instance: String,
    /// The room it must be in, if said.
    pub room: Option<RoomId>,
    /// The instance it must be in or on, if said.
    pub inside: Option<String>,
    /// Flags it starts with, in the order of the file.
    pub flags: Vec<(StateFlag, bool)>,
    /// What it is filled with, if said.
    pub fluid: Option<Fluid>,
    /// Its colour, if said.
    pub color: Option<Color>,
    /// A sticky note's text.
    pub text: Option<String>,
    /// The circuit it belongs to, if said; `-1` is none.
    pub circuit: Option<i32>,
    /// The circuit it feeds, if said.
    pub generates_circuit: Option<i32>,
    /// Whether what the layout put in it is taken out first.
    pub remove_initial_contents: bool,
    /// Whether it starts with nothing in it.
    pub empty: bool,
    /// Whether no other object of its class may exist.
    pub unique: bool,
    /// Whether its class must not spawn by itself.
    pub blacklisted: bool,
    /// Whether it is taken out of the world.
    pub removed: bool,
    /// The class the time machine turns this carrot back into.
    pub yesterday: Option<String>,
    /// The class that a printer cartridge prints.
    pub prints: Option<String>,
}

/// A sticky note put at a place of a room.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoteRequest {
    /// Its instance id.
    pub instance: String,
    /// What it says.
    pub text: String,
    /// Its room.
    pub room: RoomId,
    /// The index of its place in the room.
    pub place: usize,
}

/// Something people are told during the mission.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Message {
    /// When.
    pub when: MessageTime,
    /// What.
    pub text: String,
}

/// When a message is shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum MessageTime {
    /// As the mission begins.
    Beginning,
    /// As this goal is met.
    GoalMet(i64),
    /// As the mission ends.
    Ending,
}

/// A mission that can be played, the file it was read from, and what is doubtful in it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checked {
    /// The mission.
    pub mission: Mission,
    /// The file as it was written, unknown fields included.
    pub raw: Cdf,
    /// What has no effect, or perhaps not the one meant.
    pub warnings: Vec<Problem>,
}

/// The project's own missions, as `(file name, text)`, in the order of their names.
#[must_use]
pub fn builtin() -> &'static [(&'static str, &'static str)] {
    builtin::MISSIONS
}

/// Reads the text of a mission file, and checks all of it against the catalogue and the layout it names.
///
/// `file` is only what the problems call it. Files are taken as generously as the original game takes them: what has no
/// meaning is a warning.
///
/// ```
/// let catalog = cohabit_cdf::Catalog::builtin();
/// let problems = cohabit_cdf::mission::read_mission("soup.json", r#"{"scene": 1}"#, &catalog).unwrap_err();
/// assert_eq!(problems.0[0].to_string(), "soup.json: /scene: expected an object, found a number");
/// ```
///
/// # Errors
/// All [`Problems`], warnings among them, if one of them is an error; a single one with line and column for what is no JSON.
pub fn read_mission(file: &str, text: &str, catalog: &Catalog) -> Result<Checked, Problems> {
    // Editors of another system put a byte order mark before the text.
    let value = serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(|error| syntax(file, &error))?;
    let mut reader = Reader::new(file, catalog);
    let raw = match Loose::<Cdf>::deserialize(&value) {
        Ok(Loose::As(raw)) => raw,
        _ => {
            reader.error(&Pointer::default(), format!("a mission is an object, not {}", reader::shape(&value)), None);
            return Err(Problems(reader.problems));
        }
    };
    match reader.mission(&raw) {
        Some(mission) if reader.problems.iter().all(|problem| problem.severity == Severity::Warning) => {
            Ok(Checked { mission, raw, warnings: reader.problems })
        }
        _ => Err(Problems(reader.problems)),
    }
}

fn syntax(file: &str, error: &serde_json::Error) -> Problems {
    let text = error.to_string();
    let message = text.split(" at line ").next().unwrap_or_default();
    Problems(vec![Problem {
        severity: Severity::Error,
        file: file.to_owned(),
        position: Some((error.line(), error.column())),
        pointer: Pointer::default(),
        message: format!("no JSON: {message}"),
        remedy: None,
    }])
}

impl Reader<'_> {
    /// The mission; none and a problem if there is no scene.
    fn mission(&mut self, raw: &Cdf) -> Option<Mission> {
        let root = Pointer::default();
        self.extras(&root, raw);
        let at = root.key("scene");
        let scene = self.field(&at, &raw.scene, "an object");
        if scene.is_none() && raw.scene.misfit().is_none() {
            self.error(&at, "the mission has no scene", None);
        }
        let scene = scene?;
        let parts = self.scene(&at, scene);
        let objects = self.objects(&at.key("required_objects"), &scene.required_objects);
        let notes = self.notes(&at.key("sticky_notes"), &scene.sticky_notes);
        let conditions = self.conditions(&root.key("stateconditions"), &raw.stateconditions);
        let named = Named { conditions: &conditions, notes: &notes };
        let goals = self.goals(&root.key("task_goals"), &raw.task_goals, &named);
        let messages = self.messages(&root.key("game_interactions"), &raw.game_interactions, &goals);
        let line = |field: &Loose<String>| field.known().map(|text| text.trim().to_owned()).unwrap_or_default();
        Some(Mission {
            name: parts.name,
            goal_text: line(&raw.goal_text),
            description: line(&raw.task_description),
            layout: parts.layout,
            seed: parts.seed,
            start_room: parts.start_room,
            objects,
            notes,
            goals,
            conditions,
            messages,
        })
    }
}

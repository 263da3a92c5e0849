//! A mission, checked: what a world is built from, and how it is read from a CDF file.

mod audit;
mod camera;
mod expression;
mod goal_kind;
mod goals;
mod key;
pub mod limits;
mod messages;
mod names;
mod objects;
mod occasion;
mod portal;
mod position;
mod possible;
pub mod problem;
pub mod raw;
mod reader;
mod request;
mod robot;
mod scene;
pub mod schema;
mod source;

use std::cell::OnceCell;

use serde::{Deserialize as _, Serialize};

pub use self::{
    camera::{CameraMovement, CameraView},
    goal_kind::{GoalForm, GoalKind, goal_kinds},
    messages::{Message, MessageTime},
    portal::{Era, Portal},
    problem::{Pointer, Problem, Problems, Severity},
    raw::Cdf,
    request::{DinoFood, NoteRequest, ObjectRequest},
    robot::RobotRequest,
    source::{Source, sources},
};
use self::{goals::Named, raw::Loose, reader::Reader};
use crate::{
    builtin,
    catalog::Catalog,
    goal::{Goal, StateCondition},
    room::RoomId,
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
    /// Where the camera turns, and when.
    pub camera_movements: Vec<CameraMovement>,
    /// The portals to the past and to the future, those to the past first.
    pub portals: Vec<Portal>,
    /// How the robots start, in the order of the file; usually nothing is said.
    pub robots: Vec<RobotRequest>,
    /// Layouts in which it must not be played.
    pub blacklisted_layouts: Vec<String>,
    /// Whether the looks of things are left to chance.
    pub random_looks: bool,
    /// The number of the game it belongs to, if said.
    pub game_id: Option<String>,
    /// Whether it is marked as an experiment.
    pub experimental: bool,
}

/// An empty mission in the first layout.
impl Default for Mission {
    fn default() -> Self {
        Self {
            name: String::new(),
            goal_text: String::new(),
            description: String::new(),
            layout: scene::DEFAULT_LAYOUT.to_owned(),
            seed: None,
            start_room: scene::DEFAULT_ROOM,
            objects: Vec::new(),
            notes: Vec::new(),
            goals: Vec::new(),
            conditions: Vec::new(),
            messages: Vec::new(),
            camera_movements: Vec::new(),
            portals: Vec::new(),
            robots: Vec::new(),
            blacklisted_layouts: Vec::new(),
            random_looks: false,
            game_id: None,
            experimental: false,
        }
    }
}

impl Mission {
    /// The condition that a goal means which names it for `instance`: the one of that context, else the first of that name.
    #[must_use]
    pub fn condition(&self, name: &str, instance: &str) -> Option<&StateCondition> {
        let named = || self.conditions.iter().filter(|condition| condition.name == name);
        named().find(|condition| condition.context == instance).or_else(|| named().next())
    }

    /// What people read of a goal: its description, or else what the mission asks for; nothing, if that is only the mission's
    /// name, as of generated ones.
    #[must_use]
    pub fn words_of<'m>(&'m self, goal: &'m Goal) -> &'m str {
        let asked = if self.goal_text == self.name { "" } else { self.goal_text.as_str() };
        if goal.description.is_empty() { asked } else { &goal.description }
    }
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
/// assert_eq!(problems.0[0].to_string(), "soup.json:1:2: /scene: expected an object, found a number");
/// ```
///
/// # Errors
/// All [`Problems`], warnings among them, if one of them is an error; a single one for what is no JSON, and for what is larger
/// than a mission may be ([`limits`]).
pub fn read_mission(file: &str, text: &str, catalog: &Catalog) -> Result<Checked, Problems> {
    let kept = OnceCell::new();
    // Editors of another system put a byte order mark before the text.
    let text = text.trim_start_matches('\u{feff}');
    if let Some(limits::Exceeded { at, message, remedy }) = limits::exceeded(text) {
        let mut reader = Reader::new(file, catalog, &kept);
        reader.error(&at, message, Some(remedy));
        if at.is_root() {
            // It is not looked through for a line.
            reader.problems.iter_mut().for_each(|problem| problem.position = Some((1, 1)));
        } else {
            position::locate(text, &mut reader.problems, file);
        }
        return Err(Problems(reader.problems));
    }
    let value = serde_json::from_str(text).map_err(|error| syntax(file, text, &error))?;
    let mut reader = Reader::new(file, catalog, &kept);
    let read = match Loose::<Cdf>::deserialize(&value) {
        Ok(Loose::As(raw)) => reader.mission(&raw).map(|mission| (mission, raw)),
        _ => {
            reader.error(&Pointer::default(), format!("a mission is an object, not {}", reader::shape(&value)), None);
            None
        }
    };
    let mut problems = reader.problems;
    position::locate(text, &mut problems, file);
    match read {
        Some((mission, raw)) if problems.iter().all(|problem| problem.severity == Severity::Warning) => {
            Ok(Checked { mission, raw, warnings: problems })
        }
        _ => Err(Problems(problems)),
    }
}

fn syntax(file: &str, text: &str, error: &serde_json::Error) -> Problems {
    let said = error.to_string();
    let message = said.split(" at line ").next().unwrap_or_default();
    Problems(vec![Problem {
        severity: Severity::Error,
        file: file.to_owned(),
        position: Some(position::Lines::of(text).position_of_byte(error.line(), error.column())),
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
        let portals = self.portals(&root, raw);
        let mut objects = self.objects(&at.key("required_objects"), &scene.required_objects, &portals);
        let notes = self.notes(&at.key("sticky_notes"), &scene.sticky_notes);
        let robots = self.robots(&at.key("simbot_init"), &scene.simbot_init);
        let conditions = self.conditions(&root.key("stateconditions"), &raw.stateconditions);
        let named = Named { conditions: &conditions, notes: &notes };
        self.object_conditions(&mut objects, &named);
        let goals = self.goals(&root.key("task_goals"), &raw.task_goals, &named);
        let (messages, camera_movements) =
            self.interactions(&root.key("game_interactions"), &raw.game_interactions, &goals, &named);
        let line = |field: &Loose<String>| field.known().map(|text| text.trim().to_owned()).unwrap_or_default();
        let mission = Mission {
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
            camera_movements,
            portals,
            robots,
            blacklisted_layouts: parts.blacklisted_layouts,
            random_looks: parts.random_looks,
            game_id: self.text(&root.key("game_id"), &raw.game_id),
            experimental: self.truth(&root.key("experimental"), &raw.experimental, false),
        };
        self.audit(&mission);
        Some(mission)
    }
}

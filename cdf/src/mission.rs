//! A mission, checked: what a world is built from.

use serde::Serialize;

use crate::{
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

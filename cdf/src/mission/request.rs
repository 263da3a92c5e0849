//! What a mission asks to be there: objects and notes.

use serde::{Deserialize, Serialize};

use crate::{
    goal::Occasion,
    room::RoomId,
    state::{Color, Fluid, StateFlag},
};

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
    /// Whether it feeds its circuit from the start, if said.
    pub generates_power: Option<bool>,
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
    /// What must hold for it to be there; it always is, if absent.
    pub condition: Option<Occasion>,
    /// Names of the portals to the past that lead to it.
    pub past_portals: Vec<String>,
    /// Names of the portals to the future that lead to it.
    pub future_portals: Vec<String>,
    /// The portal behind which it starts, if it does.
    pub current_portal: Option<String>,
    /// What it eats, if it is a dinosaur.
    pub dino_food: Option<DinoFood>,
}

/// What a dinosaur eats.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub enum DinoFood {
    /// Any object of this class.
    Class(String),
    /// This instance alone.
    Instance(String),
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

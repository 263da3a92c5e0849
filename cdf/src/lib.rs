//! Mission files, the object catalogue, floor plans and the vocabulary that every other crate speaks.
//!
//! Text in, checked values out. This crate never knows the state of a world, time, or any I/O beyond text:
//! whoever reads a file hands its text over.
//!
//! Frames: the world is right-handed, `x` east, `y` north, `z` up, in metres. Yaw is counter-clockwise seen from
//! above, zero along `x`. An object's own frame has its origin at the centre of its footprint, on the surface it
//! stands on, and its front faces `+x`.

pub mod action;
pub mod body;
pub mod catalog;
mod flag_key;
pub mod goal;
pub mod layout;
pub mod mission;
pub mod model;
mod nearest;
pub mod room;
pub mod semantic;
pub mod state;
pub mod symbolic;
pub mod world_pack;

/// The project's own data files, as `(file name, text)`.
mod builtin {
    include!(concat!(env!("OUT_DIR"), "/data.rs"));
}

pub use action::{Action, BodyId, GoToTarget, ObjectId, Status, Verb};
pub use body::{BodyKind, BodyRequest};
pub use catalog::{
    Catalog, CatalogError, ClassId, ClassNames, ObjectClass, PackId, Property,
    table::{self, ActionKind, ActionTable},
};
pub use goal::{Expression, Goal, GoalState, InstancePattern, Occasion, Predicate, Relation, StateCondition};
pub use layout::{Layout, LayoutError};
pub use mission::{Mission, ObjectRequest};
pub use model::Model;
pub use nearest::suggestion;
pub use room::{RoomEntry, RoomId, Rooms};
pub use semantic::SemanticClass;
pub use state::{Color, Fluid, StateFlag, StateFlags};
pub use world_pack::{PackEntry, PackError, PackErrors, PackFile, WorldData, WorldPack};

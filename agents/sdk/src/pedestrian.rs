//! Simulated pedestrians: people who walk about by the social force model, to places that a schedule names.
//!
//! A [`Crowd`] is one peer for all of them. They know the floor as it was when they joined, and see all bodies. Forces and
//! schedules are pure; what a pedestrian decides is an action of its body, as anybody may send it.

mod crowd;
mod forces;
mod person;
mod schedule;

use cohabit_cdf::RoomId;
use glam::Vec2;

pub use crowd::Crowd;
pub use schedule::{Schedule, ScheduleError};

/// The floor that pedestrians walk on.
pub struct Floor {
    /// The corners of walls and of all that stands in the way, m: convex, counter-clockwise.
    pub obstacles: Vec<[Vec2; 4]>,
    /// Places to stand: room, number from 1, and the point, m.
    pub viewpoints: Vec<(RoomId, u8, Vec2)>,
    /// Doors between rooms, by instance id, and where they are, m.
    pub doors: Vec<(String, Vec2)>,
    /// The way between two points, m, without the first; `None` if there is none.
    pub path: Paths,
}

/// Finds ways over a floor.
pub type Paths = Box<dyn Fn(Vec2, Vec2) -> Option<Vec<Vec2>> + Send>;

//! What goes into a tick and what comes out of it.

pub use cohabit_cdf::catalog::table::SoundKind;
use cohabit_cdf::{Action, BodyId, ObjectId, RoomId, Status};
use serde::{Deserialize, Serialize};

/// One command for one body.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Input {
    /// The command's id, unique in a session.
    pub command: u64,
    /// Who is told.
    pub body: BodyId,
    /// What to do.
    pub action: Action,
}

/// What came of one command.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Outcome {
    /// The command's id.
    pub command: u64,
    /// Who was told.
    pub body: BodyId,
    /// What came of it.
    pub status: Status,
    /// One short sentence for people, such as `the fridge is closed`.
    pub detail: String,
}

/// All that one tick had to tell.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Report {
    /// Commands that ended in this tick.
    pub outcomes: Vec<Outcome>,
    /// What else happened, in order.
    pub events: Vec<Event>,
}

/// How a mission ended.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub enum Ending {
    /// Every goal was met.
    AllGoalsMet,
    /// A hazard took the robot.
    KilledByHazard,
}

/// What the camera that people watch turns to.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub enum CameraTarget {
    /// An object.
    Object(ObjectId),
    /// A room.
    Room(RoomId),
    /// What is seen from a viewpoint: its room, and its number from 1.
    Viewpoint(RoomId, u8),
    /// A point, m in the world.
    Point([f32; 3]),
}

/// Something that happened.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Event {
    /// A state or the place of an object changed.
    ObjectChanged {
        /// Which.
        object: ObjectId,
    },
    /// An object came into being.
    Spawned {
        /// Which.
        object: ObjectId,
        /// The machine it came from, if one made it.
        by: Option<ObjectId>,
    },
    /// An object left the world.
    Removed {
        /// Which.
        object: ObjectId,
    },
    /// A goal was met.
    GoalMet {
        /// Its number in the mission.
        id: i64,
    },
    /// A goal that can reset no longer holds.
    GoalReset {
        /// Its number in the mission.
        id: i64,
    },
    /// A hidden goal was unlocked.
    GoalShown {
        /// Its number in the mission.
        id: i64,
    },
    /// The mission ended.
    MissionEnded {
        /// How.
        ending: Ending,
    },
    /// The mission says something.
    Message {
        /// What.
        text: String,
    },
    /// The mission shows something to the people who watch.
    CameraMovement {
        /// What.
        target: CameraTarget,
        /// How long, s.
        duration_s: f32,
        /// What is written below it; empty for nothing.
        text: String,
    },
    /// A body points an object out.
    Highlighted {
        /// Who.
        body: BodyId,
        /// What.
        object: ObjectId,
    },
    /// A body read something.
    NoteRead {
        /// What.
        object: ObjectId,
        /// What it says.
        text: String,
    },
    /// A body scanned something.
    Scanned {
        /// What.
        object: ObjectId,
    },
    /// Something can be heard.
    Sound {
        /// What kind.
        kind: SoundKind,
        /// Where from.
        object: ObjectId,
    },
}

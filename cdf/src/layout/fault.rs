//! What can be wrong with a floor plan, in words, and what would be right.

use std::fmt;

use super::{OpeningKind, RoomId};
use crate::nearest::suggestion;

/// Viewpoints a room has.
pub(super) const VIEWPOINTS: u8 = 8;
/// Places for sticky notes a room has at least.
pub(super) const NOTE_PLACES: usize = 4;

/// Something wrong with a floor plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutFault {
    /// No class fits the instance id.
    #[error("`{instance}` is of no class in the catalogue")]
    UnknownClass {
        /// The instance.
        instance: String,
        /// What it may have been meant to be.
        near: Option<String>,
    },
    /// Something is in a room that the plan does not have.
    #[error("{what} is of {}, and the plan has no such room", .room.id())]
    NoRoom {
        /// What names the room.
        what: String,
        /// The room.
        room: RoomId,
    },
    /// A room cannot be walked to.
    #[error("{} cannot be reached: {why}", .room.id())]
    OutOfReach {
        /// The room.
        room: RoomId,
        /// Why.
        why: NoWay,
    },
    /// Two placements share an id.
    #[error("`{instance}` is placed twice")]
    Repeated {
        /// The instance.
        instance: String,
    },
    /// An object reaches into a wall or out of its room.
    #[error("`{instance}` leaves {}", .room.id())]
    OutsideRoom {
        /// The instance.
        instance: String,
        /// Its room.
        room: RoomId,
    },
    /// Two objects fill the same space.
    #[error("`{instance}` overlaps `{other}`")]
    Overlap {
        /// One.
        instance: String,
        /// The other.
        other: String,
    },
    /// A gap is not in a wall that its two rooms share, or a window not in an outside wall of its one room.
    #[error("the {kind:?} at {at_m:?} is in no wall between {} and {}", .between[0].id(), .between[1].id())]
    OpeningOffWall {
        /// The gap's kind.
        kind: OpeningKind,
        /// Its middle.
        at_m: [f32; 2],
        /// Its rooms.
        between: [RoomId; 2],
    },
    /// An object stands in the way before a door or passage, or hangs in a window.
    #[error("`{instance}` blocks the {kind:?} at {at_m:?}")]
    BlocksOpening {
        /// The instance.
        instance: String,
        /// The gap's kind.
        kind: OpeningKind,
        /// Its middle.
        at_m: [f32; 2],
    },
    /// An object that does something cannot be walked up to.
    #[error("no walkway leads to `{instance}`")]
    Unreachable {
        /// The instance.
        instance: String,
    },
    /// What stands on a receptacle leaves less than half of its anchors.
    #[error("`{instance}` has {taken} of its {anchors} anchors taken")]
    Crowded {
        /// The receptacle.
        instance: String,
        /// Anchors covered or used.
        taken: usize,
        /// Anchors it has.
        anchors: usize,
    },
    /// An object's `works` or `on` names nothing in its room.
    #[error("`{instance}` names `{other}`, which is not in its room")]
    LooseLink {
        /// The instance.
        instance: String,
        /// What it names.
        other: String,
        /// What in the plan it may have been meant to name.
        near: Option<String>,
    },
    /// A room has not all of its viewpoints.
    #[error("{} has no viewpoint {}", .room.id(), listed(.numbers))]
    NoViewpoint {
        /// The room.
        room: RoomId,
        /// The numbers that are missing.
        numbers: Vec<u8>,
        /// Where one could be, if there is room, m.
        free_m: Option<[f32; 2]>,
    },
    /// Nobody can stand at a viewpoint.
    #[error("viewpoint {number} of {}, at {at_m:?}, {why}", .room.id())]
    Viewpoint {
        /// The room.
        room: RoomId,
        /// Its number.
        number: u8,
        /// Where it is.
        at_m: [f32; 2],
        /// Why nobody can.
        why: NoStand,
    },
    /// A room has too few places for notes.
    #[error("{} has {count} places for notes, and needs {NOTE_PLACES}", .room.id())]
    NotePlaces {
        /// The room.
        room: RoomId,
        /// How many it has.
        count: usize,
    },
    /// A place for notes is not on a wall of its room.
    #[error("the place for notes at {at_m:?} is on no wall of {}", .room.id())]
    NoteOffWall {
        /// The room.
        room: RoomId,
        /// Where it is.
        at_m: [f32; 3],
    },
}

/// Why a room cannot be walked to.
#[derive(Clone, Debug, PartialEq)]
pub enum NoWay {
    /// It has neither a door nor a passage.
    NoDoor {
        /// An entry of `opening` that would lead into it, if it shares a wall with another room.
        entry: Option<String>,
    },
    /// Its doors and passages lead to rooms that cannot be reached either.
    Elsewhere {
        /// Those rooms.
        rooms: Vec<RoomId>,
        /// An entry of `opening` that would lead into it from a room that can be reached, if it shares a wall with one.
        entry: Option<String>,
    },
    /// What stands in the way leaves no room for a robot.
    Blocked,
}

/// Why nobody can stand at a point.
#[derive(Clone, Debug, PartialEq)]
pub enum NoStand {
    /// It is not in its room.
    OutsideRoom,
    /// It is too near to a wall.
    NearWall,
    /// It is in or too near to that instance.
    Near(String),
    /// What stands around it leaves no way to it.
    NoWay,
}

impl fmt::Display for NoWay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoDoor { .. } => f.write_str("no door or passage leads into it"),
            Self::Elsewhere { rooms, .. } => {
                let rooms: Vec<&str> = rooms.iter().map(|room| room.id()).collect();
                write!(f, "its doors and passages lead to {} alone, which cannot be reached either", rooms.join(", "))
            }
            Self::Blocked => f.write_str("what stands behind its doors and passages leaves no way into it"),
        }
    }
}

impl fmt::Display for NoStand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideRoom => f.write_str("is not in that room"),
            Self::NearWall => f.write_str("is too near to a wall"),
            Self::Near(instance) => write!(f, "is in or too near to `{instance}`"),
            Self::NoWay => f.write_str("cannot be walked to: what stands around it leaves no way"),
        }
    }
}

impl LayoutFault {
    /// What rids a floor plan of it.
    #[must_use]
    pub fn remedy(&self) -> String {
        let meant = |near: &Option<String>| near.as_deref().map(suggestion);
        let text = match self {
            Self::UnknownClass { near, .. } => {
                let rule = "begin the instance with a class, and end it with `_` and a number";
                return meant(near).unwrap_or_else(|| format!("{rule}; `cohabit catalog classes` lists the classes"));
            }
            Self::LooseLink { near, .. } => {
                return meant(near).unwrap_or_else(|| "name what is placed in the same room".to_owned());
            }
            Self::NoRoom { .. } => "name a room of the plan, or add it as a `room`",
            Self::OutOfReach { room, why: NoWay::NoDoor { entry } | NoWay::Elsewhere { entry, .. } } => {
                return entry.as_ref().map_or_else(
                    || format!("give {} a wall in common with a room that can be reached, and a door in it", room.id()),
                    |entry| format!("add to `opening`: {entry}"),
                );
            }
            Self::OutOfReach { why: NoWay::Blocked, .. } => "leave 0.5 m free from a door or passage into the room",
            Self::Repeated { .. } => "give one of them another number",
            Self::OutsideRoom { .. } => "move it 0.06 m or more away from the middle of the walls",
            Self::Overlap { .. } => "move one of them",
            Self::OpeningOffWall { .. } => "put it on a straight wall that both rooms share",
            Self::BlocksOpening { .. } => "keep 0.9 m before doors and passages free, and windows clear",
            Self::Unreachable { .. } => "leave a walkway of 0.8 m that leads to it",
            Self::Crowded { .. } => "leave half of its places free for missions",
            Self::NoViewpoint { room, numbers, free_m } => return viewpoint_entry(*room, numbers, *free_m),
            Self::Viewpoint { why: NoStand::OutsideRoom, .. } => "move it into the room, or name the room where it is",
            Self::Viewpoint { why: NoStand::NearWall, .. } => "move it 0.31 m or more from the middle of the walls",
            Self::Viewpoint { why: NoStand::Near(_), .. } => "move one of them: a robot needs 0.25 m to each side",
            Self::Viewpoint { why: NoStand::NoWay, .. } => "leave a way of 0.5 m that leads to it, or move it",
            Self::NotePlaces { room, .. } => {
                let id = room.id();
                return format!(
                    "add to `note_place`: {{ room = \"{id}\", at_m = [x, y, 1.4], yaw_deg = 0.0 }}, 0.07 m from the middle \
                     of a wall, which faces the room"
                );
            }
            Self::NoteOffWall { .. } => "move it to 0.07 m from the middle of a wall of its room",
        };
        text.to_owned()
    }
}

/// What to write for viewpoints that are missing.
fn viewpoint_entry(room: RoomId, numbers: &[u8], free_m: Option<[f32; 2]>) -> String {
    let first = numbers.first().copied().unwrap_or(1);
    let (at, note) = free_m.map_or_else(
        || ("x, y".to_owned(), ", where a robot has 0.31 m to each wall and 0.25 m to all that stands there"),
        |[x, y]| (format!("{x:.2}, {y:.2}"), ""),
    );
    format!(
        "each room has viewpoints 1 to {VIEWPOINTS}; add to `viewpoint`: {{ room = \"{}\", number = {first}, \
         at_m = [{at}], yaw_deg = 0.0 }}{note}",
        room.id()
    )
}

/// `3, 5`.
fn listed(numbers: &[u8]) -> String {
    numbers.iter().map(u8::to_string).collect::<Vec<_>>().join(", ")
}

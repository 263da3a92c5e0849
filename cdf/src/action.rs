//! What a body can be told to do, and what may come of it: the closed vocabulary of commands and outcomes.

use serde::{Deserialize, Serialize};

use crate::room::RoomId;

/// The index of an object in its world: dense, stable for a session, never reused.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
pub struct ObjectId(pub u32);

/// The index of a body (a robot or a human avatar) in its world.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(transparent)]
pub struct BodyId(pub u32);

/// One thing a body can be told to do.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub enum Action {
    /// Move along its heading by so many metres; negative is backwards.
    Move {
        /// Signed distance, m.
        distance_m: f32,
    },
    /// Turn by this yaw; positive is to the left.
    Rotate {
        /// Signed angle, rad.
        yaw_rad: f32,
    },
    /// Pitch the head by this; positive is up.
    Look {
        /// Signed angle, rad.
        pitch_rad: f32,
    },
    /// Turn once around, looking.
    LookAround,
    /// Walk to a place.
    GoTo {
        /// Where to.
        target: GoToTarget,
    },
    /// Take an object into the empty hand.
    PickUp {
        /// Which.
        object: ObjectId,
    },
    /// Put what is held onto or into a receptacle.
    Place {
        /// Which receptacle.
        receptacle: ObjectId,
    },
    /// Act on an object with the hand or with what it holds.
    Interact {
        /// What to do.
        verb: Verb,
        /// To what.
        object: ObjectId,
    },
    /// Outline an object for the people who watch.
    Highlight {
        /// Which.
        object: ObjectId,
    },
    /// Let go of whatever it is doing, now.
    Stop,
    /// Keep moving as a person at the controls asks, for half a simulated second unless told again; what is asked beyond
    /// what the body can do is cut down to that. It slides along what it runs into.
    Drive {
        /// Signed speed along its heading, m/s; negative is backwards.
        forward_m_s: f32,
        /// Signed turning speed, rad/s; positive is to the left.
        turn_rad_s: f32,
        /// Signed speed of the head's pitch, rad/s; positive is up.
        pitch_rad_s: f32,
    },
    /// Put what is held onto or into a receptacle, at the free place that is nearest to something. Where none is near, it is put
    /// all the same, and the outcome says so. The last of all, so that the others keep their numbers in snapshots and digests.
    PlaceBeside {
        /// Which receptacle.
        receptacle: ObjectId,
        /// Beside what.
        beside: ObjectId,
    },
}

impl Action {
    /// Putting what is held onto or into a receptacle, beside something if that was said.
    #[must_use]
    pub const fn place(receptacle: ObjectId, beside: Option<ObjectId>) -> Self {
        match beside {
            Some(beside) => Self::PlaceBeside { receptacle, beside },
            None => Self::Place { receptacle },
        }
    }

    /// What it puts the thing in the hand onto or into, if it does.
    #[must_use]
    pub const fn receptacle(&self) -> Option<ObjectId> {
        match *self {
            Self::Place { receptacle } | Self::PlaceBeside { receptacle, .. } => Some(receptacle),
            _ => None,
        }
    }

    /// What it puts the thing in the hand beside, if that was said.
    #[must_use]
    pub const fn beside(&self) -> Option<ObjectId> {
        match *self {
            Self::PlaceBeside { beside, .. } => Some(beside),
            _ => None,
        }
    }

    /// The same, beside nothing in particular.
    #[must_use]
    pub const fn beside_nothing(self) -> Self {
        match self {
            Self::PlaceBeside { receptacle, .. } => Self::Place { receptacle },
            other => other,
        }
    }
}

/// Where a body can be told to walk.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub enum GoToTarget {
    /// Near an object, facing it, within reach.
    Object(ObjectId),
    /// Into a room.
    Room(RoomId),
    /// To a named viewpoint: room, and number from 1.
    Viewpoint(RoomId, u8),
    /// To a point on the floor, m.
    Point([f32; 2]),
}

/// What can be done to an object, beyond picking up and placing.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[repr(u8)]
pub enum Verb {
    /// Open a door, lid or drawer.
    Open,
    /// Close it.
    Close,
    /// Break it, with the hammer in hand.
    Break,
    /// Scan it.
    Scan,
    /// Pour what is held into it.
    Pour,
    /// Switch it: on, off, or press.
    Toggle,
    /// Throw what is held at it.
    Throw,
    /// Fill what is held at it.
    Fill,
    /// Clean what is held in it, or it where it stands.
    Clean,
    /// Look closely at it, read it.
    Examine,
}

impl Verb {
    /// All verbs.
    pub const ALL: [Self; 10] = [
        Self::Open,
        Self::Close,
        Self::Break,
        Self::Scan,
        Self::Pour,
        Self::Toggle,
        Self::Throw,
        Self::Fill,
        Self::Clean,
        Self::Examine,
    ];
}

/// What came of a command. Every command gets exactly one.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[repr(u8)]
pub enum Status {
    /// Done.
    ActionSuccessful,
    /// The object does not afford this.
    UnsupportedAction,
    /// There is no way there.
    UnsupportedNavigation,
    /// The hand is full.
    AlreadyHoldingObject,
    /// No free place left in the receptacle.
    ReceptacleIsFull,
    /// The receptacle is closed.
    ReceptacleIsClosed,
    /// Something is in the way.
    TargetInaccessible,
    /// A hazard ended the mission.
    KilledByHazard,
    /// Too far away.
    TargetOutOfRange,
    /// Arrived near, by another way or at another place than asked.
    AlternateNavigationUsed,
    /// It has no power.
    ObjectUnpowered,
    /// It is overloaded.
    ObjectOverloaded,
    /// The command makes no sense here.
    InvalidCommand,
    /// The hand is empty.
    ObjectNotPickedUp,
    /// There is no world to act in.
    ArenaUnavailable,
    /// The command is not well formed.
    IncorrectActionFormat,
    /// There is no such object.
    InvalidObjectClass,
    /// It could not be carried out.
    ActionExecutionError,
    /// It was carried out, but what follows failed.
    PostProcessError,
    /// It was stopped, or another command took its place.
    Interrupted,
}

impl Status {
    /// All statuses, in the order of their numbers.
    pub const ALL: [Self; 20] = [
        Self::ActionSuccessful,
        Self::UnsupportedAction,
        Self::UnsupportedNavigation,
        Self::AlreadyHoldingObject,
        Self::ReceptacleIsFull,
        Self::ReceptacleIsClosed,
        Self::TargetInaccessible,
        Self::KilledByHazard,
        Self::TargetOutOfRange,
        Self::AlternateNavigationUsed,
        Self::ObjectUnpowered,
        Self::ObjectOverloaded,
        Self::InvalidCommand,
        Self::ObjectNotPickedUp,
        Self::ArenaUnavailable,
        Self::IncorrectActionFormat,
        Self::InvalidObjectClass,
        Self::ActionExecutionError,
        Self::PostProcessError,
        Self::Interrupted,
    ];

    /// Whether the command did what was asked.
    #[must_use]
    pub const fn is_success(self) -> bool {
        matches!(self, Self::ActionSuccessful | Self::AlternateNavigationUsed)
    }

    /// Whether the command failed, rather than being overtaken by the next.
    #[must_use]
    pub const fn is_failure(self) -> bool {
        !self.is_success() && !matches!(self, Self::Interrupted)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_beside_nothing_is_written_as_before() {
        let put = Action::place(ObjectId(4), None);
        let written = r#"{"Place":{"receptacle":4}}"#;
        assert_eq!(serde_json::to_string(&put).unwrap(), written);
        assert_eq!(serde_json::from_str::<Action>(written).unwrap(), put);
        let beside = Action::place(ObjectId(4), Some(ObjectId(2)));
        assert_eq!(serde_json::from_str::<Action>(&serde_json::to_string(&beside).unwrap()).unwrap(), beside);
        assert_eq!((beside.receptacle(), beside.beside()), (put.receptacle(), Some(ObjectId(2))));
        assert_eq!(beside.beside_nothing(), put);
    }
}

//! What a rule wants changed: the closed list of all changes that commands and machines can make.

use cohabit_cdf::{BodyId, ClassId, Color, Fluid, ObjectId, StateFlag};
use glam::Vec3;

use crate::{
    report::{Event, SoundKind},
    run::Run,
};

/// Where something comes to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spot {
    /// An anchor of a receptacle.
    Anchor {
        /// Which receptacle.
        parent: ObjectId,
        /// Which of its anchors.
        anchor: u16,
    },
    /// The floor, m.
    Floor(Vec3),
}

/// One change.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Effect {
    /// A flag takes a value.
    Set(ObjectId, StateFlag, bool),
    /// An object is filled, or emptied.
    Fill(ObjectId, Fluid),
    /// An object takes a colour.
    Paint(ObjectId, Color),
    /// An object goes into a hand.
    Hold(ObjectId, BodyId),
    /// An object goes somewhere.
    Put {
        /// What.
        object: ObjectId,
        /// Where.
        spot: Spot,
    },
    /// An object is let go in mid-air, with this velocity, m/s.
    LetGo(ObjectId, Vec3),
    /// A new object comes into being.
    Spawn {
        /// Of which class.
        class: ClassId,
        /// The id it gets.
        instance: String,
        /// Where.
        spot: Spot,
        /// The machine that makes it, if one does.
        by: Option<ObjectId>,
        /// What it was before, and becomes again in the time machine.
        was: Option<ObjectId>,
    },
    /// An object that left the world comes back.
    Return {
        /// What.
        object: ObjectId,
        /// Where.
        spot: Spot,
    },
    /// An object leaves the world; what stands on it takes its place.
    Remove(ObjectId),
    /// An object becomes so many times its size.
    Scale(ObjectId, f32),
    /// A machine works for a moment.
    Start(ObjectId, Run),
    /// A circuit is fed, or cut.
    Feed(i32, bool),
    /// The portal of a generator leads elsewhere the next time.
    Turn(ObjectId),
    /// A dinosaur is fed.
    Sate(ObjectId),
    /// Somebody did something to an object.
    Touch(ObjectId),
    /// A body dies.
    Kill(BodyId),
    /// Somebody is told.
    Tell(Event),
}

impl Effect {
    /// A sound from `object`.
    pub fn sound(kind: SoundKind, object: ObjectId) -> Self {
        Self::Tell(Event::Sound { kind, object })
    }
}

//! What a rule wants changed: the closed list of all changes that commands and machines can make.

use cohabit_cdf::{BodyId, ClassId, Color, Fluid, ObjectId, StateFlag};
use glam::Vec3;

use crate::{
    report::{Event, SoundKind},
    works::Run,
};

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
    /// An object goes to an anchor of a receptacle.
    PutOn {
        /// What.
        object: ObjectId,
        /// Where.
        parent: ObjectId,
        /// At which anchor.
        anchor: u16,
    },
    /// An object is let go in mid-air, with this velocity, m/s.
    LetGo(ObjectId, Vec3),
    /// A new object comes to an anchor of a receptacle.
    Spawn {
        /// Of which class.
        class: ClassId,
        /// The id it gets.
        instance: String,
        /// Where.
        parent: ObjectId,
        /// At which anchor.
        anchor: u16,
        /// What the time machine will make of it.
        yesterday: Option<ClassId>,
        /// The machine that makes it, if one does.
        by: Option<ObjectId>,
    },
    /// An object leaves the world; what stands on it takes its place.
    Remove(ObjectId),
    /// An object becomes so many times its size.
    Scale(ObjectId, f32),
    /// A machine works for a moment.
    Start(ObjectId, Run),
    /// A circuit is fed, or cut.
    Feed(i32, bool),
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

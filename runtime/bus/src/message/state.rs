//! The present state of the world: a header, then lists of records.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::BodyKind;

use super::{Malformed, layout};
use crate::text::Text;

/// What stands before the lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct StateHeader {
    /// Bodies that follow.
    pub bodies: u32,
    /// Objects that follow.
    pub objects: u32,
    /// Goals that follow.
    pub goals: u32,
    /// Notes that follow.
    pub notes: u32,
    /// Points left or won.
    pub score: u32,
    /// 0 while the mission runs, 1 complete, 2 failed.
    pub ending: u32,
    /// Rooms whose lights are on: bit `i` for the room with index `i`.
    pub lit_rooms: u64,
    /// 1 while the world waits.
    pub paused: u32,
    /// Zero.
    pub reserved: u32,
}

/// A robot or a human avatar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BodyRecord {
    /// Its index.
    pub body: u32,
    /// Its room's index, or [`NONE`](super::NONE).
    pub room: u32,
    /// The object it holds, or [`NONE`](super::NONE).
    pub held: u32,
    /// 1 while it carries out a command.
    pub busy: u32,
    /// `BodyKind`.
    pub kind: u32,
    /// `StateFlags` bits that it shows, such as its mood.
    pub flags: u32,
    /// The command it carries out; 0 is none.
    pub command: u64,
    /// The run of who commands it; 0 is nobody.
    pub commander: u64,
    /// On the floor, m.
    pub position_m: [f32; 3],
    /// Heading, rad.
    pub yaw_rad: f32,
    /// Pitch of the head, rad.
    pub head_pitch_rad: f32,
    /// The egocentric camera, m.
    pub eye_m: [f32; 3],
}

impl BodyRecord {
    /// What kind of body it is; nothing, if a peer wrote one that does not exist.
    #[must_use]
    pub fn kind(&self) -> Option<BodyKind> {
        BodyKind::ALL.get(self.kind as usize).copied()
    }
}

/// An object.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ObjectRecord {
    /// Its index.
    pub object: u32,
    /// `StateFlags` bits.
    pub flags: u32,
    /// Its class's index in the catalogue.
    pub class: u16,
    /// Its room's index, or 255.
    pub room: u8,
    /// `Color`.
    pub color: u8,
    /// `Fluid`.
    pub fluid: u8,
    /// 1 if it cannot be seen: in something closed, or gone.
    pub hidden: u8,
    /// 1 if it is there for the mission's sake, or was made since.
    pub in_mission: u8,
    /// Zero.
    pub reserved: u8,
    /// What it stands on or in, or [`NONE`](super::NONE).
    pub parent: u32,
    /// The body that holds it, or [`NONE`](super::NONE).
    pub held_by: u32,
    /// The object that it works, or [`NONE`](super::NONE).
    pub works: u32,
    /// Its origin, m.
    pub position_m: [f32; 3],
    /// Its rotation, x, y, z, w.
    pub rotation: [f32; 4],
    /// Its instance id.
    pub instance: Text<62>,
}

/// A goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GoalRecord {
    /// Its number in the mission.
    pub number: i64,
    /// 1 once it is met.
    pub met: u32,
    /// 1 while people must not see it.
    pub hidden: u32,
    /// What people read.
    pub description: Text<238>,
}

/// What a sticky note says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct NoteRecord {
    /// The note.
    pub object: u32,
    /// 1 once it was read.
    pub read: u32,
    /// Its text.
    pub text: Text<502>,
}

/// The lists that make a state message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateParts {
    /// Counts are filled in when it is written.
    pub header: StateHeader,
    /// All bodies.
    pub bodies: Vec<BodyRecord>,
    /// All objects.
    pub objects: Vec<ObjectRecord>,
    /// All goals.
    pub goals: Vec<GoalRecord>,
    /// All notes.
    pub notes: Vec<NoteRecord>,
}

impl StateParts {
    /// Bytes of the payload.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        layout::space::<StateHeader>(1)
            + layout::space::<BodyRecord>(self.bodies.len())
            + layout::space::<ObjectRecord>(self.objects.len())
            + layout::space::<GoalRecord>(self.goals.len())
            + layout::space::<NoteRecord>(self.notes.len())
    }

    /// Writes the payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(&self, payload: &mut [u8]) {
        let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
        let header = StateHeader {
            bodies: count(self.bodies.len()),
            objects: count(self.objects.len()),
            goals: count(self.goals.len()),
            notes: count(self.notes.len()),
            ..self.header
        };
        let mut writer = layout::Writer::new(payload);
        writer.put(&[header]);
        writer.put(&self.bodies);
        writer.put(&self.objects);
        writer.put(&self.goals);
        writer.put(&self.notes);
    }
}

/// A state message as received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateView<'a> {
    /// What stands before the lists.
    pub header: &'a StateHeader,
    /// All bodies.
    pub bodies: &'a [BodyRecord],
    /// All objects.
    pub objects: &'a [ObjectRecord],
    /// All goals.
    pub goals: &'a [GoalRecord],
    /// All notes.
    pub notes: &'a [NoteRecord],
}

impl<'a> StateView<'a> {
    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &StateHeader = reader.one()?;
        Ok(Self {
            header,
            bodies: reader.take(header.bodies)?,
            objects: reader.take(header.objects)?,
            goals: reader.take(header.goals)?,
            notes: reader.take(header.notes)?,
        })
    }
}

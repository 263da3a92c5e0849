//! What went into a tick, and the digest of what came out.

use bytemuck::{Pod, Zeroable};

use super::{CommandMessage, Malformed, layout};

/// What stands before a tick's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TickHeader {
    /// The digest of the simulated state after the tick: 8 bytes for each of its parts, in order: objects, bodies,
    /// mission, physics.
    pub digest: [u8; 32],
    /// Inputs that follow.
    pub inputs: u32,
    /// Zero.
    pub reserved: u32,
    /// Wall time of the tick's start, ns since 1970: a stamp, never a key.
    pub wall_nanos: u64,
    /// How much later than it should it began, ns; 0 in lock-step.
    pub late_nanos: u64,
    /// How long each [`Stage`] took, ns of wall time; the stages from `Record` on are those of the tick before.
    pub stage_nanos: [u32; 10],
}

const _: () = assert!(Stage::ALL.len() == 10);

/// What a tick is made of, in order.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u32)]
pub enum Stage {
    /// In lock-step, agents are waited for.
    Wait = 0,
    /// Queues are emptied.
    Drain = 1,
    /// Commands are ruled, their effects applied.
    Rule = 2,
    /// Bodies go on with what they do.
    Move = 3,
    /// Machines work, doors and drawers move.
    Work = 4,
    /// What flies and slides does so.
    Physics = 5,
    /// Goals and score.
    Judge = 6,
    /// State and events are sent.
    Publish = 7,
    /// The digest is taken, the tick sent to recorders.
    Record = 8,
    /// The scene goes to those who render; in lock-step, frames for agents are rendered.
    Show = 9,
}

impl Stage {
    /// All stages.
    pub const ALL: [Self; 10] = [
        Self::Wait,
        Self::Drain,
        Self::Rule,
        Self::Move,
        Self::Work,
        Self::Physics,
        Self::Judge,
        Self::Publish,
        Self::Record,
        Self::Show,
    ];
}

/// A tick to send.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TickMessage {
    /// All but the inputs.
    pub header: TickHeader,
    /// The commands it took in, in order.
    pub inputs: Vec<CommandMessage>,
}

impl TickMessage {
    /// Bytes of the payload.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        layout::space::<TickHeader>(1) + layout::space::<CommandMessage>(self.inputs.len())
    }

    /// Writes the payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(&self, payload: &mut [u8]) {
        let mut writer = layout::Writer::new(payload);
        writer.put(&[TickHeader { inputs: u32::try_from(self.inputs.len()).unwrap_or(0), ..self.header }]);
        writer.put(&self.inputs);
    }
}

/// A tick as received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickView<'a> {
    /// All but the inputs.
    pub header: &'a TickHeader,
    /// The commands it took in, in order.
    pub inputs: &'a [CommandMessage],
}

impl<'a> TickView<'a> {
    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &TickHeader = reader.one()?;
        Ok(Self { header, inputs: reader.take(header.inputs)? })
    }
}

//! What went into a tick, and the digest of what came out.

use bytemuck::{Pod, Zeroable};

use super::{CommandMessage, Malformed, layout};

/// What stands before a tick's inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TickHeader {
    /// BLAKE3 of the whole simulated state after the tick.
    pub digest: [u8; 32],
    /// Inputs that follow.
    pub inputs: u32,
    /// Zero.
    pub reserved: u32,
    /// Wall time of the tick's start, ns since 1970: a stamp, never a key.
    pub wall_nanos: u64,
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

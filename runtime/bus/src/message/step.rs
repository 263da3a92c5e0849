//! In lock-step: whose turn it is.

use bytemuck::{Pod, Zeroable};

use super::{Malformed, layout};

/// What stands before the list of those whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct StepHeader {
    /// How many runs (`u64`) follow: those of the publishers of commands that the world waits for now.
    pub due: u32,
    /// Zero.
    pub reserved: u32,
}

/// The turn of some: all that a tick brought has been sent, and the world waits for what they do about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepView<'a> {
    /// Their runs.
    pub due: &'a [u64],
}

impl<'a> StepView<'a> {
    /// Bytes of the payload for so many.
    #[must_use]
    pub const fn bytes(due: usize) -> usize {
        layout::space::<StepHeader>(1) + layout::space::<u64>(due)
    }

    /// Writes a payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(due: &[u64], payload: &mut [u8]) {
        let mut writer = layout::Writer::new(payload);
        writer.put(&[StepHeader { due: u32::try_from(due.len()).unwrap_or(0), reserved: 0 }]);
        writer.put(due);
    }

    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &StepHeader = reader.one()?;
        Ok(Self { due: reader.take(header.due)? })
    }
}

//! The whole simulated state, for who is to go on from it.

use bytemuck::{Pod, Zeroable};

use super::{Malformed, layout};

/// What stands before a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SnapshotHeader {
    /// Length of the state, bytes: only a simulator of the same version can read it.
    pub bytes: u32,
    /// Zero.
    pub reserved: u32,
}

/// The state after the tick of its envelope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapshotView<'a> {
    /// The state as its simulator wrote it down.
    pub state: &'a [u8],
}

impl<'a> SnapshotView<'a> {
    /// Bytes of the payload for a state of so many.
    #[must_use]
    pub const fn bytes(state: usize) -> usize {
        layout::space::<SnapshotHeader>(1) + layout::space::<u8>(state)
    }

    /// Writes a payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(state: &[u8], payload: &mut [u8]) {
        let mut writer = layout::Writer::new(payload);
        writer.put(&[SnapshotHeader { bytes: u32::try_from(state.len()).unwrap_or(0), reserved: 0 }]);
        writer.put(state);
    }

    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &SnapshotHeader = reader.one()?;
        Ok(Self { state: reader.take(header.bytes)? })
    }
}

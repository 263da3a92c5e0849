//! Snapshots: the whole simulated state after a tick, packed.

use std::io::{self, Read as _, Write as _};

use flate2::{Compression, read::DeflateDecoder, write::DeflateEncoder};

/// No state is as large as that; what claims to be was not written by this program.
const LARGEST: u64 = 256 << 20;

/// A state of the world, as its simulator wrote it down.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Snapshot {
    /// After which tick.
    pub tick: u64,
    packed: Vec<u8>,
}

impl Snapshot {
    /// Packs a state.
    #[must_use]
    pub fn pack(tick: u64, state: &[u8]) -> Self {
        let mut encoder = DeflateEncoder::new(Vec::with_capacity(state.len() / 2), Compression::default());
        encoder.write_all(state).expect("invariant: memory takes what is written to it");
        Self { tick, packed: encoder.finish().expect("invariant: memory takes what is written to it") }
    }

    /// The state, as it was packed.
    ///
    /// # Errors
    /// When the bytes are not what [`Self::pack`] made.
    pub fn unpack(&self) -> io::Result<Vec<u8>> {
        let mut state = Vec::with_capacity(4 * self.packed.len());
        DeflateDecoder::new(&*self.packed).take(LARGEST).read_to_end(&mut state)?;
        Ok(state)
    }

    /// As a log holds it: the tick, 8 bytes little-endian, then the state as a deflate stream.
    pub(crate) fn message(&self) -> Vec<u8> {
        [&self.tick.to_le_bytes(), &*self.packed].concat()
    }

    /// From what [`Self::message`] made.
    pub(crate) fn read(message: &[u8]) -> Option<Self> {
        let (tick, packed) = message.split_at_checked(8)?;
        Some(Self { tick: u64::from_le_bytes(tick.try_into().ok()?), packed: packed.to_vec() })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_state_is_unpacked_as_it_was_packed() {
        let state: Vec<u8> = (0..40_000_u32).flat_map(|word| (word / 7).to_le_bytes()).collect();
        let snapshot = Snapshot::pack(600, &state);
        let message = snapshot.message();
        assert!(message.len() < state.len() / 2);
        let read = Snapshot::read(&message).unwrap();
        assert_eq!((read.tick, read.unpack().unwrap()), (600, state));
        assert_eq!(Snapshot::read(&message[..5]), None);
        assert!(Snapshot::read(&message[..message.len() - 3]).unwrap().unpack().is_err());
    }
}

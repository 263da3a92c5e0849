//! Snapshots: all simulated state as bytes, and back, so that a world goes on bit for bit.

use crate::state::State;

/// What a snapshot begins with; the number rises with every change of the encoding.
const MAGIC: &[u8; 8] = b"cohabW02";
const DIGEST_BYTES: usize = 32;

/// Why a snapshot could not be taken up.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum SnapshotError {
    /// The bytes do not begin as a snapshot does.
    #[error("restore a world: these {bytes} bytes are no snapshot of this version")]
    NotASnapshot {
        /// How many there are.
        bytes: usize,
    },
    /// It was taken of a world with another catalogue, floor plan or mission.
    #[error("restore a world: the snapshot is of another mission, floor plan or catalogue than `{mission}`")]
    OtherWorld {
        /// The mission of this world.
        mission: String,
    },
    /// The bytes were changed or cut off since.
    #[error("restore a world: the snapshot is damaged")]
    Damaged,
}

/// Encodes `state` of the world that `identity` stands for.
pub(crate) fn write(identity: &[u8; DIGEST_BYTES], state: &State) -> Vec<u8> {
    let start = [MAGIC.as_slice(), identity].concat();
    let mut bytes = postcard::to_extend(state, start).expect("invariant: plain data of known lengths encodes");
    let check = blake3::hash(&bytes);
    bytes.extend_from_slice(check.as_bytes());
    bytes
}

/// Decodes what [`write`] made.
pub(crate) fn read(identity: &[u8; DIGEST_BYTES], mission: &str, bytes: &[u8]) -> Result<State, SnapshotError> {
    let no_snapshot = SnapshotError::NotASnapshot { bytes: bytes.len() };
    let Some(rest) = bytes.strip_prefix(MAGIC) else { return Err(no_snapshot) };
    let Some((found, rest)) = rest.split_at_checked(DIGEST_BYTES) else { return Err(no_snapshot) };
    let Some((state, check)) = rest.len().checked_sub(DIGEST_BYTES).map(|at| rest.split_at(at)) else {
        return Err(no_snapshot);
    };
    if blake3::hash(&bytes[..bytes.len() - DIGEST_BYTES]).as_bytes() != check {
        return Err(SnapshotError::Damaged);
    }
    if found != identity {
        return Err(SnapshotError::OtherWorld { mission: mission.to_owned() });
    }
    postcard::from_bytes(state).map_err(|_| SnapshotError::Damaged)
}

//! The state of a world with what is seen of it besides, as bytes, and back.

use cohabit_world::{SnapshotError, World};

use crate::appearance::{Appearance, Visible};

/// Why a state cannot be taken up.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// The world cannot.
    #[error(transparent)]
    World(#[from] SnapshotError),
    /// The log's bytes cannot be unpacked.
    #[error("restore a world: the snapshot is damaged")]
    Damaged,
    /// What is seen besides cannot.
    #[error("restore what is seen of a world: the bytes are not of this version")]
    Appearance,
}

/// All of a world that is needed to go on from it.
///
/// # Panics
/// Never: a world is plain data, of less than 4 GiB.
#[must_use]
pub fn write(visible: Visible<'_>) -> Vec<u8> {
    let state = visible.world.snapshot();
    let length = u32::try_from(state.len()).expect("invariant: a world takes less than 4 GiB");
    let start = [length.to_le_bytes().as_slice(), &state].concat();
    postcard::to_extend(visible.appearance, start).expect("invariant: plain data of known lengths encodes")
}

/// Has `world`, which must be of the same mission, go on from there; gives what is seen besides.
///
/// # Errors
/// [`RestoreError`]; the world is then as it was.
pub fn restore(world: &mut World, bytes: &[u8]) -> Result<Appearance, RestoreError> {
    let parts = || {
        let (length, rest) = bytes.split_first_chunk()?;
        rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
    };
    let (state, appearance) = parts().ok_or(SnapshotError::NotASnapshot { bytes: bytes.len() })?;
    let appearance = postcard::from_bytes(appearance).map_err(|_| RestoreError::Appearance)?;
    world.restore(state)?;
    Ok(appearance)
}

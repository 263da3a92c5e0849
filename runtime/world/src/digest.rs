//! Digests: numbers for all simulated state, the same wherever the same happened.

use crate::state::State;

/// The parts of a state, in the order of a digest's.
pub const DIGEST_PARTS: [&str; 4] = ["objects", "bodies", "mission", "physics"];
/// The bytes of each part in a digest: enough that no two states of a lifetime of sessions have the same by chance.
pub const DIGEST_PART_BYTES: usize = 8;
/// A furnished office takes about 40 kB.
const TYPICAL_BYTES: usize = 64 * 1024;

/// The beginning of Blake3 over each part of the state in its canonical encoding; of the solver, what moves in it.
pub(crate) fn digest(state: &State) -> [u8; 32] {
    let moving: Vec<_> = state.physics.moving().collect();
    let mission = (
        state.tick,
        &state.circuits,
        (&state.goals, &state.occasions),
        (&state.portals, &state.passes, &state.dinosaurs, &state.away),
        &state.ended,
        state.floor_version,
    );
    let mut bytes = Vec::with_capacity(TYPICAL_BYTES);
    let parts = [
        part(&state.objects, &mut bytes),
        part(&state.bodies, &mut bytes),
        part(&mission, &mut bytes),
        part(&moving, &mut bytes),
    ];
    let mut digest = [0; 32];
    digest.copy_from_slice(parts.as_flattened());
    digest
}

fn part(value: &impl serde::Serialize, bytes: &mut Vec<u8>) -> [u8; DIGEST_PART_BYTES] {
    bytes.clear();
    *bytes = postcard::to_extend(value, std::mem::take(bytes)).expect("invariant: plain data of known lengths encodes");
    let mut part = [0; DIGEST_PART_BYTES];
    part.copy_from_slice(&blake3::hash(bytes).as_bytes()[..DIGEST_PART_BYTES]);
    part
}

/// Blake3 over the whole state at once, as logs of format 1 have it.
pub(crate) fn digest_as_one(state: &State) -> [u8; 32] {
    let moving: Vec<_> = state.physics.moving().collect();
    let parts = (
        state.tick,
        &state.objects,
        &state.bodies,
        &state.circuits,
        (&state.goals, &state.occasions),
        (&state.portals, &state.passes, &state.dinosaurs, &state.away),
        &state.ended,
        state.floor_version,
        moving,
    );
    let bytes = postcard::to_extend(&parts, Vec::with_capacity(TYPICAL_BYTES))
        .expect("invariant: plain data of known lengths encodes");
    *blake3::hash(&bytes).as_bytes()
}

//! The digest: one number for all simulated state, the same wherever the same happened.

use crate::state::State;

/// Blake3 over the state in its canonical encoding; of the solver, what moves in it.
pub(crate) fn digest(state: &State) -> [u8; 32] {
    /// A furnished office takes about 40 kB.
    const TYPICAL_BYTES: usize = 64 * 1024;
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

//! Why an agent, or who looks through a camera, cannot go on in a session.

use cohabit_bus::{BusError, message::Malformed};

/// Why an agent left its session.
#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The session has no such camera.
    #[error("body {0} has no camera of its own: bodies count from 0")]
    NoCamera(u32),
    /// The session has no such body.
    #[error("there is no body {body}: the session has bodies 0 to {last}; `--body robot` adds one")]
    NoBody {
        /// The body that was asked for.
        body: u32,
        /// The last one that there is.
        last: usize,
    },
}

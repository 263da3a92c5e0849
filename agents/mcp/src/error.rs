//! Why a bridge cannot begin or go on.

use cohabit_agent::PeerError;
use cohabit_bus::{BusError, message::Malformed};

use crate::body_choice::BodyChoice;

/// Why a bridge cannot begin or go on.
#[derive(Debug, thiserror::Error)]
pub enum BridgeError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The body's camera cannot be looked through.
    #[error(transparent)]
    Camera(#[from] PeerError),
    /// The simulator tells nothing.
    #[error("the session tells of no world: does its simulator run? `cohabit top` shows it")]
    NoWorld,
    /// The session waits for those who take part.
    #[error("the session is in lock-step, and tools play in real time: start it without `--lock-step`")]
    LockStep,
    /// The session has no such body.
    #[error("the session has no {asked}; its bodies are {there}: choose one by `--body`")]
    NoBody {
        /// The body that was asked for.
        asked: BodyChoice,
        /// The numbers and kinds of those that there are.
        there: String,
    },
    /// The session's world has things of classes that are not known here.
    #[error("the session plays in a world that is not known here: give the same `--world` folders as to `play`")]
    OtherWorld,
    /// The client does not read what it is answered.
    #[error("the client does not read its answers: {0} of them wait")]
    NotRead(usize),
    /// The client reads no more.
    #[error("the client has closed its end")]
    Closed,
}

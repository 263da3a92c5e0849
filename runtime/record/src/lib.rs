//! The session log: one append-only MCAP file a session, from which the session can be replayed to the bit.
//!
//! It holds the mission with its seed, every input at the tick that took it in, a digest of the world after every
//! tick, outcomes and other events, and what was said. A log that ends in the middle of a record, since its recorder
//! was killed, opens up to there; the recorder that takes the dead one's place carries on with it, and nothing is
//! missing or told twice.
//!
//! This crate never knows rerun, the world's rules, or where pixels come from.

mod carry_on;
pub mod entry;
mod log;
mod recorder;
mod turns;
mod writer;

pub use carry_on::Written;
pub use entry::{DialogEntry, EventEntry, InputEntry, SessionEntry, TickEntry};
pub use log::{Log, LogError};
pub use recorder::{RecordError, Recorder, Recording};
pub use writer::LogWriter;

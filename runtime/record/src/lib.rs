//! The session log: one append-only MCAP file a session, from which the session can be replayed to the bit.
//!
//! It holds the mission with its seed, every input at the tick that took it in, a digest of the world after every
//! tick, outcomes and other events, and what was said. A log that ends in the middle of a record, since its recorder
//! was killed, opens up to there.
//!
//! This crate never knows rerun, the world's rules, or where pixels come from.

pub mod entry;
mod log;
mod recorder;
mod writer;

pub use entry::{DialogEntry, EventEntry, InputEntry, SessionEntry, TickEntry};
pub use log::{Log, LogError};
pub use recorder::{RecordError, Recorder, Recording};
pub use writer::LogWriter;

//! The session log: one append-only MCAP file a session, from which the session can be replayed to the bit.
//!
//! It holds the mission with its seed, every input at the tick that took it in, a digest of the world after every
//! tick, outcomes and other events, what was said, and now and then a snapshot of the whole state.
//!
//! # Format 3
//! An MCAP file of profile `cohabit`, without chunks. Its first records are the schemas and channels of all entries, and
//! the `/session` entry. That entry is repeated, each time in a segment of its own: once 8 KiB follow the first, then with
//! snapshots, and at the end. The first seven channels have fixed numbers: `/session` 1, `/ticks` 2, `/events` 3, `/dialog`
//! 4, `/answers` 5, `/gaps` 6, `/snapshots` 7. So a log can be read whose beginning is lost. The channels `/session`, `/ticks`, `/events`, `/dialog` and `/gaps` hold JSON, whose schemas
//! are in the file; so does `/frames/<camera>` for cameras whose frames were asked for, as Foxglove's `CompressedImage`,
//! and `/audio/microphone` and `/audio/speech`, where sound was asked for, as Foxglove's `RawAudio`.
//! `/snapshots` holds the tick (8 bytes, little-endian) and behind it the state, deflated. A message's
//! time is the machine's wall clock.
//!
//! What is appended between two flushes, at least ten a second, is a segment, and ends with a seal: a record of kind
//! 0x80, which MCAP leaves to programs, with a CRC-32 and the segment's number. The CRC is of the seal before (8 bytes),
//! and the segment's bytes; before the first, the seal is zero. So no byte can change unnoticed, nor segments
//! go, come or change places; and what stands behind a damaged segment is read all the same. A log that ends in the
//! middle of a segment, since its recorder was killed, opens up to there; the recorder that takes the dead one's place
//! carries on with it, and nothing is missing or told twice.
//!
//! The recorder is a peer like others, whom nobody waits for: if it is away for longer than the bus keeps messages, or
//! its disk is too slow, the log says in `/gaps` what it misses. While the disk is full, what there is no room for waits in
//! memory, and is told; with room again, nothing is missing.
//!
//! Format 2 had one session entry; where that is damaged, its logs do not open.
//!
//! Format 1 had neither seals nor snapshots nor gaps, and digests that did not tell the parts of a state apart. Its logs
//! open; what is damaged in them is found only where it cannot be read.
//!
//! This crate never knows rerun, the world's rules, or where pixels come from.

mod carry_on;
mod channels;
mod copies;
mod decision;
pub mod entry;
mod film;
mod log;
mod movement;
mod reading;
mod recorder;
mod segment;
mod snapshot;
mod spool;
mod tape;
mod turns;
mod writer;

pub use carry_on::Written;
pub use decision::{DecisionOutcome, Proposed, WizardDecision};
pub use entry::{
    AnswerEntry, Branch, DialogEntry, EventEntry, GapEntry, InputEntry, OfferEntry, SessionEntry, SessionFacts,
    TickEntry,
};
pub use log::{Log, LogError, Lost};
pub use movement::{Movement, Stop, Trail, Travel};
pub use recorder::{RecordError, Recorder, Recording};
pub use snapshot::Snapshot;
pub use writer::LogWriter;

//! The channels of a log.

use crate::entry::{AnswerEntry, DialogEntry, Entry, EventEntry, GapEntry, SessionEntry, TickEntry};

/// Where snapshots are, in an encoding of their own.
pub(crate) const SNAPSHOTS: &str = "/snapshots";

/// The channels that every log has, in the order of their numbers, which count from 1: where the records that say so are
/// lost, a reader knows the channels by these.
pub(crate) const CHANNELS: [&str; 7] = [
    SessionEntry::TOPIC,
    TickEntry::TOPIC,
    EventEntry::TOPIC,
    DialogEntry::TOPIC,
    AnswerEntry::TOPIC,
    GapEntry::TOPIC,
    SNAPSHOTS,
];

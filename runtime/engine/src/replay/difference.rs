//! Where a replay parts from its log.

use std::fmt;

use cohabit_world::{DIGEST_PART_BYTES, DIGEST_PARTS};

use super::Replayer;

/// How many of the things that differ are named.
const MOST_NAMED: usize = 5;

/// Where a replay parts from its log.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The log has no entry for this tick: it has a gap.
    Missing {
        /// The first tick missing.
        tick: u64,
        /// The tick found in its place.
        found: u64,
    },
    /// The states differ after this tick.
    Digest {
        /// The first tick that differs.
        tick: u64,
        /// The parts of the state that differ.
        parts: Vec<&'static str>,
        /// What differs at the next snapshot, and its tick; nothing where there is none.
        things: Option<(u64, Vec<String>)>,
    },
}

impl Difference {
    /// Between digests as a log has them, in hexadecimal; none if they are equal.
    pub(super) fn between(tick: u64, recorded: &str, replayed: &str) -> Option<Self> {
        const DIGITS: usize = 2 * DIGEST_PART_BYTES;
        if recorded == replayed {
            return None;
        }
        let part = |digest: &str, index: usize| digest.get(index * DIGITS..(index + 1) * DIGITS).map(str::to_owned);
        let differs = |index: &usize| part(recorded, *index) != part(replayed, *index);
        let parts = (0..DIGEST_PARTS.len()).filter(differs).map(|index| DIGEST_PARTS[index]).collect();
        Some(Self::Digest { tick, parts, things: None })
    }

    /// The same with what differs at the next snapshot, to which `replayer` goes on.
    pub(super) fn explained_by(self, replayer: &mut Replayer<'_>) -> Self {
        match self {
            Self::Digest { tick, parts, .. } => Self::Digest { tick, parts, things: replayer.differences() },
            missing @ Self::Missing { .. } => missing,
        }
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing { tick, found } if *found == tick + 1 => write!(f, "the log has no tick {tick}"),
            Self::Missing { tick, found } => write!(f, "the log has no ticks {tick} to {}", found.saturating_sub(1)),
            Self::Digest { tick, parts, things } => {
                let all = parts.len() == DIGEST_PARTS.len();
                write!(f, "tick {tick} differs in {}", if all { "all parts".to_owned() } else { parts.join(", ") })?;
                let Some((at, things)) = things else { return Ok(()) };
                let named: Vec<_> = things.iter().take(MOST_NAMED).map(String::as_str).collect();
                match named.as_slice() {
                    [] => write!(f, "; at the snapshot of tick {at} nothing differs any more"),
                    named => write!(f, "; at the snapshot of tick {at} differ: {}", named.join("; ")),
                }?;
                let more = things.len().saturating_sub(MOST_NAMED);
                if more > 0 { write!(f, "; and {more} more") } else { Ok(()) }
            }
        }
    }
}

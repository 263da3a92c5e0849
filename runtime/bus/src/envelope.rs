//! What stands before every message, and the unit of memory that messages are made of.

use std::time::{SystemTime, UNIX_EPOCH};

use bytemuck::{Pod, Zeroable};
use iceoryx2::prelude::ZeroCopySend;

/// The unit of a sample's memory: 64 bytes on a 64-byte boundary (a cache line), so that every plane and record in it
/// can be viewed in place.
#[derive(Clone, Copy, Debug, Pod, Zeroable, ZeroCopySend)]
#[repr(C)]
#[repr(align(64))]
#[type_name("cohabit_block_v1")]
pub struct Block(pub [u8; 64]);

impl Default for Block {
    fn default() -> Self {
        Self([0; 64])
    }
}

impl Block {
    /// How many blocks hold so many bytes.
    #[must_use]
    pub const fn count_for(bytes: usize) -> usize {
        bytes.div_ceil(size_of::<Self>())
    }
}

/// The first block of every sample.
#[derive(Clone, Copy, Debug, Default, Eq, Pod, PartialEq, Zeroable)]
#[repr(C)]
pub struct Envelope {
    /// [`Envelope::VERSION`] of the sender.
    pub version: u32,
    /// Length of the payload that follows, bytes.
    pub payload_bytes: u32,
    /// The session, as a number: equal in all its processes.
    pub session: u64,
    /// A number unlike that of any other publisher; its upper 24 bits are the process id.
    pub run: u64,
    /// The simulator's tick that the message belongs to; 0 where none does.
    pub tick: u64,
    /// The sender's count of messages on this topic, from 0.
    pub sequence: u64,
    /// [`monotonic_nanos`] when it was sent.
    pub sent_nanos: u64,
    /// Zero.
    pub reserved: [u64; 2],
}

impl Envelope {
    /// Counts changes of any message's layout.
    pub const VERSION: u32 = 7;
}

const _: () = assert!(size_of::<Envelope>() == size_of::<Block>());

/// Nanoseconds since 1970 by the machine's wall clock: for people and logs, never a key.
#[must_use]
pub fn wall_nanos() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// Nanoseconds of the machine's monotonic clock: comparable between the processes of one machine until it restarts.
#[must_use]
pub fn monotonic_nanos() -> u64 {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    u64::try_from(now.tv_sec).unwrap_or(0) * 1_000_000_000 + u64::try_from(now.tv_nsec).unwrap_or(0)
}

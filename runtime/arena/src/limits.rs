//! How long a client may keep its place, and how much memory all of them may take.

use std::time::Duration;

/// Bounds for clients. Tests take others.
///
/// A client that has sent a message may be silent for as long as it likes: existing ones think for minutes between two
/// batches. It gives way only where all places are taken.
#[derive(Clone, Copy, Debug)]
pub struct ClientLimits {
    /// The most clients at once. One is usual; those that lost their connection may not know it yet.
    pub most_clients: usize,
    /// The longest until a client's first message is whole. Some connect, and load a model before they say anything.
    pub first_message: Duration,
    /// The longest from the first byte of a message to its last: a megabyte a second for the longest.
    pub message: Duration,
    /// The longest that a client may take to take in an answer, which has some megabytes at most.
    pub answer: Duration,
    /// A client that was silent for so long between two messages gives way to another one, where all places are taken.
    pub gives_way_after: Duration,
    /// What each client's unfinished message may take of memory, bytes: far more than any mission or batch has.
    pub own_bytes: usize,
    /// What the unfinished messages of all clients may take beyond that together, bytes: two of the longest.
    pub shared_bytes: usize,
}

impl Default for ClientLimits {
    fn default() -> Self {
        Self {
            most_clients: 16,
            first_message: Duration::from_secs(600),
            message: Duration::from_secs(60),
            answer: Duration::from_secs(60),
            gives_way_after: Duration::from_secs(600),
            own_bytes: 1 << 20,
            shared_bytes: 128 << 20,
        }
    }
}

//! What every transport offers.

use std::time::Duration;

use crate::{
    envelope::{Block, Envelope, monotonic_nanos},
    error::BusError,
    topic::{Topic, Wake},
};

/// A way for the peers of one session to reach each other.
pub trait Transport: Send + Sync {
    /// A new publisher on `topic`.
    ///
    /// # Errors
    /// [`BusError::Open`].
    fn publisher(&self, topic: Topic) -> Result<Box<dyn Publisher>, BusError>;

    /// A new subscriber to `topic`; it first receives what the topic keeps for late joiners.
    ///
    /// # Errors
    /// [`BusError::Open`].
    fn subscriber(&self, topic: Topic) -> Result<Box<dyn Subscriber>, BusError>;

    /// Something to sleep on until a publisher of that group sends.
    ///
    /// # Errors
    /// [`BusError::Open`].
    fn listener(&self, wake: Wake) -> Result<Box<dyn Listener>, BusError>;
}

/// Sends samples on one topic.
pub trait Publisher: Send {
    /// Sends a sample of `bytes` bytes, written in place by `write` (the memory is not zeroed: write all of it).
    /// Gives the sample's sequence number.
    ///
    /// # Errors
    /// [`BusError::Send`], when there is no memory left.
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError>;

    /// How many subscribe now; a publisher whose samples are costly need make none for nobody.
    fn subscribers(&self) -> usize;

    /// Hands what the topic keeps to subscribers that joined since the last sample.
    ///
    /// # Errors
    /// [`BusError::Send`].
    fn update(&mut self) -> Result<(), BusError>;
}

/// Receives samples of one topic, in order.
pub trait Subscriber: Send {
    /// The next sample, if one is there.
    ///
    /// # Errors
    /// [`BusError::Receive`], [`BusError::Version`], [`BusError::Malformed`].
    fn receive(&mut self) -> Result<Option<Sample>, BusError>;

    /// The newest sample, if any is there; older ones are dropped unseen and not counted as lost.
    ///
    /// # Errors
    /// As [`Self::receive`].
    fn latest(&mut self) -> Result<Option<Sample>, BusError> {
        let mut newest = None;
        while let Some(sample) = self.receive()? {
            newest = Some(sample);
        }
        Ok(newest)
    }

    /// How many samples came and went unread because this subscriber was slow.
    fn lost(&self) -> u64;
}

/// Sleeps until woken.
pub trait Listener: Send {
    /// Sleeps until a publisher of the group sends, at most for `timeout`; says whether it was woken. A message sent
    /// since the last call wakes at once.
    ///
    /// # Errors
    /// [`BusError::Receive`].
    fn wait(&mut self, timeout: Duration) -> Result<bool, BusError>;
}

/// A message as received: a view of the memory its sender wrote, kept alive while the sample is.
pub struct Sample {
    memory: Box<dyn SampleMemory>,
    envelope: Envelope,
}

pub(crate) trait SampleMemory: Send {
    fn blocks(&self) -> &[Block];
}

impl Sample {
    pub(crate) fn new(topic: Topic, memory: Box<dyn SampleMemory>) -> Result<Self, BusError> {
        let blocks = memory.blocks();
        let Some(first) = blocks.first() else {
            return Err(BusError::Malformed { topic, reason: "no envelope" });
        };
        let envelope: Envelope = bytemuck::cast(first.0);
        if envelope.version != Envelope::VERSION {
            let (found, expected) = (envelope.version, Envelope::VERSION);
            return Err(BusError::Version { topic, found, expected });
        }
        if envelope.payload_bytes as usize > (blocks.len() - 1) * size_of::<Block>() {
            return Err(BusError::Malformed { topic, reason: "payload longer than its sample" });
        }
        Ok(Self { memory, envelope })
    }

    /// What stands before the payload.
    #[must_use]
    pub const fn envelope(&self) -> &Envelope {
        &self.envelope
    }

    /// The payload; begins on a 64-byte boundary.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        &bytemuck::cast_slice::<Block, u8>(&self.memory.blocks()[1..])[..self.envelope.payload_bytes as usize]
    }
}

impl std::fmt::Debug for Sample {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sample").field("envelope", &self.envelope).finish_non_exhaustive()
    }
}

/// Counts what a subscriber missed, a publisher's run at a time.
#[derive(Default)]
pub(crate) struct GapCounter {
    next_by_run: Vec<(u64, u64)>,
    pub(crate) lost: u64,
}

impl GapCounter {
    pub(crate) fn saw(&mut self, envelope: &Envelope) {
        match self.next_by_run.iter_mut().find(|(run, _)| *run == envelope.run) {
            Some((_, next)) => {
                self.lost += envelope.sequence.saturating_sub(*next);
                *next = envelope.sequence + 1;
            }
            None => self.next_by_run.push((envelope.run, envelope.sequence + 1)),
        }
    }
}

/// Fills a sample's blocks: what `write` writes, then the envelope before it, stamped as late as can be.
pub(crate) fn fill(blocks: &mut [Block], mut envelope: Envelope, write: &mut dyn FnMut(&mut [u8])) {
    let payload = bytemuck::cast_slice_mut::<Block, u8>(&mut blocks[1..]);
    write(&mut payload[..envelope.payload_bytes as usize]);
    envelope.sent_nanos = monotonic_nanos();
    blocks[0] = bytemuck::cast(envelope);
}

/// A number unlike that of any other publisher.
pub(crate) fn new_run() -> u64 {
    use std::sync::atomic::{AtomicU64, Ordering};
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    (u64::from(std::process::id()) << 40) ^ (count << 32) ^ (monotonic_nanos() >> 10)
}

//! What every transport offers.

use std::{collections::VecDeque, time::Duration};

use bytemuck::NoUninit;

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

    /// A new subscriber to `topic`; it first receives what the topic keeps of each present publisher for late joiners.
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

/// Sends samples on one topic. What it has sent before a subscriber first looked for it may go with it when it is
/// dropped.
pub trait Publisher: Send {
    /// Sends a sample of `bytes` bytes, written in place by `write` (the memory is not zeroed: write all of it).
    /// Gives the sample's sequence number.
    ///
    /// # Errors
    /// [`BusError::Send`], when there is no memory left; [`BusError::TooLong`].
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError>;

    /// The `run` in the envelopes of its samples: who it is.
    fn run(&self) -> u64;

    /// How many subscribe now; a publisher whose samples are costly need make none for nobody.
    fn subscribers(&self) -> usize;

    /// Hands what the topic keeps to subscribers that joined since the last sample.
    ///
    /// # Errors
    /// [`BusError::Send`].
    fn update(&mut self) -> Result<(), BusError>;
}

impl dyn Publisher + '_ {
    /// Sends a message of fixed size. Gives the sample's sequence number.
    ///
    /// # Errors
    /// As [`Publisher::send`].
    pub fn send_record(&mut self, tick: u64, record: &impl NoUninit) -> Result<u64, BusError> {
        let record = bytemuck::bytes_of(record);
        self.send(tick, record.len(), &mut |bytes| bytes.copy_from_slice(record))
    }
}

/// Receives samples of one topic: those of a publisher in the order in which they were sent. What a publisher has sent
/// is received also after it is gone, if anything of it was before. A topic holds so many of the newest samples of each
/// publisher for a slow subscriber.
pub trait Subscriber: Send {
    /// The next sample, if one is there. A subscriber may hold eight at once, and receives no more until it lets go of
    /// one.
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

    /// How many samples came and went unread because this subscriber was slow: of each publisher, since the first one
    /// of it that was received.
    fn lost(&self) -> u64;
}

/// The most samples that one subscriber may hold.
pub(crate) const MOST_HELD: usize = 8;

/// Why a subscriber receives no more.
pub(crate) fn holds_too_many(topic: Topic) -> BusError {
    let reason = format!("{MOST_HELD} samples are held already; let go of one");
    BusError::Receive { topic, reason }
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
        let payload_bytes = envelope.payload_bytes as usize;
        if topic.most_bytes().is_some_and(|most| payload_bytes > most) {
            return Err(BusError::Malformed { topic, reason: "payload longer than its topic takes" });
        }
        // How many blocks there are is written in shared memory, too, beside the envelope: if somebody has overwritten both,
        // they hardly agree.
        if blocks.len() - 1 != Block::count_for(payload_bytes) {
            return Err(BusError::Malformed { topic, reason: "payload not of the length of its sample" });
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
    /// Oldest first.
    next_by_run: VecDeque<(u64, u64)>,
    pub(crate) lost: u64,
}

/// More publishers than a topic ever had at once, many times over: a peer that writes another run into each envelope must
/// not fill the memory.
const MOST_RUNS: usize = 1024;

impl GapCounter {
    pub(crate) fn saw(&mut self, envelope: &Envelope) {
        match self.next_by_run.iter_mut().find(|(run, _)| *run == envelope.run) {
            Some((_, next)) => {
                self.lost = self.lost.saturating_add(envelope.sequence.saturating_sub(*next));
                *next = envelope.sequence.saturating_add(1);
            }
            None => {
                if self.next_by_run.len() == MOST_RUNS {
                    self.next_by_run.pop_front();
                }
                self.next_by_run.push_back((envelope.run, envelope.sequence.saturating_add(1)));
            }
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
    /// Beyond it a count and the time would reach the process id.
    const MASK: u64 = (1 << 40) - 1;
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    (u64::from(std::process::id()) << 40) | (((count << 28) ^ (monotonic_nanos() >> 12)) & MASK)
}

/// The process of a publisher, by its run.
#[must_use]
pub const fn process_of(run: u64) -> u32 {
    (run >> 40) as u32
}

/// Whether the process of a publisher lives.
#[must_use]
pub fn is_alive(run: u64) -> bool {
    let process = i32::try_from(process_of(run)).ok().and_then(rustix::process::Pid::from_raw);
    process.is_some_and(|process| rustix::process::test_kill_process(process).is_ok())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    impl SampleMemory for Vec<Block> {
        fn blocks(&self) -> &[Block] {
            self
        }
    }

    fn sample(envelope: Envelope, more: usize) -> Result<Sample, BusError> {
        let mut blocks = vec![Block([7; 64]); 1 + more];
        blocks[0] = bytemuck::cast(envelope);
        Sample::new(Topic::State, Box::new(blocks))
    }

    #[test]
    fn envelopes_of_another_version_and_with_wrong_lengths_are_refused() {
        let envelope = Envelope { version: Envelope::VERSION, payload_bytes: 128, ..Envelope::default() };
        assert_eq!(sample(envelope, 2).unwrap().payload(), [7; 128]);
        assert!(matches!(sample(envelope, 1), Err(BusError::Malformed { .. })));
        assert!(matches!(sample(envelope, 3), Err(BusError::Malformed { .. })));
        let other = Envelope { version: 1, ..envelope };
        let Err(error) = sample(other, 2) else { panic!("read") };
        assert!(matches!(error, BusError::Version { found: 1, .. }), "{error}");
        assert!(error.to_string().contains("`state`"), "{error}");
        assert!(matches!(Sample::new(Topic::State, Box::new(Vec::<Block>::new())), Err(BusError::Malformed { .. })));
    }

    #[test]
    fn a_payload_longer_than_its_topic_takes_is_refused() {
        let most = Topic::Pulses.most_bytes().unwrap();
        let of = |bytes: usize| {
            let payload_bytes = u32::try_from(bytes).unwrap();
            let envelope = Envelope { version: Envelope::VERSION, payload_bytes, ..Envelope::default() };
            let mut blocks = vec![Block::default(); 1 + Block::count_for(bytes)];
            blocks[0] = bytemuck::cast(envelope);
            Sample::new(Topic::Pulses, Box::new(blocks)).map(drop)
        };
        assert!(of(most).is_ok());
        assert!(matches!(of(most + 1), Err(BusError::Malformed { .. })));
    }

    proptest! {
        #[test]
        fn gaps_of_any_envelopes_are_counted_in_bounded_memory(numbers in proptest::collection::vec(any::<[u64; 2]>(), 0..3000)) {
            let mut gaps = GapCounter::default();
            let ends = [[1, u64::MAX], [1, 0], [1, u64::MAX], [2, 0], [2, u64::MAX]];
            for [run, sequence] in numbers.into_iter().chain(ends) {
                gaps.saw(&Envelope { run, sequence, ..Envelope::default() });
            }
            prop_assert!(gaps.next_by_run.len() <= MOST_RUNS);
        }

        #[test]
        fn any_first_block_is_an_envelope_or_refused(
            bytes in proptest::collection::vec(any::<u8>(), 64..256),
            version in prop_oneof![Just(Envelope::VERSION), any::<u32>()],
        ) {
            let whole: Vec<Block> = bytes.as_chunks().0.iter().map(|chunk| Block(*chunk)).collect();
            let mut envelope: Envelope = bytemuck::cast(whole[0].0);
            envelope.version = version;
            envelope.payload_bytes %= 300;
            if let Ok(sample) = sample(envelope, whole.len() - 1) {
                prop_assert_eq!(sample.payload().len(), envelope.payload_bytes as usize);
            }
        }
    }
}

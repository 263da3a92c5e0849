//! The transport inside one process: shared vectors, a condition variable.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Condvar, Mutex, MutexGuard, Weak},
    time::Duration,
};

use crate::{
    envelope::{Block, Envelope},
    error::BusError,
    topic::{Topic, Wake},
    transport::{
        GapCounter, Listener, MOST_HELD, Publisher, Sample, SampleMemory, Subscriber, Transport, fill, holds_too_many,
        new_run,
    },
};

/// A transport between the threads of one process. Clones share it.
#[derive(Clone)]
pub struct Local {
    session: u64,
    hub: Arc<Mutex<Hub>>,
}

#[derive(Default)]
struct Hub {
    topics: BTreeMap<Topic, Channel>,
    bells: BTreeMap<Wake, Vec<Weak<Bell>>>,
}

#[derive(Default)]
struct Channel {
    /// For late joiners.
    kept: Queue,
    queues: Vec<Weak<Mutex<Queue>>>,
}

/// Samples in the order in which they were sent, so many of each publisher's run at most.
#[derive(Clone, Default)]
struct Queue {
    samples: VecDeque<(u64, Arc<Vec<Block>>)>,
}

impl Queue {
    /// Adds a sample; drops the oldest of that run if there are now more than `depth` of it.
    fn push(&mut self, run: u64, sample: Arc<Vec<Block>>, depth: usize) {
        self.samples.push_back((run, sample));
        let of_run = || self.samples.iter().enumerate().filter(|(_, (other, _))| *other == run);
        if self.samples.len() > depth && of_run().count() > depth {
            let oldest = of_run().next().map(|(index, _)| index);
            if let Some(index) = oldest {
                self.samples.remove(index);
            }
        }
    }

    fn forget(&mut self, run: u64) {
        self.samples.retain(|(other, _)| *other != run);
    }
}

#[derive(Default)]
struct Bell {
    rung: Mutex<bool>,
    changed: Condvar,
}

/// A sample that somebody holds: its subscriber's count of them goes down when it is dropped.
struct Held {
    blocks: Arc<Vec<Block>>,
    _count: Arc<()>,
}

impl SampleMemory for Held {
    fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

impl Local {
    /// A transport for the session of that number.
    #[must_use]
    pub fn new(session: u64) -> Self {
        Self { session, hub: Arc::default() }
    }
}

impl Transport for Local {
    fn publisher(&self, topic: Topic) -> Result<Box<dyn Publisher>, BusError> {
        Ok(Box::new(LocalPublisher { bus: self.clone(), topic, run: new_run(), sequence: 0 }))
    }

    fn subscriber(&self, topic: Topic) -> Result<Box<dyn Subscriber>, BusError> {
        let mut hub = lock(&self.hub);
        let channel = hub.topics.entry(topic).or_default();
        let queue = Arc::new(Mutex::new(channel.kept.clone()));
        channel.queues.push(Arc::downgrade(&queue));
        Ok(Box::new(LocalSubscriber { topic, queue, gaps: GapCounter::default(), held: Arc::default() }))
    }

    fn listener(&self, wake: Wake) -> Result<Box<dyn Listener>, BusError> {
        let bell = Arc::new(Bell::default());
        lock(&self.hub).bells.entry(wake).or_default().push(Arc::downgrade(&bell));
        Ok(Box::new(LocalListener { bell }))
    }
}

struct LocalPublisher {
    bus: Local,
    topic: Topic,
    run: u64,
    sequence: u64,
}

impl Publisher for LocalPublisher {
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError> {
        let sequence = self.sequence;
        let envelope = Envelope {
            version: Envelope::VERSION,
            payload_bytes: payload_bytes(self.topic, bytes)?,
            session: self.bus.session,
            run: self.run,
            tick,
            sequence,
            ..Envelope::default()
        };
        let mut blocks = vec![Block::default(); 1 + Block::count_for(bytes)];
        fill(&mut blocks, envelope, write);
        let blocks = Arc::new(blocks);
        let mut hub = lock(&self.bus.hub);
        let channel = hub.topics.entry(self.topic).or_default();
        channel.kept.push(self.run, Arc::clone(&blocks), self.topic.history());
        channel.queues.retain(|queue| {
            queue.upgrade().is_some_and(|queue| {
                lock(&queue).push(self.run, Arc::clone(&blocks), self.topic.depth());
                true
            })
        });
        if let Some(bells) = hub.bells.get_mut(&self.topic.wake()) {
            bells.retain(|bell| bell.upgrade().is_some_and(|bell| ring(&bell)));
        }
        self.sequence += 1;
        Ok(sequence)
    }

    fn run(&self) -> u64 {
        self.run
    }

    fn subscribers(&self) -> usize {
        let hub = lock(&self.bus.hub);
        hub.topics.get(&self.topic).map_or(0, |c| c.queues.iter().filter(|q| q.strong_count() > 0).count())
    }

    fn update(&mut self) -> Result<(), BusError> {
        Ok(())
    }
}

impl Drop for LocalPublisher {
    fn drop(&mut self) {
        if let Some(channel) = lock(&self.bus.hub).topics.get_mut(&self.topic) {
            channel.kept.forget(self.run);
        }
    }
}

pub(crate) fn payload_bytes(topic: Topic, bytes: usize) -> Result<u32, BusError> {
    let most = topic.most_bytes().unwrap_or(u32::MAX as usize);
    let fits = u32::try_from(bytes).ok().filter(|_| bytes <= most);
    fits.ok_or(BusError::TooLong { topic, bytes, most })
}

fn ring(bell: &Bell) -> bool {
    *lock(&bell.rung) = true;
    bell.changed.notify_all();
    true
}

struct LocalSubscriber {
    topic: Topic,
    queue: Arc<Mutex<Queue>>,
    gaps: GapCounter,
    /// Shared by all samples that are held.
    held: Arc<()>,
}

impl Subscriber for LocalSubscriber {
    fn receive(&mut self) -> Result<Option<Sample>, BusError> {
        if Arc::strong_count(&self.held) > MOST_HELD {
            return Err(holds_too_many(self.topic));
        }
        let Some((_, blocks)) = lock(&self.queue).samples.pop_front() else { return Ok(None) };
        let sample = Sample::new(self.topic, Box::new(Held { blocks, _count: Arc::clone(&self.held) }))?;
        self.gaps.saw(sample.envelope());
        Ok(Some(sample))
    }

    fn lost(&self) -> u64 {
        self.gaps.lost
    }
}

struct LocalListener {
    bell: Arc<Bell>,
}

impl Listener for LocalListener {
    fn wait(&mut self, timeout: Duration) -> Result<bool, BusError> {
        let rung = lock(&self.bell.rung);
        let (mut rung, _) = self
            .bell
            .changed
            .wait_timeout_while(rung, timeout, |rung| !*rung)
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(std::mem::take(&mut *rung))
    }
}

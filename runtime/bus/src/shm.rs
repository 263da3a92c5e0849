//! The transport between processes: shared memory by iceoryx2.
//!
//! Every session has its own name prefix and root folder, so sessions never meet, and a supervisor can wipe all that
//! one left behind. All files are the user's own (0600), and refused if they are not.

use std::{fmt::Debug, fs, io::Write as _, os::unix::fs::MetadataExt as _, sync::Arc, time::Duration};

use iceoryx2::{
    node::{Node, NodeBuilder},
    port::{
        ReceiveError, publisher::Publisher as IoxPublisher, subscriber::Subscriber as IoxSubscriber,
        update_connections::UpdateConnections,
    },
    prelude::*,
    sample::Sample as IoxSample,
    service::port_factory::{PortFactory as _, publish_subscribe::PortFactory},
};

use crate::{
    bell::Bell,
    envelope::{Block, Envelope},
    error::BusError,
    local::payload_bytes,
    private::{self, AccessError},
    session::Session,
    topic::{Topic, Wake},
    transport::{
        GapCounter, Listener, MOST_HELD, Publisher, Sample, SampleMemory, Subscriber, Transport, fill, holds_too_many,
        new_run,
    },
};

type Ipc = ipc_threadsafe::Service;

const MAX_PEERS: usize = 32;
/// iceoryx2's folder of topics in a session's own.
const SERVICES: &str = "services";
/// How the name of iceoryx2's count of nodes ends.
const GLOBAL_MANAGEMENT: &str = "global_mgmt";

/// The shared-memory transport of one session.
pub struct Shm {
    session: Session,
    node: Arc<Node<Ipc>>,
}

impl Shm {
    /// Joins `session`, whose supervisor must have prepared it.
    ///
    /// # Errors
    /// [`BusError::NoSession`], [`BusError::OtherVersion`], [`BusError::Access`], [`BusError::Join`].
    pub fn join(session: &Session) -> Result<Self, BusError> {
        set_log_level(LogLevel::Fatal);
        let failed = |reason: String| BusError::Join { session: session.name().to_owned(), reason };
        let name = || session.name().to_owned();
        let folder = session.folder();
        if !folder.is_dir() {
            return Err(BusError::NoSession { session: name() });
        }
        session.check().map_err(|source| BusError::Access { session: name(), source })?;
        if let Some(spoken) = session.version().filter(|spoken| *spoken != Envelope::VERSION) {
            return Err(BusError::OtherVersion { session: name(), spoken, own: Envelope::VERSION });
        }
        let mut config = Config::default();
        config.global.prefix = session.prefix().as_str().try_into().map_err(|e| failed(format!("{e:?}")))?;
        let root = folder.to_string_lossy();
        config.global.set_root_path(&Path::new(root.as_bytes()).map_err(|e| failed(format!("{root}: {e:?}")))?);
        let access = |source| BusError::Access { session: name(), source };
        private::make_folder(&folder.join(SERVICES)).map_err(access)?;
        let node = NodeBuilder::new()
            .config(&config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|e| failed(format!("{e:?}")))?;
        close_memory(session).map_err(access)?;
        private::close_folders(&folder);
        Ok(Self { session: session.clone(), node: Arc::new(node) })
    }

    /// Makes these topics, before there are peers: one that dies while it makes a topic would keep all others from it.
    ///
    /// # Errors
    /// [`BusError::Open`].
    pub fn hold(&self, topics: impl IntoIterator<Item = Topic>) -> Result<HeldTopics, BusError> {
        topics.into_iter().map(|topic| self.topic_service(topic)).collect::<Result<_, _>>().map(HeldTopics)
    }

    /// Frees what peers that died have left in the session; call it about once a second.
    pub fn clean_up_dead_peers(&self) {
        let _ = self.node.try_cleanup_dead_nodes();
    }

    fn topic_service(&self, topic: Topic) -> Result<PortFactory<Ipc, [Block], ()>, BusError> {
        let failed = |reason: String| BusError::Open { topic, reason };
        self.node
            .service_builder(&service_name(&topic.to_string()).map_err(failed)?)
            .publish_subscribe::<[Block]>()
            .enable_safe_overflow(true)
            .history_size(topic.history())
            .subscriber_max_buffer_size(topic.depth())
            .subscriber_max_borrowed_samples(MOST_HELD)
            .max_publishers(MAX_PEERS)
            .max_subscribers(topic.most_subscribers())
            .max_nodes(MAX_PEERS)
            .open_or_create()
            .map_err(|e| failed(format!("{e:?}")))
    }

    fn bell(&self, wake: Wake) -> Result<Bell, AccessError> {
        Bell::open(&self.session.shared_file(&wake.to_string()))
    }
}

/// iceoryx2 makes one file of a session, a count of its nodes, writable for everybody whatever the process's umask. Whoever
/// makes it, the supervisor, puts a copy in its place that is this user's alone: who opened the first one before has
/// nothing of it.
fn close_memory(session: &Session) -> Result<(), AccessError> {
    for path in session.memory().filter(|path| path.to_string_lossy().ends_with(GLOBAL_MANAGEMENT)) {
        let failed = |source| AccessError::System { path: path.clone(), source };
        let mode = fs::metadata(&path).map_err(failed)?.mode();
        if mode & 0o077 == 0 {
            continue;
        }
        let copied = session.shared_file("copy");
        let mut copy = private::create_new(&copied)?;
        let placed = fs::read(&path).and_then(|bytes| copy.write_all(&bytes)).and_then(|()| fs::rename(&copied, &path));
        placed.map_err(failed)?;
    }
    Ok(())
}

/// Topics that are there for as long as this is.
pub struct HeldTopics(#[expect(dead_code, reason = "they are held, not used")] Vec<PortFactory<Ipc, [Block], ()>>);

fn service_name(name: &str) -> Result<ServiceName, String> {
    name.try_into().map_err(|e| format!("{e:?}"))
}

impl Transport for Shm {
    fn publisher(&self, topic: Topic) -> Result<Box<dyn Publisher>, BusError> {
        let failed = |reason: String| BusError::Open { topic, reason };
        let service = self.topic_service(topic)?;
        let grows = topic.most_bytes().is_none();
        let strategy = if grows { AllocationStrategy::PowerOfTwo } else { AllocationStrategy::Static };
        let port = service
            .publisher_builder()
            .initial_max_slice_len(1 + Block::count_for(topic.usual_bytes()))
            .allocation_strategy(strategy)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| failed(format!("{e:?}")))?;
        let bell = self.bell(topic.wake()).map_err(|error| failed(error.to_string()))?;
        let session = self.session.number();
        Ok(Box::new(ShmPublisher { topic, session, port, service, bell, run: new_run(), sequence: 0 }))
    }

    fn subscriber(&self, topic: Topic) -> Result<Box<dyn Subscriber>, BusError> {
        let port = self
            .topic_service(topic)?
            .subscriber_builder()
            .create()
            .map_err(|e| BusError::Open { topic, reason: format!("{e:?}") })?;
        Ok(Box::new(ShmSubscriber { topic, port, gaps: GapCounter::default() }))
    }

    fn listener(&self, wake: Wake) -> Result<Box<dyn Listener>, BusError> {
        let topic = match wake {
            Wake::Commands => Topic::Commands,
            Wake::Pulses => Topic::Pulses,
            Wake::Talk => Topic::Dialog,
            Wake::Audio => Topic::Speech,
            Wake::State => Topic::State,
            Wake::Frames(camera) => Topic::Frames(camera),
        };
        let bell = self.bell(wake).map_err(|error| BusError::Open { topic, reason: error.to_string() })?;
        Ok(Box::new(ShmListener { topic, heard: bell.rung(), bell }))
    }
}

struct ShmPublisher {
    topic: Topic,
    session: u64,
    port: IoxPublisher<Ipc, [Block], ()>,
    service: PortFactory<Ipc, [Block], ()>,
    bell: Bell,
    run: u64,
    sequence: u64,
}

impl Publisher for ShmPublisher {
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError> {
        let failed = |error: &dyn Debug| not_sent(self.topic, error);
        let sequence = self.sequence;
        let envelope = Envelope {
            version: Envelope::VERSION,
            payload_bytes: payload_bytes(self.topic, bytes)?,
            session: self.session,
            run: self.run,
            tick,
            sequence,
            ..Envelope::default()
        };
        let blocks = 1 + Block::count_for(bytes);
        let sample = self.port.loan_slice_uninit(blocks).map_err(|error| failed(&error))?;
        // SAFETY: a `Block` is plain bytes, of which all patterns are valid, in memory that the shared segment has
        // initialised (the kernel hands out zeroed pages).
        let mut sample = unsafe { sample.assume_init() };
        fill(sample.payload_mut(), envelope, write);
        sample.send().map_err(|error| failed(&error))?;
        self.bell.ring();
        self.sequence += 1;
        Ok(sequence)
    }

    fn run(&self) -> u64 {
        self.run
    }

    fn subscribers(&self) -> usize {
        self.service.dynamic_config().number_of_subscribers()
    }

    fn update(&mut self) -> Result<(), BusError> {
        self.port.update_connections().map_err(|error| not_sent(self.topic, &error))
    }
}

/// Why a sample was not sent: what the transport says, and whether there is no memory left for it.
fn not_sent(topic: Topic, error: &dyn Debug) -> BusError {
    let is_full = Session::shared_memory_is_full();
    let remedy = if is_full { "; /dev/shm is full, `cohabit doctor` tells more" } else { "" };
    BusError::Send { topic, reason: format!("{error:?}{remedy}") }
}

struct ShmSubscriber {
    topic: Topic,
    port: IoxSubscriber<Ipc, [Block], ()>,
    gaps: GapCounter,
}

impl SampleMemory for IoxSample<Ipc, [Block], ()> {
    fn blocks(&self) -> &[Block] {
        self.payload()
    }
}

impl Subscriber for ShmSubscriber {
    fn receive(&mut self) -> Result<Option<Sample>, BusError> {
        let received = self.port.receive();
        let received = received.map_err(|error| match error {
            ReceiveError::ExceedsMaxBorrows => holds_too_many(self.topic),
            other => BusError::Receive { topic: self.topic, reason: format!("{other:?}") },
        })?;
        let Some(memory) = received else { return Ok(None) };
        let sample = Sample::new(self.topic, Box::new(memory))?;
        self.gaps.saw(sample.envelope());
        Ok(Some(sample))
    }

    fn lost(&self) -> u64 {
        self.gaps.lost
    }
}

struct ShmListener {
    topic: Topic,
    bell: Bell,
    heard: u32,
}

impl Listener for ShmListener {
    fn wait(&mut self, timeout: Duration) -> Result<bool, BusError> {
        // A signal is for the caller to look after: it sees that nothing woke it.
        let slept = self.bell.sleep(self.heard, timeout);
        slept.map_err(|error| BusError::Receive { topic: self.topic, reason: error.to_string() })?;
        let rung = self.bell.rung();
        Ok(std::mem::replace(&mut self.heard, rung) != rung)
    }
}

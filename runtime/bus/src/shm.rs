//! The transport between processes: shared memory by iceoryx2.
//!
//! Every session has its own name prefix and root folder, so sessions never meet, and a supervisor can wipe all that
//! one left behind. All files are the user's own (0600).

use std::{sync::Arc, time::Duration};

use iceoryx2::{
    node::{Node, NodeBuilder},
    port::{
        listener::{Listener as IoxListener, ListenerWaitError},
        notifier::Notifier,
        publisher::Publisher as IoxPublisher,
        subscriber::Subscriber as IoxSubscriber,
        update_connections::UpdateConnections,
    },
    prelude::*,
    sample::Sample as IoxSample,
    service::port_factory::{PortFactory as _, publish_subscribe::PortFactory},
};

use crate::{
    envelope::{Block, Envelope},
    error::BusError,
    local::payload_bytes,
    session::Session,
    topic::{Topic, Wake},
    transport::{GapCounter, Listener, Publisher, Sample, SampleMemory, Subscriber, Transport, fill, new_run},
};

type Ipc = ipc_threadsafe::Service;

const MAX_PEERS: usize = 32;

/// The shared-memory transport of one session.
pub struct Shm {
    session: u64,
    node: Arc<Node<Ipc>>,
}

impl Shm {
    /// Joins `session`, whose supervisor must have prepared it.
    ///
    /// # Errors
    /// [`BusError::Join`].
    pub fn join(session: &Session) -> Result<Self, BusError> {
        set_log_level(LogLevel::Fatal);
        let failed = |reason: String| BusError::Join { session: session.name().to_owned(), reason };
        let folder = session.folder();
        if !folder.is_dir() {
            return Err(failed(
                "there is no such session here; start it with `cohabit play --session NAME`".to_owned(),
            ));
        }
        let mut config = Config::default();
        config.global.prefix = session.prefix().as_str().try_into().map_err(|e| failed(format!("{e:?}")))?;
        let root = folder.to_string_lossy();
        config.global.set_root_path(&Path::new(root.as_bytes()).map_err(|e| failed(format!("{root}: {e:?}")))?);
        let node = NodeBuilder::new()
            .config(&config)
            .signal_handling_mode(SignalHandlingMode::Disabled)
            .create::<Ipc>()
            .map_err(|e| failed(format!("{e:?}")))?;
        Ok(Self { session: session.number(), node: Arc::new(node) })
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
            .subscriber_max_borrowed_samples(8)
            .max_publishers(MAX_PEERS)
            .max_subscribers(MAX_PEERS)
            .max_nodes(MAX_PEERS)
            .open_or_create()
            .map_err(|e| failed(format!("{e:?}")))
    }

    fn wake_service(&self, wake: Wake) -> Result<iceoryx2::service::port_factory::event::PortFactory<Ipc>, String> {
        self.node
            .service_builder(&service_name(&wake.to_string())?)
            .event()
            .max_notifiers(4 * MAX_PEERS)
            .max_listeners(4 * MAX_PEERS)
            .max_nodes(MAX_PEERS)
            .open_or_create()
            .map_err(|e| format!("{e:?}"))
    }
}

fn service_name(name: &str) -> Result<ServiceName, String> {
    name.try_into().map_err(|e| format!("{e:?}"))
}

impl Transport for Shm {
    fn publisher(&self, topic: Topic) -> Result<Box<dyn Publisher>, BusError> {
        let failed = |reason: String| BusError::Open { topic, reason };
        let service = self.topic_service(topic)?;
        let port = service
            .publisher_builder()
            .initial_max_slice_len(1 + Block::count_for(topic.usual_bytes()))
            .allocation_strategy(AllocationStrategy::PowerOfTwo)
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|e| failed(format!("{e:?}")))?;
        let notifier = self
            .wake_service(topic.wake())
            .and_then(|service| service.notifier_builder().create().map_err(|e| format!("{e:?}")))
            .map_err(failed)?;
        let session = self.session;
        Ok(Box::new(ShmPublisher { topic, session, port, service, notifier, run: new_run(), sequence: 0 }))
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
            Wake::Talk => Topic::Dialog,
            Wake::State => Topic::State,
            Wake::Frames(camera) => Topic::Frames(camera),
        };
        let port = self
            .wake_service(wake)
            .and_then(|service| service.listener_builder().create().map_err(|e| format!("{e:?}")))
            .map_err(|reason| BusError::Open { topic, reason })?;
        Ok(Box::new(ShmListener { topic, port }))
    }
}

struct ShmPublisher {
    topic: Topic,
    session: u64,
    port: IoxPublisher<Ipc, [Block], ()>,
    service: PortFactory<Ipc, [Block], ()>,
    notifier: Notifier<Ipc>,
    run: u64,
    sequence: u64,
}

impl Publisher for ShmPublisher {
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError> {
        let failed = |reason: String| BusError::Send { topic: self.topic, reason };
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
        let sample = self.port.loan_slice_uninit(blocks).map_err(|e| failed(format!("{e:?}")))?;
        // SAFETY: a `Block` is plain bytes, of which all patterns are valid, in memory that the shared segment has
        // initialised (the kernel hands out zeroed pages).
        let mut sample = unsafe { sample.assume_init() };
        fill(sample.payload_mut(), envelope, write);
        sample.send().map_err(|e| failed(format!("{e:?}")))?;
        self.notifier.notify().map_err(|e| failed(format!("{e:?}")))?;
        self.sequence += 1;
        Ok(sequence)
    }

    fn subscribers(&self) -> usize {
        self.service.dynamic_config().number_of_subscribers()
    }

    fn update(&mut self) -> Result<(), BusError> {
        self.port.update_connections().map_err(|e| BusError::Send { topic: self.topic, reason: format!("{e:?}") })
    }
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
        let received = received.map_err(|e| BusError::Receive { topic: self.topic, reason: format!("{e:?}") })?;
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
    port: IoxListener<Ipc>,
}

impl Listener for ShmListener {
    fn wait(&mut self, timeout: Duration) -> Result<bool, BusError> {
        let mut woken = false;
        match self.port.timed_wait(|_| woken = true, timeout) {
            // A signal is for the caller to look after: it sees that nothing woke it.
            Ok(_) | Err(ListenerWaitError::InterruptSignal) => Ok(woken),
            Err(error) => Err(BusError::Receive { topic: self.topic, reason: format!("{error:?}") }),
        }
    }
}

//! iceoryx2 as it comes: its publish and subscribe, and its own events to wake subscribers.

use std::time::Duration;

use iceoryx2::node::{Node, NodeBuilder};
use iceoryx2::port::{listener::Listener, notifier::Notifier, publisher::Publisher, subscriber::Subscriber};
use iceoryx2::prelude::*;

use crate::board::Board;
use crate::case::Case;
use crate::work::{Failure, Inlet, Look, Outlet};

type Ipc = ipc::Service;

const LOOK_EVERY: Duration = Duration::from_millis(100);
/// As a topic of frames has it.
const DEPTH: usize = 2;

struct Services {
    _node: Node<Ipc>,
    messages: iceoryx2::service::port_factory::publish_subscribe::PortFactory<Ipc, [u8], ()>,
    wakes: iceoryx2::service::port_factory::event::PortFactory<Ipc>,
}

impl Services {
    fn open(case: &Case) -> Result<Self, Failure> {
        set_log_level(LogLevel::Fatal);
        let mut config = Config::default();
        // The prefix of the measurement's session, so that what is left is wiped with it.
        config.global.prefix = cohabit_bus::Session::new(case.name())?.prefix().as_str().try_into()?;
        config.global.set_root_path(&Path::new(case.folder.to_string_lossy().as_bytes())?);
        let mode = SignalHandlingMode::Disabled;
        let node = NodeBuilder::new().config(&config).signal_handling_mode(mode).create::<Ipc>()?;
        let messages = node.service_builder(&"messages".try_into()?).publish_subscribe::<[u8]>();
        let messages = messages
            .enable_safe_overflow(true)
            .subscriber_max_buffer_size(DEPTH)
            .max_subscribers(32)
            .max_nodes(32)
            .open_or_create()?;
        let wakes = node.service_builder(&"wakes".try_into()?).event();
        let wakes = wakes.max_listeners(32).max_nodes(32).open_or_create()?;
        Ok(Self { _node: node, messages, wakes })
    }
}

struct PlainOutlet {
    publisher: Publisher<Ipc, [u8], ()>,
    notifier: Notifier<Ipc>,
    bytes: usize,
    _services: Services,
}

impl Outlet for PlainOutlet {
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure> {
        let sample = self.publisher.loan_slice_uninit(self.bytes)?;
        // SAFETY: bytes, in memory that the shared segment has initialised.
        let mut sample = unsafe { sample.assume_init() };
        write(sample.payload_mut());
        sample.send()?;
        self.notifier.notify()?;
        Ok(())
    }
}

struct PlainInlet {
    subscriber: Subscriber<Ipc, [u8], ()>,
    listener: Listener<Ipc>,
    _services: Services,
}

impl Inlet for PlainInlet {
    fn listen(self: Box<Self>, mut look: Look, board: &'static Board) -> Result<(), Failure> {
        while !board.is_done() {
            self.listener.timed_wait(|_| (), LOOK_EVERY)?;
            while let Some(sample) = self.subscriber.receive()? {
                look(&[sample.payload()]);
            }
        }
        Ok(())
    }
}

/// A publisher.
pub fn outlet(case: &Case) -> Result<Box<dyn Outlet>, Failure> {
    let services = Services::open(case)?;
    let publisher = services.messages.publisher_builder().initial_max_slice_len(case.bytes).create()?;
    let notifier = services.wakes.notifier_builder().create()?;
    Ok(Box::new(PlainOutlet { publisher, notifier, bytes: case.bytes, _services: services }))
}

/// A subscriber.
pub fn inlet(case: &Case) -> Result<Box<dyn Inlet>, Failure> {
    let services = Services::open(case)?;
    let subscriber = services.messages.subscriber_builder().create()?;
    let listener = services.wakes.listener_builder().create()?;
    Ok(Box::new(PlainInlet { subscriber, listener, _services: services }))
}

//! zenoh between peers: over TCP, with or without its shared memory.

#[allow(dead_code, reason = "who starts this program uses the rest")]
#[path = "../../board.rs"]
mod board;
#[allow(dead_code, reason = "who starts this program uses the rest")]
#[path = "../../case.rs"]
mod case;
#[path = "../../work.rs"]
mod work;

use std::net::{Ipv4Addr, TcpListener};
use std::sync::Mutex;
use std::thread::sleep;
use std::time::Duration;

use board::Board;
use case::Case;
use work::{Failure, Inlet, Look, Outlet};
use zenoh::bytes::ZBytes;
use zenoh::pubsub::Publisher;
use zenoh::qos::CongestionControl;
use zenoh::shm::{BlockOn, GarbageCollect, PosixShmProviderBackend, ShmProvider, ShmProviderBuilder};
use zenoh::{Config, Session, Wait as _};

const KEY: &str = "cohabit/bench";
/// Messages that its shared memory has room for.
const ROOM: usize = 6;
/// Room beyond messages, for its own lists.
const SPARE: usize = 1 << 20;
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// How messages are to be carried.
const SHARED: &str = "zenoh-shm";

struct ZenohOutlet {
    /// Where messages lie that are shared.
    memory: Option<ShmProvider<PosixShmProviderBackend>>,
    publisher: Publisher<'static>,
    bytes: usize,
    _session: Session,
}

impl Outlet for ZenohOutlet {
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure> {
        let message: ZBytes = match &self.memory {
            Some(memory) => {
                let mut message = memory.alloc(self.bytes).with_policy::<BlockOn<GarbageCollect>>().wait()?;
                write(&mut message);
                message.into()
            }
            None => {
                // It keeps what it is given, so each message is a new one.
                let mut message = vec![1; self.bytes];
                write(&mut message);
                message.into()
            }
        };
        self.publisher.put(message).wait()
    }
}

struct ZenohInlet {
    session: Session,
}

impl Inlet for ZenohInlet {
    fn listen(self: Box<Self>, look: Look, board: &'static Board) -> Result<(), Failure> {
        let look = Mutex::new(look);
        let subscriber = self.session.declare_subscriber(KEY).callback(move |sample| {
            let parts: Vec<&[u8]> = sample.payload().slices().collect();
            if let Ok(mut look) = look.lock() {
                look(&parts);
            }
        });
        let _subscriber = subscriber.wait()?;
        while !board.is_done() {
            sleep(LOOK_EVERY);
        }
        Ok(())
    }
}

fn open(carrier: &str, role: &str, port: u16) -> Result<Session, Failure> {
    let shared = if carrier == SHARED { "true" } else { "false" };
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"peer\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("transport/shared_memory/enabled", shared),
        (role, &format!("[\"tcp/127.0.0.1:{port}\"]")),
    ] {
        config.insert_json5(key, value)?;
    }
    zenoh::open(config).wait()
}

fn outlet(carrier: &str, case: &Case, board: &Board) -> Result<Box<dyn Outlet>, Failure> {
    let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?.local_addr()?.port();
    let session = open(carrier, "listen/endpoints", port)?;
    let room = case.bytes * ROOM + SPARE;
    let memory = (carrier == SHARED)
        .then(|| {
            PosixShmProviderBackend::builder(room).wait().map(|backend| ShmProviderBuilder::backend(backend).wait())
        })
        .transpose()?;
    let publisher = session.declare_publisher(KEY).congestion_control(CongestionControl::Block).express(true).wait()?;
    board.set_port(port);
    Ok(Box::new(ZenohOutlet { memory, publisher, bytes: case.bytes, _session: session }))
}

fn inlet(carrier: &str, _: &Case, board: &Board) -> Result<Box<dyn Inlet>, Failure> {
    let port = loop {
        match board.port() {
            Some(port) => break port,
            None => sleep(Duration::from_millis(5)),
        }
    };
    Ok(Box::new(ZenohInlet { session: open(carrier, "connect/endpoints", port)? }))
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(2).collect();
    work::work(&arguments, outlet, inlet)
}

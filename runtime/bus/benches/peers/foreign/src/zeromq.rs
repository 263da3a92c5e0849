//! ZeroMQ's publish and subscribe sockets over its `ipc://` carrier.

#[allow(dead_code, reason = "who starts this program uses the rest")]
#[path = "../../board.rs"]
mod board;
#[allow(dead_code, reason = "who starts this program uses the rest")]
#[path = "../../case.rs"]
mod case;
#[path = "../../work.rs"]
mod work;

use board::Board;
use case::Case;
use work::{Failure, Inlet, Look, Outlet};

/// Milliseconds after which a subscriber looks whether it may end.
const LOOK_EVERY_MS: i32 = 100;

struct ZeroMqOutlet {
    socket: zmq::Socket,
    message: Vec<u8>,
}

impl Outlet for ZeroMqOutlet {
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure> {
        write(&mut self.message);
        Ok(self.socket.send(&self.message[..], 0)?)
    }
}

struct ZeroMqInlet {
    socket: zmq::Socket,
}

impl Inlet for ZeroMqInlet {
    fn listen(self: Box<Self>, mut look: Look, board: &'static Board) -> Result<(), Failure> {
        self.socket.set_rcvtimeo(LOOK_EVERY_MS)?;
        let mut message = zmq::Message::new();
        while !board.is_done() {
            match self.socket.recv(&mut message, 0) {
                Ok(()) => look(&[&message]),
                Err(zmq::Error::EAGAIN) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }
}

fn address(case: &Case) -> String {
    format!("ipc://{}", case.file("zeromq").display())
}

fn outlet(_: &str, case: &Case, _: &Board) -> Result<Box<dyn Outlet>, Failure> {
    let socket = zmq::Context::new().socket(zmq::PUB)?;
    socket.bind(&address(case))?;
    Ok(Box::new(ZeroMqOutlet { socket, message: vec![1; case.bytes] }))
}

fn inlet(_: &str, case: &Case, _: &Board) -> Result<Box<dyn Inlet>, Failure> {
    let socket = zmq::Context::new().socket(zmq::SUB)?;
    socket.set_subscribe(b"")?;
    socket.connect(&address(case))?;
    Ok(Box::new(ZeroMqInlet { socket }))
}

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(2).collect();
    work::work(&arguments, outlet, inlet)
}

//! This bus, through shared memory: what is sent is written where all subscribers read it.

use std::time::Duration;

use cohabit_bus::{CameraId, Listener, Publisher, Session, Shm, Subscriber, Topic, Transport as _};

use crate::board::Board;
use crate::case::Case;
use crate::work::{Failure, Inlet, Look, Outlet};

/// Messages up to this size go where commands go, others where a robot's frames go.
const SMALL: usize = 512;
const LOOK_EVERY: Duration = Duration::from_millis(100);

const fn topic(case: &Case) -> Topic {
    if case.bytes <= SMALL { Topic::Commands } else { Topic::Frames(CameraId::Egocentric(0)) }
}

struct OwnOutlet {
    publisher: Box<dyn Publisher>,
    bytes: usize,
}

impl Outlet for OwnOutlet {
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure> {
        self.publisher.send(0, self.bytes, write)?;
        Ok(())
    }
}

struct OwnInlet {
    subscriber: Box<dyn Subscriber>,
    listener: Box<dyn Listener>,
}

impl Inlet for OwnInlet {
    fn listen(mut self: Box<Self>, mut look: Look, board: &'static Board) -> Result<(), Failure> {
        while !board.is_done() {
            self.listener.wait(LOOK_EVERY)?;
            while let Some(sample) = self.subscriber.receive()? {
                look(&[sample.payload()]);
            }
        }
        Ok(())
    }
}

/// A publisher in the measurement's session.
pub fn outlet(case: &Case) -> Result<Box<dyn Outlet>, Failure> {
    let publisher = Shm::join(&Session::new(case.name())?)?.publisher(topic(case))?;
    Ok(Box::new(OwnOutlet { publisher, bytes: case.bytes }))
}

/// A subscriber in the measurement's session.
pub fn inlet(case: &Case) -> Result<Box<dyn Inlet>, Failure> {
    let bus = Shm::join(&Session::new(case.name())?)?;
    let (subscriber, listener) = (bus.subscriber(topic(case))?, bus.listener(topic(case).wake())?);
    Ok(Box::new(OwnInlet { subscriber, listener }))
}

//! How the processes of one session talk: `repr(C)` messages over a transport.
//!
//! Two transports stand behind one trait: [`Local`] inside a process and [`Shm`] through shared memory (iceoryx2).
//! A publisher writes straight into the sample that every subscriber then reads; nothing is copied on the way.
//!
//! This crate never knows the world's rules, JSON, or who its peers are. A slow subscriber loses the oldest samples
//! and is told how many ([`Subscriber::lost`]); it never slows a publisher. Only the user who started a session can
//! attach to it.
//!
//! ```
//! use cohabit_bus::{Local, Topic, Transport};
//! let bus = Local::new(1);
//! let mut reader = bus.subscriber(Topic::Events)?;
//! let mut writer = bus.publisher(Topic::Events)?;
//! writer.send(7, 3, &mut |bytes| bytes.copy_from_slice(b"hey"))?;
//! let sample = reader.receive()?.expect("one sample");
//! assert_eq!((sample.envelope().tick, sample.payload()), (7, &b"hey"[..]));
//! # Ok::<(), cohabit_bus::BusError>(())
//! ```

mod bell;
mod camera;
mod envelope;
mod error;
mod heart;
mod inbox;
mod local;
pub mod message;
mod priority;
mod private;
mod session;
mod shm;
mod text;
mod topic;
mod transport;

pub use camera::{CameraId, CameraName, CameraNameError};
pub use envelope::{Block, Envelope, monotonic_nanos, wall_nanos};
pub use error::BusError;
pub use heart::Heart;
pub use inbox::{Inbox, Nonsense, Pauses};
pub use local::Local;
pub use priority::{Urgency, give_way, go_first};
pub use private::AccessError;
pub use session::{Remains, Session, SessionError};
pub use shm::{HeldTopics, Shm};
pub use text::Text;
pub use topic::{Topic, Wake};
pub use transport::{Listener, Publisher, Sample, Subscriber, Transport, is_alive, process_of};

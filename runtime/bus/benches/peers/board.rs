//! Counters that all processes of a measurement share: who has seen what. They time nothing.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::SeqCst};
use std::time::{Duration, Instant};

use rustix::mm::{MapFlags, ProtFlags, mmap};
use rustix::thread::futex;
use rustix::time::Timespec;

/// The most subscribers.
pub const MOST: usize = 32;

/// What lies in the file.
#[repr(C)]
pub struct Board {
    /// 1 once the subscribers may end.
    done: AtomicU32,
    /// The port that the sender listens on, where it does.
    port: AtomicU32,
    /// 1 while the sender sleeps until a message is seen by all.
    sleeping: AtomicU32,
    /// Counts what woke it.
    bell: AtomicU32,
    /// The latest message that each subscriber has seen.
    seen: [AtomicU64; MOST],
}

impl Board {
    /// Makes the file.
    pub fn create(path: &Path) -> io::Result<()> {
        File::create_new(path)?.set_len(size_of::<Self>() as u64)
    }

    /// The board in a file, for as long as this process lives.
    pub fn open(path: &Path) -> io::Result<&'static Self> {
        let file = File::options().read(true).write(true).open(path)?;
        let (access, length) = (ProtFlags::READ | ProtFlags::WRITE, size_of::<Self>());
        // SAFETY: a new mapping, which is never taken back; atomics of zero bytes are valid, and the file is as long.
        unsafe {
            let memory = mmap(std::ptr::null_mut(), length, access, MapFlags::SHARED, &file, 0)?;
            Ok(&*memory.cast::<Self>())
        }
    }

    /// Lets the subscribers end.
    pub fn end(&self) {
        self.done.store(1, SeqCst);
    }

    /// Whether they may.
    pub fn is_done(&self) -> bool {
        self.done.load(SeqCst) == 1
    }

    /// Tells the sender's port.
    pub fn set_port(&self, port: u16) {
        self.port.store(port.into(), SeqCst);
    }

    /// The sender's port, once it is told.
    pub fn port(&self) -> Option<u16> {
        u16::try_from(self.port.load(SeqCst)).ok().filter(|port| *port != 0)
    }

    /// A subscriber has seen a message.
    pub fn saw(&self, subscriber: usize, sequence: u64) {
        self.seen[subscriber].store(sequence, SeqCst);
        if self.sleeping.load(SeqCst) == 1 {
            self.bell.fetch_add(1, SeqCst);
            let _ = futex::wake(&self.bell, futex::Flags::empty(), 1);
        }
    }

    /// Whether that many subscribers have seen a message.
    pub fn all_saw(&self, subscribers: usize, sequence: u64) -> bool {
        self.seen[..subscribers].iter().all(|seen| seen.load(SeqCst) >= sequence)
    }

    /// Sleeps until they have; false if they have not within `longest`.
    pub fn wait_until_all_saw(&self, subscribers: usize, sequence: u64, longest: Duration) -> bool {
        let deadline = Instant::now() + longest;
        self.sleeping.store(1, SeqCst);
        let seen = loop {
            let bell = self.bell.load(SeqCst);
            if self.all_saw(subscribers, sequence) {
                break true;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break false;
            }
            let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: left.subsec_nanos().into() };
            let _ = futex::wait(&self.bell, futex::Flags::empty(), bell, Some(&left));
        };
        self.sleeping.store(0, SeqCst);
        seen
    }
}

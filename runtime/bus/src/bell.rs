//! What processes sleep on: a count in shared memory, and the kernel's queue of those that wait for it to change.
//!
//! Ringing is one system call however many sleep, and none when nobody does. A process that is killed in its sleep
//! leaves the count of sleepers one too high, which costs later ringers that one call and nothing else.

use std::{
    fs::File,
    io,
    path::Path,
    ptr::{NonNull, null_mut},
    sync::atomic::{AtomicU32, Ordering::SeqCst},
    time::{Duration, Instant},
};

use rustix::{
    fs::{FallocateFlags, fallocate},
    io::Errno,
    mm::{MapFlags, ProtFlags, mmap, munmap},
    thread::futex,
    time::Timespec,
};

use crate::private::{self, AccessError};

/// A bell that any process with the same file can ring and hear.
#[derive(Debug)]
pub(crate) struct Bell {
    memory: NonNull<Strokes>,
}

/// What lies in the file of a group's wake-ups, `/dev/shm/cohabit_<user>_<session>_wake.<group>`: who has sent adds one
/// to `rung` and wakes all that wait for it to change (`FUTEX_WAKE`); who sleeps counts among `sleepers` meanwhile.
#[derive(Debug)]
#[repr(C)]
struct Strokes {
    /// How often it was rung, wrapping.
    rung: AtomicU32,
    /// How many sleep, at least.
    sleepers: AtomicU32,
}

// SAFETY: the memory belongs to this mapping until it is dropped, and holds atomics alone.
unsafe impl Send for Bell {}
// SAFETY: as above.
unsafe impl Sync for Bell {}

impl Bell {
    /// The bell of this file; makes the file, for this user alone, if nobody has.
    pub(crate) fn open(path: &Path) -> Result<Self, AccessError> {
        let file = private::open_or_create(path)?;
        Self::map(&file).map_err(|source| AccessError::System { path: path.to_owned(), source })
    }

    fn map(file: &File) -> io::Result<Self> {
        // Room is had now, or an error: a full file system would otherwise kill who writes.
        fallocate(file, FallocateFlags::empty(), 0, size_of::<Strokes>() as u64)?;
        let access = ProtFlags::READ | ProtFlags::WRITE;
        // SAFETY: a new mapping of a file that is as long as what it is taken for, of which all bit patterns are valid.
        let memory = unsafe { mmap(null_mut(), size_of::<Strokes>(), access, MapFlags::SHARED, file, 0)? };
        let memory = NonNull::new(memory.cast()).ok_or(io::ErrorKind::OutOfMemory)?;
        Ok(Self { memory })
    }

    fn strokes(&self) -> &Strokes {
        // SAFETY: mapped for as long as `self` lives, and shared by atomics alone.
        unsafe { self.memory.as_ref() }
    }

    /// Wakes all who sleep.
    pub(crate) fn ring(&self) {
        let strokes = self.strokes();
        strokes.rung.fetch_add(1, SeqCst);
        if strokes.sleepers.load(SeqCst) > 0 {
            // It fails for no address of ours.
            let _ = futex::wake(&strokes.rung, futex::Flags::empty(), i32::MAX.unsigned_abs());
        }
    }

    /// How often it was rung.
    pub(crate) fn rung(&self) -> u32 {
        self.strokes().rung.load(SeqCst)
    }

    /// Sleeps until it was rung another number of times than `heard`, at most for `timeout`, and not beyond a signal.
    pub(crate) fn sleep(&self, heard: u32, timeout: Duration) -> io::Result<()> {
        let deadline = Instant::now().checked_add(timeout);
        let strokes = self.strokes();
        strokes.sleepers.fetch_add(1, SeqCst);
        let slept = loop {
            if strokes.rung.load(SeqCst) != heard {
                break Ok(());
            }
            let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
            if left.is_some_and(|left| left.is_zero()) {
                break Ok(());
            }
            // Longer than can be said is for ever.
            let left = left.and_then(|left| Timespec::try_from(left).ok());
            match futex::wait(&strokes.rung, futex::Flags::empty(), heard, left.as_ref()) {
                Ok(()) | Err(Errno::AGAIN | Errno::TIMEDOUT) => {}
                Err(Errno::INTR) => break Ok(()),
                Err(error) => break Err(error.into()),
            }
        };
        strokes.sleepers.fetch_sub(1, SeqCst);
        slept
    }
}

impl Drop for Bell {
    fn drop(&mut self) {
        // SAFETY: it was mapped with this length, and nothing refers to it any more.
        let _ = unsafe { munmap(self.memory.as_ptr().cast(), size_of::<Strokes>()) };
    }
}

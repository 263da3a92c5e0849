//! Somebody who looks on at a session, and remembers what its simulator published.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use anyhow::{Context as _, ensure};
use cohabit_bus::{Inbox, Sample, Session, Shm, Topic, Transport as _, Wake, message::TickView};

/// The longest that a tick is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// Ticks as they were published: number, and wall time (ns since 1970).
type Ticks = Arc<Mutex<Vec<(u64, u64)>>>;

/// Looks on until dropped.
pub struct Witness {
    ticks: Ticks,
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<anyhow::Result<()>>>,
}

impl Witness {
    /// Somebody who looks on at that session, which must be there.
    pub fn new(session: &str) -> anyhow::Result<Self> {
        let bus = Shm::join(&Session::new(session)?)?;
        let mut inbox = Inbox::new(&bus, Topic::Ticks)?;
        let mut listener = bus.listener(Wake::State)?;
        let (ticks, over) = (Ticks::default(), Arc::<AtomicBool>::default());
        let (seen, is_over) = (Arc::clone(&ticks), Arc::clone(&over));
        let thread = thread::spawn(move || {
            let _bus = bus;
            while !is_over.load(Ordering::Relaxed) {
                listener.wait(Duration::from_millis(20))?;
                let read = |sample: &Sample| Ok(TickView::new(sample.payload())?.header.wall_nanos);
                while let Some((sample, wall_nanos)) = inbox.next(read)? {
                    seen.lock().unwrap().push((sample.envelope().tick, wall_nanos));
                }
            }
            Ok(())
        });
        Ok(Self { ticks, over, thread: Some(thread) })
    }

    /// When the first tick after this one began, ns since 1970.
    pub fn wall_of_first_after(&self, tick: u64) -> Option<u64> {
        let ticks = self.ticks.lock().unwrap();
        ticks.iter().find(|(number, _)| *number > tick).map(|(_, wall)| *wall)
    }

    /// The newest tick so far; 0 before the first.
    pub fn newest(&self) -> u64 {
        self.ticks.lock().unwrap().last().map_or(0, |(tick, _)| *tick)
    }

    /// Waits for a tick.
    pub fn wait_for(&self, tick: u64) -> anyhow::Result<()> {
        let deadline = Instant::now() + WATCHDOG;
        while self.newest() < tick {
            ensure!(Instant::now() < deadline, "tick {tick} does not come");
            thread::park_timeout(Duration::from_millis(5));
        }
        Ok(())
    }

    /// Ends, and gives the newest tick of all.
    pub fn end(mut self) -> anyhow::Result<u64> {
        self.over.store(true, Ordering::Relaxed);
        let thread = self.thread.take().context("a thread")?;
        thread.join().expect("it does not panic")?;
        Ok(self.newest())
    }
}

impl Drop for Witness {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

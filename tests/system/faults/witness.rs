//! Somebody who looks on at a session, and remembers what its simulator published.

use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use anyhow::Context as _;
use cohabit_bus::{Session, Shm, Topic, Transport as _, Wake, message::TickView};

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
        let mut subscriber = bus.subscriber(Topic::Ticks)?;
        let mut listener = bus.listener(Wake::State)?;
        let (ticks, over) = (Ticks::default(), Arc::<AtomicBool>::default());
        let (seen, is_over) = (Arc::clone(&ticks), Arc::clone(&over));
        let thread = thread::spawn(move || {
            let _bus = bus;
            while !is_over.load(Ordering::Relaxed) {
                listener.wait(Duration::from_millis(20))?;
                while let Some(sample) = subscriber.receive()? {
                    let view = TickView::new(sample.payload())?;
                    seen.lock().unwrap().push((sample.envelope().tick, view.header.wall_nanos));
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

    /// Ends, and gives the newest tick of all.
    pub fn end(mut self) -> anyhow::Result<u64> {
        self.over.store(true, Ordering::Relaxed);
        let thread = self.thread.take().context("a thread")?;
        thread.join().expect("it does not panic")?;
        let ticks = self.ticks.lock().unwrap();
        Ok(ticks.last().map_or(0, |(tick, _)| *tick))
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

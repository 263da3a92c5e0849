//! What an ear tells later than it could, for studies: in the order in which it was heard, while the ear listens on.

use std::{
    collections::VecDeque,
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::monotonic_nanos;
use tokio::sync::mpsc::UnboundedSender;

use super::FromEar;

/// Tells the visit of a page what was heard there.
pub struct Late {
    to: UnboundedSender<FromEar>,
    delay: Duration,
    /// What waits, and until when.
    waiting: VecDeque<(Instant, FromEar)>,
}

impl Late {
    /// What somebody says is told so much later than it could be.
    pub fn new(to: UnboundedSender<FromEar>, delay: Duration) -> Self {
        Self { to, delay, waiting: VecDeque::new() }
    }

    /// Tells something, after all that was heard before it.
    pub fn tell(&mut self, told: FromEar) {
        let is_later = matches!(told, FromEar::Said(_));
        let due = Instant::now() + if is_later { self.delay } else { Duration::ZERO };
        let due = self.waiting.back().map_or(due, |(last, _)| due.max(*last));
        self.waiting.push_back((due, told));
        self.tell_due();
    }

    /// Forgets what waits: somebody says stop.
    pub fn forget(&mut self) {
        self.waiting.clear();
    }

    /// How long it is until something is to be told.
    pub fn pause(&self) -> Duration {
        self.waiting.front().map_or(Duration::MAX, |(due, _)| due.saturating_duration_since(Instant::now()))
    }

    /// Tells what has waited long enough.
    pub fn tell_due(&mut self) {
        while self.pause().is_zero()
            && let Some((_, mut told)) = self.waiting.pop_front()
        {
            if let FromEar::Said(spoken) = &mut told {
                spoken.text_nanos = monotonic_nanos();
            }
            // A page that is gone need not be told.
            let _ = self.to.send(told);
        }
    }

    /// Tells the rest, each in its time, as long as there is somebody to tell.
    pub fn tell_rest(&mut self) {
        while !self.waiting.is_empty() && !self.to.is_closed() {
            thread::sleep(self.pause());
            self.tell_due();
        }
    }
}

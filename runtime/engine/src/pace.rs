//! Real time: when the next tick is due.

use std::{
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::message::Control;
use cohabit_world::DT_NANOS;

const TICK: Duration = Duration::from_nanos(DT_NANOS);
const MOST_MADE_UP: Duration = Duration::from_millis(250);

/// Keeps ticks at their times. A tick that comes late is made up for, up to a limit; beyond it time is lost, and said.
pub(crate) struct Pace {
    next: Instant,
    speed: f32,
    stands: bool,
    /// Ticks that go by though it stands.
    steps: u32,
}

impl Pace {
    /// A pace so many times as fast as real time, which perhaps stands still at first.
    pub fn new(speed: f32, paused: bool) -> Self {
        Self { next: Instant::now(), speed, stands: paused, steps: 0 }
    }

    /// Whether the world stands still now.
    pub const fn is_paused(&self) -> bool {
        self.stands && self.steps == 0
    }

    /// Does as it is asked; gives a sentence about it.
    pub fn obey(&mut self, control: Control) -> String {
        if self.is_paused() {
            self.next = Instant::now();
        }
        match control {
            Control::Pause => (self.stands, self.steps) = (true, 0),
            Control::Resume => (self.stands, self.steps) = (false, 0),
            Control::Step(ticks) => (self.stands, self.steps) = (true, ticks),
            Control::Speed(speed) => self.speed = speed,
            // What is played live is where it is.
            Control::Seek(_) => {}
        }
        match control {
            Control::Pause => "paused".to_owned(),
            Control::Resume => "going on".to_owned(),
            Control::Step(1) => "one tick".to_owned(),
            Control::Step(ticks) => format!("{ticks} ticks"),
            Control::Speed(speed) => format!("{speed} times real time"),
            Control::Seek(_) => "only a recorded session goes elsewhere".to_owned(),
        }
    }

    /// A tick went by; says whether the world stands still after it, which it did not before.
    pub fn count(&mut self) -> bool {
        let stepped = self.steps > 0;
        self.steps = self.steps.saturating_sub(1);
        stepped && self.steps == 0
    }

    /// How late it is for the tick that is due.
    pub fn late(&self) -> Duration {
        Instant::now().saturating_duration_since(self.next)
    }

    /// Sleeps until the next tick is due.
    pub fn wait(&mut self) {
        self.next += TICK.div_f32(self.speed);
        let now = Instant::now();
        if let Some(early) = self.next.checked_duration_since(now) {
            thread::sleep(early);
        } else if now - self.next > MOST_MADE_UP {
            let dropped = (now - self.next).as_millis();
            tracing::warn!("the machine is too slow: {dropped} ms of simulated time were dropped");
            self.next = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stands_goes_and_steps() {
        let mut pace = Pace::new(1.0, true);
        assert!(pace.is_paused());
        pace.obey(Control::Step(2));
        assert!(!pace.is_paused() && !pace.count() && !pace.is_paused());
        assert!(pace.count() && pace.is_paused());
        pace.obey(Control::Resume);
        assert!(!pace.is_paused() && !pace.count());
        pace.obey(Control::Pause);
        pace.obey(Control::Speed(2.0));
        assert!(pace.is_paused());
    }
}

//! How well a session runs, as its bus tells: whether its ticks begin in time, and how long its newest turn took.

use std::collections::VecDeque;

use cohabit_study::Health;
use cohabit_world::DT_NANOS;

/// How far back ticks count, ns.
const REACH_NANOS: u64 = 10_000_000_000;

/// What was heard of a session.
#[derive(Debug, Default)]
pub struct HealthWatch {
    /// When each tick of the last seconds began, ns since 1970, and whether that was a whole tick too late.
    ticks: VecDeque<(u64, bool)>,
    answered_ms: Option<f64>,
    moved_ms: Option<f64>,
}

impl HealthWatch {
    /// A tick began then, so much too late.
    pub fn note_tick(&mut self, wall_nanos: u64, late_nanos: u64) {
        self.ticks.push_back((wall_nanos, late_nanos >= DT_NANOS));
        let is_old = |tick: &(u64, bool)| tick.0.saturating_add(REACH_NANOS) < wall_nanos;
        while self.ticks.front().is_some_and(is_old) {
            self.ticks.pop_front();
        }
    }

    /// The moments of the newest turn: received, understood, first motion, and more.
    pub fn note_turn(&mut self, [received, understood, moved, ..]: [u64; 5]) {
        let after = |moment: u64| (moment != 0).then(|| moment.saturating_sub(received) as f64 * 1e-6);
        (self.answered_ms, self.moved_ms) = (after(understood), after(moved));
    }

    /// How it runs.
    pub fn health(&self) -> Health {
        let late = self.ticks.iter().filter(|(_, is_late)| *is_late).count();
        let missed = (!self.ticks.is_empty()).then(|| late as f64 / self.ticks.len() as f64);
        Health { missed, answered_ms: self.answered_ms, moved_ms: self.moved_ms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_the_last_seconds_and_the_newest_turn_count() {
        let mut watch = HealthWatch::default();
        assert_eq!(watch.health(), Health::default());
        for tick in 0..4 {
            watch.note_tick(tick * DT_NANOS, if tick == 0 { DT_NANOS } else { 5 });
        }
        watch.note_turn([7_000_000, 9_000_000, 0, 0, 0]);
        assert_eq!(watch.health(), Health { missed: Some(0.25), answered_ms: Some(2.0), moved_ms: None });
        watch.note_tick(REACH_NANOS + 1, 0);
        assert_eq!(watch.health().missed, Some(0.0), "the first one was long ago");
    }
}

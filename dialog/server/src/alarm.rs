//! Wakes a thread when something is due.

use std::{
    sync::{Condvar, Mutex, PoisonError},
    time::{Duration, Instant},
};

use cohabit_bus::monotonic_nanos;

/// When something is due next, if anything is: ns of the monotonic clock.
#[derive(Default)]
pub struct Alarm {
    due: Mutex<Option<u64>>,
    changed: Condvar,
}

impl Alarm {
    /// Something is due then, and nothing sooner.
    pub fn set(&self, due: Option<u64>) {
        let mut set = self.due.lock().unwrap_or_else(PoisonError::into_inner);
        if *set != due {
            *set = due;
            self.changed.notify_all();
        }
    }

    /// Waits until something is due, at most so long; whether it is.
    pub fn wait(&self, most: Duration) -> bool {
        let until = Instant::now() + most;
        let mut set = self.due.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let rest = set.map(|due| Duration::from_nanos(due.saturating_sub(monotonic_nanos())));
            if rest.is_some_and(|rest| rest.is_zero()) {
                return true;
            }
            if left.is_zero() {
                return false;
            }
            let pause = rest.map_or(left, |rest| rest.min(left));
            set = self.changed.wait_timeout(set, pause).unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_waits_for_what_is_due_and_for_nothing_else() {
        let alarm = Alarm::default();
        assert!(!alarm.wait(Duration::from_millis(1)));
        alarm.set(Some(monotonic_nanos() + 3_600_000_000_000));
        assert!(!alarm.wait(Duration::from_millis(1)));
        std::thread::scope(|scope| {
            let waits = scope.spawn(|| alarm.wait(Duration::from_secs(3600)));
            alarm.set(Some(monotonic_nanos()));
            assert!(waits.join().is_ok_and(|is_due| is_due));
        });
    }
}

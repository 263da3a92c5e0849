//! What one page may send.

use std::time::Instant;

/// The longest sentence taken, in bytes.
pub const LONGEST_TEXT: usize = 2000;
/// The longest message read from a page at all, in bytes.
pub const LONGEST_MESSAGE: usize = 64 << 10;
/// Pages open at once.
pub const MOST_PAGES: usize = 16;
/// Messages a second, with as many in hand at first.
const PER_SECOND: f64 = 10.0;

/// Lets so many messages a second through.
pub struct Throttle {
    in_hand: f64,
    at: Instant,
}

impl Throttle {
    /// A throttle that has let nothing through yet.
    pub fn new(now: Instant) -> Self {
        Self { in_hand: PER_SECOND, at: now }
    }

    /// Whether one more message may pass now.
    pub fn admits(&mut self, now: Instant) -> bool {
        let since = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.in_hand = (self.in_hand + since * PER_SECOND).min(PER_SECOND);
        let admitted = self.in_hand >= 1.0;
        if admitted {
            self.in_hand -= 1.0;
        }
        admitted
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn ten_a_second_pass() {
        let start = Instant::now();
        let mut throttle = Throttle::new(start);
        assert_eq!((0..30).filter(|_| throttle.admits(start)).count(), 10);
        assert!(throttle.admits(start + Duration::from_millis(150)));
        assert!(!throttle.admits(start + Duration::from_millis(160)));
    }
}

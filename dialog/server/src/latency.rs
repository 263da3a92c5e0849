//! How long a turn takes: received, understood, first motion, first changed frame, shown by a page.

/// The five moments of a turn, ns of the monotonic clock; 0 where it has not happened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// The turn.
    pub turn: u64,
    /// Text received.
    pub received: u64,
    /// Plan sent.
    pub understood: u64,
    /// First command taken up by the world.
    pub moved: u64,
    /// First frame in which that shows.
    pub shown: u64,
    /// That frame, or a later one, shown by a page.
    pub drawn: u64,
}

impl Moments {
    /// Milliseconds from the text to understanding, first motion, first changed frame.
    pub fn milliseconds(&self) -> [Option<f64>; 3] {
        let after = |moment: u64| (moment != 0).then(|| moment.saturating_sub(self.received) as f64 * 1e-6);
        [after(self.understood), after(self.moved), after(self.shown)]
    }

    /// As in a dialog message.
    pub const fn stamps(&self) -> [u64; 5] {
        [self.received, self.understood, self.moved, self.shown, self.drawn]
    }
}

/// Follows the newest turn.
#[derive(Debug, Default)]
pub struct Latency {
    now: Moments,
    first_command: u64,
}

impl Latency {
    /// A turn was received and understood.
    pub fn begin(&mut self, turn: u64, received: u64, understood: u64) {
        self.now = Moments { turn, received, understood, ..Moments::default() };
        self.first_command = 0;
    }

    /// The world took up a command of `turn`. Gives the moments if that is news.
    pub fn moved(&mut self, turn: u64, command: u64, nanos: u64) -> Option<Moments> {
        // What belongs to no turn, such as a person's own steps, has turn 0.
        if turn == 0 || turn != self.now.turn || self.now.moved != 0 {
            return None;
        }
        self.now.moved = nanos;
        self.first_command = command;
        Some(self.now)
    }

    /// A frame was sent that shows the world after `command` began. Gives the moments if that is news.
    pub fn shown(&mut self, command: u64, nanos: u64) -> Option<Moments> {
        let first = self.first_command != 0 && command == self.first_command && self.now.shown == 0;
        if !first {
            return None;
        }
        self.now.shown = nanos;
        Some(self.now)
    }

    /// A page has shown the first changed frame of `turn`. Gives the moments if that is news.
    pub fn drawn(&mut self, turn: u64, nanos: u64) -> Option<Moments> {
        let first = turn == self.now.turn && self.now.shown != 0 && self.now.drawn == 0;
        if !first {
            return None;
        }
        self.now.drawn = nanos;
        Some(self.now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_come_once_and_in_order() {
        let mut latency = Latency::default();
        latency.begin(3, 1_000_000, 2_000_000);
        assert_eq!(latency.shown(7, 1), None, "no command of the turn yet");
        assert_eq!(latency.moved(2, 6, 1), None, "another turn");
        assert_eq!(Latency::default().moved(0, 6, 1), None, "no turn");
        assert!(latency.moved(3, 7, 3_000_000).is_some());
        assert_eq!(latency.moved(3, 8, 9), None, "only the first");
        let moments = latency.shown(7, 5_000_000).unwrap();
        assert_eq!(moments.milliseconds(), [Some(1.0), Some(2.0), Some(4.0)]);
        assert_eq!(latency.shown(7, 6_000_000), None);
        assert_eq!(latency.drawn(2, 6_000_000), None, "another turn");
        assert_eq!(
            latency.drawn(3, 6_000_000).unwrap().stamps(),
            [1_000_000, 2_000_000, 3_000_000, 5_000_000, 6_000_000]
        );
        assert_eq!(latency.drawn(3, 7_000_000), None);
    }
}

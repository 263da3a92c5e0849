//! How long a turn takes: received, understood, first motion, first changed frame, shown by a page.

/// The five moments of a turn, ns of the monotonic clock; 0 where it has not happened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// The turn.
    pub turn: u64,
    /// Somebody began to say it, was done, and what it was was there.
    pub speech: [u64; 3],
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
    /// The answer is heard at a page.
    pub sounded: u64,
}

impl Moments {
    /// Milliseconds from the text to understanding, first motion, first changed frame.
    pub fn milliseconds(&self) -> [Option<f64>; 3] {
        let after = |moment: u64| (moment != 0).then(|| moment.saturating_sub(self.received) as f64 * 1e-6);
        [after(self.understood), after(self.moved), after(self.shown)]
    }

    /// Milliseconds from the end of speech to its text, and from the text to the first sound of the answer.
    pub fn spoken_milliseconds(&self) -> [Option<f64>; 2] {
        let between = |from: u64, to: u64| (from != 0 && to != 0).then(|| to.saturating_sub(from) as f64 * 1e-6);
        [between(self.speech[1], self.speech[2]), between(self.received, self.sounded)]
    }

    /// As in a dialog message about what was spoken.
    pub const fn spoken_stamps(&self) -> [u64; 5] {
        let [began, ended, text] = self.speech;
        [began, ended, if text == 0 { self.received } else { text }, self.understood, self.sounded]
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
    /// The tick at which the world took up the first command of the newest turn.
    moved_tick: Option<u64>,
    /// What the newest turn sounded like.
    pub heard: String,
}

impl Latency {
    /// A turn was received and understood.
    pub fn begin(&mut self, turn: u64, received: u64, understood: u64) {
        self.now = Moments { turn, received, understood, ..Moments::default() };
        self.moved_tick = None;
        self.heard.clear();
    }

    /// A turn that was held back is answered now: it is the newest, if it was not.
    pub fn answered(&mut self, turn: u64, received: u64, now: u64) {
        if turn == self.now.turn {
            self.now.understood = now;
        } else {
            self.begin(turn, received, now);
        }
    }

    /// The newest turn was spoken, from when until when, its text was there then, and it sounded like this.
    pub fn spoken(&mut self, speech: [u64; 3], heard: &str) -> Moments {
        self.now.speech = speech;
        heard.clone_into(&mut self.heard);
        self.now
    }

    /// The answer to `turn` is heard at a page. Gives the moments if that is news.
    pub fn sounded(&mut self, turn: u64, nanos: u64) -> Option<Moments> {
        let first = turn != 0 && turn == self.now.turn && self.now.sounded == 0;
        if !first {
            return None;
        }
        self.now.sounded = nanos;
        Some(self.now)
    }

    /// The world took up a command of `turn` at that tick. Gives the moments if that is news.
    pub fn moved(&mut self, turn: u64, tick: u64, nanos: u64) -> Option<Moments> {
        // What belongs to no turn, such as a person's own steps, has turn 0.
        if turn == 0 || turn != self.now.turn || self.now.moved != 0 {
            return None;
        }
        self.now.moved = nanos;
        self.moved_tick = Some(tick);
        Some(self.now)
    }

    /// A frame was sent that shows the world as it was at that tick. Gives the moments if that is news.
    pub fn shown(&mut self, tick: u64, nanos: u64) -> Option<Moments> {
        let first = self.moved_tick.is_some_and(|moved| tick >= moved) && self.now.shown == 0;
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

    /// By then the body, or another one, may have begun something else.
    #[test]
    fn the_first_frame_since_then_shows_the_motion_whatever_began_meanwhile() {
        let mut latency = Latency::default();
        latency.begin(3, 1_000_000, 2_000_000);
        assert!(latency.moved(3, 60, 3_000_000).is_some());
        assert_eq!(latency.shown(59, 4_000_000), None, "it was seen before");
        assert_eq!(latency.shown(62, 5_000_000).map(|moments| moments.shown), Some(5_000_000));
        assert_eq!(latency.shown(63, 6_000_000), None, "only the first");
    }

    #[test]
    fn what_is_held_back_is_understood_when_it_is_answered() {
        let mut latency = Latency::default();
        latency.begin(3, 1_000_000, 2_000_000);
        latency.spoken([400_000, 500_000, 600_000], "go");
        latency.answered(3, 1_000_000, 9_000_000);
        assert_eq!(
            (latency.now.understood, latency.now.speech, latency.heard.as_str()),
            (9_000_000, [400_000, 500_000, 600_000], "go")
        );
        latency.answered(5, 4_000_000, 9_000_000);
        assert_eq!((latency.now.turn, latency.now.received), (5, 4_000_000));
    }

    #[test]
    fn a_spoken_turn_has_its_own_chain() {
        let mut latency = Latency::default();
        latency.begin(3, 5_000_000, 6_000_000);
        assert_eq!(latency.spoken([1_000_000, 3_000_000, 4_000_000], "go").spoken_milliseconds(), [Some(1.0), None]);
        assert_eq!(latency.sounded(2, 9_000_000), None, "another turn");
        let moments = latency.sounded(3, 8_000_000).unwrap();
        assert_eq!(moments.spoken_stamps(), [1_000_000, 3_000_000, 4_000_000, 6_000_000, 8_000_000]);
        assert_eq!(moments.spoken_milliseconds(), [Some(1.0), Some(3.0)]);
        assert_eq!(latency.sounded(3, 9_000_000), None);
        latency.begin(4, 9_000_000, 9_000_000);
        assert_eq!((latency.heard.as_str(), latency.now.speech), ("", [0, 0, 0]));
    }
}

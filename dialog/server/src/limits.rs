//! What one page may send, and how long and how often anybody may keep a place of the server.

use std::time::{Duration, Instant};

pub use cohabit_bus::message::LONGEST_TEXT_CHARS;

/// The longest message read from a page at all, in bytes: a questionnaire of a hundred questions, each answered by the
/// longest text in the script that takes most bytes.
pub const LONGEST_MESSAGE: usize = 1 << 20;
/// Messages of any kind a second: all that are looked at.
const ALL_PER_SECOND: f64 = 40.0;
/// Held keys a second: a page tells them again nine times a second, and at every change.
const DRIVES_PER_SECOND: f64 = 20.0;
/// Pieces of sound a second: a page sends 32, and more after a moment in which it could not.
const SOUNDS_PER_SECOND: f64 = 120.0;
/// Pieces of sound at once: what was said while the network was gone for as long as a page may be silent
/// ([`ServerLimits::silence`]) comes in a moment.
const SOUNDS_AT_ONCE: f64 = 500.0;
/// Times a second that a page tells what is being typed: where somebody pauses.
const DRAFTS_PER_SECOND: f64 = 4.0;
/// All other messages a second.
const OTHERS_PER_SECOND: f64 = 10.0;

/// What somebody is told who sends more than is taken.
pub const A_LOT: &str = "That was a lot at once; wait a moment, please.";

/// How long anybody may keep a place of the page's server, and how many places there are. Tests take shorter times.
#[derive(Clone, Copy, Debug)]
pub struct ServerLimits {
    /// The longest that a client may take to send the head of a request, from the moment it connected or was last
    /// answered. A browser sends it in one packet; Apache and nginx allow 20 to 60 s.
    pub head: Duration,
    /// The longest that a client may take to agree on keys: four packets.
    pub handshake: Duration,
    /// The longest that a client may take nothing of what is sent to it. A page that is alive takes a state ten times a
    /// second.
    pub send: Duration,
    /// How often a page is asked whether it is still there (a ping, which browsers answer by themselves).
    pub ping_every: Duration,
    /// A page that says nothing for so long, though it was asked, is gone: five pings, so that a short loss of the
    /// network does not end a visit.
    pub silence: Duration,
    /// A page that has not said a word so long after it came may have to give way where all places are taken. A browser
    /// says that it has shown a picture within a second.
    pub first_word: Duration,
    /// Connections at once that are no open page yet: 16 pages at the six connections that browsers open, and some more.
    pub most_connections: usize,
    /// Pages open at once: what one machine can encode pictures for.
    pub most_pages: usize,
}

impl Default for ServerLimits {
    fn default() -> Self {
        Self {
            head: Duration::from_secs(10),
            handshake: Duration::from_secs(10),
            send: Duration::from_secs(15),
            ping_every: Duration::from_secs(3),
            silence: Duration::from_secs(15),
            first_word: Duration::from_secs(10),
            most_connections: 128,
            most_pages: 16,
        }
    }
}
/// How fast one page may send what.
pub struct Limits {
    /// Anything.
    pub all: Throttle,
    /// Held keys.
    pub drives: Throttle,
    /// Pieces of sound.
    pub sounds: Throttle,
    /// What is being typed.
    pub drafts: Throttle,
    /// Anything else.
    pub others: Throttle,
}

impl Limits {
    /// Of a page that has sent nothing yet.
    pub fn new(now: Instant) -> Self {
        Self {
            all: Throttle::new(now, ALL_PER_SECOND),
            drives: Throttle::new(now, DRIVES_PER_SECOND),
            sounds: Throttle::with_at_once(now, SOUNDS_PER_SECOND, SOUNDS_AT_ONCE),
            drafts: Throttle::new(now, DRAFTS_PER_SECOND),
            others: Throttle::new(now, OTHERS_PER_SECOND),
        }
    }
}

/// Lets so many messages a second through, with some in hand.
pub struct Throttle {
    per_second: f64,
    at_once: f64,
    in_hand: f64,
    at: Instant,
}

impl Throttle {
    /// A throttle that has let nothing through yet, and lets as many through at once as in a second.
    fn new(now: Instant, per_second: f64) -> Self {
        Self::with_at_once(now, per_second, per_second)
    }

    /// One that lets so many through at once.
    fn with_at_once(now: Instant, per_second: f64, at_once: f64) -> Self {
        Self { per_second, at_once, in_hand: at_once, at: now }
    }

    /// Whether one more message may pass now.
    pub fn admits(&mut self, now: Instant) -> bool {
        let since = now.saturating_duration_since(self.at).as_secs_f64();
        self.at = now;
        self.in_hand = (self.in_hand + since * self.per_second).min(self.at_once);
        let admitted = self.in_hand >= 1.0;
        if admitted {
            self.in_hand -= 1.0;
        }
        admitted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_a_second_pass() {
        let start = Instant::now();
        let mut throttle = Limits::new(start).others;
        assert_eq!((0..30).filter(|_| throttle.admits(start)).count(), 10);
        assert!(throttle.admits(start + Duration::from_millis(150)));
        assert!(!throttle.admits(start + Duration::from_millis(160)));
    }

    #[test]
    fn sound_that_the_network_held_back_is_taken() {
        let start = Instant::now();
        let mut sounds = Limits::new(start).sounds;
        // A piece lasts 32 ms. Those of ten seconds come as they are made, those of ten more all at once.
        assert!((0..312).all(|piece| sounds.admits(start + Duration::from_millis(32 * piece))));
        let after = start + Duration::from_secs(20);
        assert!((0..312).all(|_| sounds.admits(after)));
        assert!(!(0..1000).all(|_| sounds.admits(after)), "not any number");
    }

    #[test]
    fn keys_held_down_are_never_cut_off() {
        let start = Instant::now();
        let mut limits = Limits::new(start);
        for press in 0..200 {
            let now = start + Duration::from_millis(press * 60);
            assert!(limits.all.admits(now) && limits.drives.admits(now), "{press}");
        }
        let flood = (0..1000).filter(|_| limits.all.admits(start + Duration::from_secs(60))).count();
        assert_eq!(flood, 40);
    }
}

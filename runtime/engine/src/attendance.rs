//! In lock-step: whom the world waits for, and whose turn it is.

use std::time::{Duration, Instant};

use cohabit_bus::{is_alive, message::NONE};

/// Who lets its time run out so often in a row is not waited for any more, until it attends again.
const MOST_TIMEOUTS: u32 = 10;
/// The place of a recorder that dies is kept for so long: what its successor has not seen must not pass by on the bus.
const SUCCEEDED_WITHIN: Duration = Duration::from_secs(10);

/// All who are waited for.
#[derive(Default)]
pub(crate) struct Attendance {
    attendees: Vec<Attendee>,
    /// Turns that ran out of time, of all together.
    timeouts: u64,
}

struct Attendee {
    run: u64,
    body: u32,
    /// The longest that a turn of it may take; for ever if absent.
    patience: Option<Duration>,
    turn: Turn,
    timeouts_in_a_row: u32,
}

#[derive(Clone, Copy, PartialEq)]
enum Turn {
    /// It is to be told that it is its turn.
    Comes,
    /// It was told, and is waited for.
    Since(Instant),
    /// It has no turn before that tick, or an outcome of its body.
    Rests(u64),
}

/// Those whose turn comes.
#[derive(Debug, PartialEq)]
pub(crate) struct Due {
    /// Who they are.
    pub runs: Vec<u64>,
    /// Their bodies, in the same order.
    pub bodies: Vec<u32>,
}

/// Somebody whose time ran out.
pub(crate) struct TimedOut {
    pub body: u32,
    /// How often that happened to anybody in this session.
    pub count: u64,
    pub sentence: String,
}

impl Attendance {
    /// Waits for somebody from now on.
    pub fn attend(&mut self, run: u64, body: u32, patience_nanos: u64) {
        self.leave(run);
        if body == NONE {
            self.attendees.retain(|attendee| attendee.body != NONE || is_alive(attendee.run));
        }
        let patience = (patience_nanos > 0).then(|| Duration::from_nanos(patience_nanos));
        self.attendees.push(Attendee { run, body, patience, turn: Turn::Comes, timeouts_in_a_row: 0 });
        // Whoever came first: the order of turns is that of bodies.
        self.attendees.sort_by_key(|attendee| (attendee.body, attendee.run));
    }

    /// Waits for somebody no more.
    pub fn leave(&mut self, run: u64) {
        self.attendees.retain(|attendee| attendee.run != run);
    }

    /// Somebody's turn is over, at that tick, and the next is so many ticks later.
    pub fn ready(&mut self, run: u64, tick: u64, ticks: u64) {
        if let Some(attendee) = self.attendees.iter_mut().find(|attendee| attendee.run == run) {
            attendee.turn = Turn::Rests(tick.saturating_add(ticks.max(1)));
            attendee.timeouts_in_a_row = 0;
        }
    }

    /// Something that a body was told to do came to an end.
    pub fn note_outcome(&mut self, body: u32) {
        let resting = |attendee: &&mut Attendee| attendee.body == body && matches!(attendee.turn, Turn::Rests(_));
        self.attendees.iter_mut().filter(resting).for_each(|attendee| attendee.turn = Turn::Comes);
    }

    /// Whose turn comes at this tick; they are waited for from now on.
    pub fn ask(&mut self, tick: u64) -> Due {
        let now = Instant::now();
        let comes = |turn| matches!(turn, Turn::Comes) || matches!(turn, Turn::Rests(until) if until <= tick);
        let due = self.attendees.iter_mut().filter(|attendee| comes(attendee.turn));
        let (runs, bodies) = due
            .map(|attendee| {
                attendee.turn = Turn::Since(now);
                (attendee.run, attendee.body)
            })
            .unzip();
        Due { runs, bodies }
    }

    /// How many attend for a body; a recorder attends for none.
    pub fn count(&self) -> usize {
        self.attendees.iter().filter(|attendee| attendee.body != NONE).count()
    }

    /// Whether somebody is waited for, or is still to be told that it is its turn.
    pub fn is_awaited(&self) -> bool {
        self.attendees.iter().any(|attendee| !matches!(attendee.turn, Turn::Rests(_)))
    }

    /// Goes on without those whose time has run out at this tick, or whose process is gone.
    pub fn give_up(&mut self, tick: u64) -> Vec<TimedOut> {
        let mut given_up = Vec::new();
        self.attendees.retain_mut(|attendee| {
            let Turn::Since(since) = attendee.turn else { return true };
            let Attendee { run, body, .. } = *attendee;
            let who = if body == NONE { "the recorder".to_owned() } else { format!("the agent of body {body}") };
            if !is_alive(run) {
                if body == NONE && since.elapsed() < SUCCEEDED_WITHIN {
                    return true;
                }
                let sentence = format!("{who} is gone; it is not waited for any more");
                given_up.push(TimedOut { body, count: self.timeouts, sentence });
                return false;
            }
            if attendee.patience.is_none_or(|patience| since.elapsed() < patience) {
                return true;
            }
            self.timeouts += 1;
            attendee.timeouts_in_a_row += 1;
            attendee.turn = Turn::Rests(tick + 1);
            let stays = attendee.timeouts_in_a_row < MOST_TIMEOUTS;
            let then = if stays { "it does nothing this turn" } else { "it is not waited for any more" };
            let sentence = format!("{who} took too long over tick {tick}: {then}");
            given_up.push(TimedOut { body, count: self.timeouts, sentence });
            stays
        });
        given_up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No process has such a number.
    const DEAD: u64 = 0xff_ffff << 40;

    fn run(number: u64) -> u64 {
        (u64::from(std::process::id()) << 40) + number
    }

    #[test]
    fn the_world_waits_for_all_who_attend() {
        let mut all = Attendance::default();
        all.attend(run(2), 1, 0);
        all.attend(run(1), 0, 0);
        assert_eq!(all.ask(0).runs, [run(1), run(2)]);
        assert!(all.ask(0).runs.is_empty() && all.is_awaited());
        all.ready(run(1), 0, 1);
        assert!(all.is_awaited());
        all.ready(run(2), 0, 1);
        assert!(!all.is_awaited());
        assert_eq!(all.ask(1).runs, [run(1), run(2)]);
        all.leave(run(2));
        all.ready(run(1), 1, 1);
        assert!(!all.is_awaited() && all.count() == 1);
    }

    #[test]
    fn who_rests_is_asked_later_or_at_an_outcome() {
        let mut all = Attendance::default();
        all.attend(run(1), 0, 0);
        all.ask(0);
        all.ready(run(1), 0, 10);
        assert!((1..10).all(|tick| all.ask(tick).runs.is_empty()));
        assert_eq!(all.ask(10).runs, [run(1)]);
        all.ready(run(1), 10, 10);
        all.note_outcome(1);
        assert!(all.ask(11).runs.is_empty());
        all.note_outcome(0);
        assert_eq!(all.ask(11).runs, [run(1)]);
    }

    #[test]
    fn who_takes_too_long_does_nothing_and_is_forgotten_in_the_end() {
        let mut all = Attendance::default();
        all.attend(run(1), 0, 1);
        for tick in 0..u64::from(MOST_TIMEOUTS) {
            assert_eq!(all.ask(tick).runs, [run(1)]);
            std::thread::sleep(Duration::from_micros(1));
            let given_up = all.give_up(tick);
            assert_eq!((given_up.len(), given_up[0].count), (1, tick + 1));
            assert!(!all.is_awaited());
        }
        assert_eq!(all.count(), 0);
    }

    #[test]
    fn the_dead_are_not_waited_for() {
        let mut all = Attendance::default();
        all.attend(DEAD, 0, 0);
        all.ask(0);
        assert_eq!(all.give_up(0).len(), 1);
        assert_eq!(all.count(), 0);
    }

    #[test]
    fn a_dead_recorder_is_waited_for_until_another_takes_its_place() {
        let mut all = Attendance::default();
        all.attend(DEAD, NONE, 1);
        all.ask(0);
        assert!(all.give_up(0).is_empty() && all.is_awaited());
        all.attend(run(1), NONE, 0);
        assert_eq!(all.ask(0).runs, [run(1)]);
        all.ready(run(1), 0, 1);
        assert!(!all.is_awaited());
    }
}

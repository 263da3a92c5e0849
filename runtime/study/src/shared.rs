//! A session that several people play: each has a part in it, at a seat of their own, which is looked at and ended by itself. It ends
//! when nobody has one any more.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::{
    probe::Happening,
    session::{Health, Look, PageAddress, Playing},
    tutorial::Activity,
};

struct Shared {
    playing: Box<dyn Playing>,
    seats: Vec<Seat>,
}

#[derive(Default)]
struct Seat {
    /// What has happened since this one was last asked.
    happened: Vec<Happening>,
    /// Whether who had it has left.
    has_left: bool,
    /// Whether the world is to stand still for them.
    holds: bool,
}

/// The part of one of them.
struct Part {
    shared: Arc<Mutex<Shared>>,
    seat: usize,
}

/// A session in as many parts, one for each seat.
pub(crate) fn parts(playing: Box<dyn Playing>, count: usize) -> Vec<Box<dyn Playing>> {
    let seats = std::iter::repeat_with(Seat::default).take(count).collect();
    let shared = Arc::new(Mutex::new(Shared { playing, seats }));
    (0..count).map(|seat| Box::new(Part { shared: Arc::clone(&shared), seat }) as Box<dyn Playing>).collect()
}

impl Part {
    fn lock(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shared {
    fn is_left_by_all(&self) -> bool {
        self.seats.iter().all(|seat| seat.has_left)
    }
}

impl Playing for Part {
    fn look(&mut self) -> Look {
        let mut shared = self.lock();
        if shared.seats[self.seat].has_left && !shared.is_left_by_all() {
            return Look::Gone("the others play on".to_owned());
        }
        match shared.playing.look() {
            Look::Open(page) => match page.seats.get(self.seat).cloned() {
                Some(token) => Look::Open(PageAddress { token, ..page }),
                None => Look::Starting,
            },
            other => other,
        }
    }

    fn happened(&mut self) -> Vec<Happening> {
        let mut shared = self.lock();
        let new = shared.playing.happened();
        shared.seats.iter_mut().for_each(|seat| seat.happened.extend(&new));
        std::mem::take(&mut shared.seats[self.seat].happened)
    }

    fn tried(&mut self, seat: usize) -> Vec<Activity> {
        self.lock().playing.tried(seat)
    }

    fn lacks_wizard(&self) -> bool {
        self.lock().playing.lacks_wizard()
    }

    fn hold(&mut self, stands_still: bool) {
        let mut shared = self.lock();
        shared.seats[self.seat].holds = stands_still;
        let is_held = shared.seats.iter().any(|seat| seat.holds && !seat.has_left);
        shared.playing.hold(is_held);
    }

    fn health(&self) -> Health {
        self.lock().playing.health()
    }

    fn end(&mut self) {
        let mut shared = self.lock();
        shared.seats[self.seat].has_left = true;
        if shared.is_left_by_all() {
            shared.playing.end();
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A session that has a page until it is ended, and in which a goal was met.
    struct Stage {
        has_ended: bool,
        happened: Vec<Happening>,
        is_held: Arc<Mutex<bool>>,
    }

    impl Playing for Stage {
        fn look(&mut self) -> Look {
            let seats = vec!["first".to_owned(), "second".to_owned()];
            let page = PageAddress { port: 1, token: "all".to_owned(), wizard: None, seats };
            if self.has_ended { Look::Gone("as asked".to_owned()) } else { Look::Open(page) }
        }

        fn happened(&mut self) -> Vec<Happening> {
            std::mem::take(&mut self.happened)
        }

        fn tried(&mut self, seat: usize) -> Vec<Activity> {
            if seat == 1 { vec![Activity::Say] } else { Vec::new() }
        }

        fn hold(&mut self, stands_still: bool) {
            *self.is_held.lock().unwrap() = stands_still;
        }

        fn end(&mut self) {
            self.has_ended = true;
        }
    }

    #[test]
    fn each_has_a_page_and_it_ends_with_the_last_one() {
        let is_held = Arc::new(Mutex::new(false));
        let stage = Stage { has_ended: false, happened: vec![Happening::GoalMet], is_held: Arc::clone(&is_held) };
        let mut parts = parts(Box::new(stage), 2);
        let (first, second) = parts.split_at_mut(1);
        let (first, second) = (&mut first[0], &mut second[0]);
        let token = |look: Look| match look {
            Look::Open(page) => page.token,
            other => panic!("{other:?}"),
        };
        assert_eq!((token(first.look()), token(second.look())), ("first".to_owned(), "second".to_owned()));
        // What happens is told to each, and what one of them tries is theirs.
        assert_eq!((first.happened(), second.happened()), (vec![Happening::GoalMet], vec![Happening::GoalMet]));
        assert_eq!(first.happened(), []);
        assert_eq!((first.tried(0), second.tried(1)), (Vec::new(), vec![Activity::Say]));
        // It stands still as long as it does for either.
        let held = || *is_held.lock().unwrap();
        first.hold(true);
        second.hold(false);
        assert!(held());
        first.hold(false);
        assert!(!held());
        first.end();
        assert!(matches!(first.look(), Look::Gone(_)));
        assert_eq!(token(second.look()), "second");
        second.end();
        assert!(matches!(second.look(), Look::Gone(_)) && matches!(first.look(), Look::Gone(_)));
    }
}

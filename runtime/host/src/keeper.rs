//! Starts the sessions that are wanted as load admits them, watches them, and ends those that are not wanted any more.

use std::{
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use crate::{
    admission::{Load, Running, Wait, admit},
    board::{Board, Door, Figures, Place, State},
};

/// How often everything is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// How often sessions and the machine are measured.
const MEASURE_EVERY: Duration = Duration::from_secs(1);
/// So long after its page came it is known what a session takes: models are built and shaded by then.
const SETTLES_IN: Duration = Duration::from_secs(5);
/// A session whose page is not there by then is given up.
const LONGEST_START: Duration = Duration::from_secs(120);
/// How long sessions may take to end when all end.
const GRACE: Duration = Duration::from_secs(15);

/// How a session is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Look {
    /// It has no page yet.
    Starting,
    /// Its page can be opened.
    Open(Door),
    /// It is no more, for this reason.
    Gone(String),
}

/// A session that is played. Dropping it ends it at once.
pub trait Hosted {
    /// How it is.
    fn look(&mut self) -> Look;

    /// What it takes, and how it goes.
    fn figures(&mut self) -> Figures;

    /// Asks it to end; it is [`Look::Gone`] soon.
    fn end(&mut self);
}

/// Plays sessions.
pub trait Starter {
    /// Starts that of a place, from 0.
    ///
    /// # Errors
    /// Why it cannot be started.
    fn start(&mut self, place: usize, mission: &str) -> Result<Box<dyn Hosted>, String>;
}

/// Measures the machine.
pub trait Gauge {
    /// How busy it has been since this was last asked.
    fn load(&mut self) -> Load;
}

/// Looks after all sessions until `stop`; then ends them. It has to be the thread that starts them.
pub fn keep(board: &Mutex<Board>, starter: &mut dyn Starter, gauge: &mut dyn Gauge, stop: &AtomicBool) {
    let mut keeper = Keeper::new(lock(board).places.len());
    let mut measured = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        if measured <= Instant::now() {
            measured = Instant::now() + MEASURE_EVERY;
            let (load, figures) = (gauge.load(), keeper.figures());
            note(&mut lock(board), load, &figures);
        }
        keeper.look_after(&mut lock(board), starter, Instant::now());
        thread::sleep(LOOK_EVERY);
    }
    keeper.end_all();
}

/// A board; what a panic left of it is whole, since each change is one.
pub(crate) fn lock(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes what was measured. What sessions take counts, also where the system says nothing of the machine.
fn note(board: &mut Board, load: Load, figures: &[Option<Figures>]) {
    let own: f64 = figures.iter().flatten().filter_map(|figures| figures.cores).sum();
    board.load = Load { busy_cores: load.busy_cores.max(own), ..load };
    for (place, figures) in board.places.iter_mut().zip(figures) {
        place.figures = figures.unwrap_or_default();
    }
}

/// The session of a place.
struct Kept {
    hosted: Box<dyn Hosted>,
    began: Instant,
    /// Since when its page can be opened.
    opened: Option<Instant>,
    /// Why it was asked to end, if it was.
    ends: Option<Why>,
}

/// Why a session ends.
enum Why {
    /// Nobody wants it any more.
    NotWanted,
    /// It is of no use, for this reason.
    Failed(String),
}

/// All that are played, by their places.
struct Keeper(Vec<Option<Kept>>);

impl Keeper {
    fn new(places: usize) -> Self {
        Self((0..places).map(|_| None).collect())
    }

    /// What each takes, and how it goes.
    fn figures(&mut self) -> Vec<Option<Figures>> {
        self.0.iter_mut().map(|kept| kept.as_mut().map(|kept| kept.hosted.figures())).collect()
    }

    /// Looks at all sessions, ends those that are not wanted, and starts the one whose turn it is if load admits it.
    fn look_after(&mut self, board: &mut Board, starter: &mut dyn Starter, now: Instant) {
        for (kept, place) in self.0.iter_mut().zip(&mut board.places) {
            look_at(kept, place, now);
        }
        let queue = board.queue();
        let Some((first, others)) = queue.split_first() else { return };
        for other in others {
            board.places[*other].state = State::Waiting(Wait::Turn);
        }
        let admitted = admit(&board.load, board.expected, &self.running(&board.places, now));
        let place = &mut board.places[*first];
        place.state = match admitted.map(|()| starter.start(*first, &place.mission)) {
            Err(wait) => State::Waiting(wait),
            Ok(Ok(hosted)) => {
                self.0[*first] = Some(Kept { hosted, began: now, opened: None, ends: None });
                State::Starting
            }
            Ok(Err(reason)) => {
                place.is_wanted = false;
                State::Failed(reason)
            }
        };
    }

    /// Those that are played, as admission sees them. What one that ends takes is soon free: nobody waits to learn it.
    fn running(&self, places: &[Place], now: Instant) -> Vec<Running> {
        let is_settled = |kept: &Kept| {
            kept.ends.is_some() || kept.opened.is_some_and(|at| now.saturating_duration_since(at) >= SETTLES_IN)
        };
        let kept = self.0.iter().zip(places).filter_map(|(kept, place)| Some((kept.as_ref()?, &place.figures)));
        kept.map(|(kept, figures)| Running {
            is_settled: is_settled(kept),
            missed: figures.missed_share(),
            cores: figures.cores,
        })
        .collect()
    }

    /// Ends all, and waits until they have ended.
    fn end_all(&mut self) {
        self.0.iter_mut().flatten().for_each(|kept| kept.hosted.end());
        let deadline = Instant::now() + GRACE;
        while self.0.iter().any(Option::is_some) && Instant::now() < deadline {
            for kept in &mut self.0 {
                if kept.as_mut().is_some_and(|kept| matches!(kept.hosted.look(), Look::Gone(_))) {
                    *kept = None;
                }
            }
            thread::sleep(LOOK_EVERY);
        }
        // Whoever does not end is ended.
        self.0.clear();
    }
}

/// Looks at the session of a place, if there is one, and ends it if nobody wants it.
fn look_at(kept: &mut Option<Kept>, place: &mut Place, now: Instant) {
    let Some(alive) = kept else { return };
    if !place.is_wanted && alive.ends.is_none() {
        alive.end(Why::NotWanted);
    }
    let is_late = now.saturating_duration_since(alive.began) >= LONGEST_START;
    place.state = match alive.hosted.look() {
        Look::Gone(reason) => {
            let why = alive.ends.take().unwrap_or(Why::Failed(reason));
            *kept = None;
            over(place, why)
        }
        _ if alive.ends.is_some() => State::Ending,
        Look::Starting if is_late => {
            alive.end(Why::Failed("its page did not come".to_owned()));
            State::Ending
        }
        Look::Starting => State::Starting,
        Look::Open(door) => {
            alive.opened.get_or_insert(now);
            State::Open(door)
        }
    };
}

/// What a place is whose session has ended. One that nobody wanted may be wanted again meanwhile.
fn over(place: &mut Place, why: Why) -> State {
    place.figures = Figures::default();
    match why {
        Why::Failed(reason) => {
            place.is_wanted = false;
            State::Failed(reason)
        }
        Why::NotWanted if place.is_wanted => State::Waiting(Wait::Turn),
        Why::NotWanted => State::Stopped,
    }
}

impl Kept {
    fn end(&mut self, why: Why) {
        self.hosted.end();
        self.ends = Some(why);
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::RefCell, rc::Rc};

    use super::*;
    use crate::{admission::Needs, board::Command};

    /// What becomes of the sessions of a test, by their places.
    #[derive(Default)]
    struct Fate {
        looks: Vec<Option<Look>>,
        asked_to_end: Vec<usize>,
        refusal: Option<String>,
    }

    struct Fake {
        place: usize,
        fate: Rc<RefCell<Fate>>,
    }

    struct Stage(Rc<RefCell<Fate>>);

    impl Hosted for Fake {
        fn look(&mut self) -> Look {
            self.fate.borrow().looks[self.place].clone().unwrap_or(Look::Starting)
        }

        fn figures(&mut self) -> Figures {
            Figures { cores: Some(0.4), memory_bytes: 1, ticks: 600, missed: 0 }
        }

        fn end(&mut self) {
            let mut fate = self.fate.borrow_mut();
            fate.asked_to_end.push(self.place);
            fate.looks[self.place] = Some(Look::Gone("as asked".to_owned()));
        }
    }

    impl Starter for Stage {
        fn start(&mut self, place: usize, _: &str) -> Result<Box<dyn Hosted>, String> {
            let mut fate = self.0.borrow_mut();
            fate.looks[place] = None;
            fate.refusal.clone().map_or_else(|| Ok(Box::new(Fake { place, fate: Rc::clone(&self.0) }) as _), Err)
        }
    }

    struct Case {
        fate: Rc<RefCell<Fate>>,
        stage: Stage,
        keeper: Keeper,
        board: Board,
        now: Instant,
    }

    impl Case {
        fn new(places: usize) -> Self {
            let fate = Rc::new(RefCell::new(Fate { looks: vec![None; places], ..Fate::default() }));
            let mut board = Board::new((0..places).map(|place| place.to_string()), Needs::default(), "");
            board.load = Load { cores: 2.0, busy_cores: 0.0, free_bytes: 1 };
            let stage = Stage(Rc::clone(&fate));
            Self { fate, stage, keeper: Keeper::new(places), board, now: Instant::now() }
        }

        fn open(&self, place: usize) {
            self.fate.borrow_mut().looks[place] = Some(Look::Open(Door { port: 1, token: "t".to_owned() }));
        }

        /// How all places are after so long.
        fn after(&mut self, time: Duration) -> Vec<&State> {
            self.now += time;
            self.keeper.look_after(&mut self.board, &mut self.stage, self.now);
            self.board.places.iter().map(|place| &place.state).collect()
        }
    }

    const MOMENT: Duration = Duration::from_millis(100);

    fn is_open(state: &State) -> bool {
        matches!(state, State::Open(_))
    }

    #[test]
    fn sessions_begin_one_after_the_other_as_load_admits_them() {
        let mut case = Case::new(3);
        let waiting = State::Waiting(Wait::Turn);
        assert_eq!(case.after(MOMENT), [&State::Starting, &waiting, &waiting]);
        case.open(0);
        assert_eq!(case.after(MOMENT)[1], &State::Waiting(Wait::Settling));
        assert_eq!(case.after(SETTLES_IN)[1], &State::Starting);
        case.open(1);
        case.after(MOMENT);
        let figures = case.keeper.figures();
        // What the sessions take counts, also where the system says nothing of the machine.
        note(&mut case.board, Load { cores: 1.0, busy_cores: 0.0, free_bytes: 1 }, &figures);
        let states = case.after(SETTLES_IN);
        assert!(is_open(states[0]) && is_open(states[1]));
        assert_eq!(states[2], &State::Waiting(Wait::Busy { busy: 0.8, cores: 1.0, needed: 0.4 }));
    }

    #[test]
    fn one_that_is_stopped_makes_room_and_can_be_started_again() {
        let mut case = Case::new(1);
        case.after(MOMENT);
        case.open(0);
        assert!(is_open(case.after(MOMENT)[0]));
        case.board.obey(Command::Stop(1)).expect("a place");
        assert_eq!(case.after(MOMENT), [&State::Stopped]);
        assert_eq!(case.fate.borrow().asked_to_end, [0]);
        assert_eq!(case.after(MOMENT), [&State::Stopped], "nobody wants it");
        case.board.obey(Command::Start(1)).expect("a place");
        assert_eq!(case.after(MOMENT), [&State::Starting]);
    }

    #[test]
    fn what_ends_by_itself_is_told_and_not_started_again() {
        let mut case = Case::new(1);
        case.after(MOMENT);
        case.fate.borrow_mut().looks[0] = Some(Look::Gone("no port".to_owned()));
        for _ in 0..2 {
            assert_eq!(case.after(MOMENT), [&State::Failed("no port".to_owned())]);
        }
        case.board.obey(Command::Start(1)).expect("a place");
        case.fate.borrow_mut().refusal = Some("no process".to_owned());
        assert_eq!(case.after(MOMENT), [&State::Failed("no process".to_owned())]);
    }

    #[test]
    fn one_whose_page_does_not_come_is_given_up() {
        let mut case = Case::new(1);
        case.after(MOMENT);
        assert_eq!(case.after(LONGEST_START), [&State::Ending]);
        assert_eq!(case.after(MOMENT), [&State::Failed("its page did not come".to_owned())]);
    }
}

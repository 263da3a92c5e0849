//! Which sessions are wanted, and how each of them is.

use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    admission::{Load, Needs, Wait},
    capacity::MOST_MISSED,
};

/// Where a session's page is: at the host by which the page of all of them is opened.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Door {
    /// Its port.
    pub port: u16,
    /// What lets a page in.
    pub token: String,
}

/// What was measured of a session lately.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Cores that it kept busy, if that was measured.
    pub cores: Option<f64>,
    /// Memory that it takes, bytes.
    pub memory_bytes: u64,
    /// Ticks that it began.
    pub ticks: u64,
    /// Those that began a whole tick too late.
    pub missed: u64,
}

impl Figures {
    /// The share of its ticks that it missed.
    #[must_use]
    pub fn missed_share(&self) -> f64 {
        self.missed as f64 / self.ticks.max(1) as f64
    }
}

/// How the session of a place is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) enum State {
    /// Nobody wants it.
    #[default]
    Stopped,
    /// It is wanted, and not admitted yet.
    Waiting(Wait),
    /// It has no page yet.
    Starting,
    /// Its page can be opened.
    Open(Door),
    /// It was asked to end.
    Ending,
    /// It ended by itself, for this reason.
    Failed(String),
}

/// A place for a session.
#[derive(Debug)]
pub(crate) struct Place {
    /// What is played there.
    pub mission: String,
    /// Whether it is to be played.
    pub is_wanted: bool,
    /// By which those that wait are admitted in turn.
    pub turn: u64,
    /// How it is.
    pub state: State,
    /// What was measured of it.
    pub figures: Figures,
}

/// Places for sessions, of each of which somebody may want one.
#[derive(Debug)]
pub struct Board {
    pub(crate) places: Vec<Place>,
    pub(crate) load: Load,
    /// What a session is expected to take.
    pub(crate) expected: Needs,
    /// In words, how cores are shared.
    shares: String,
    next_turn: u64,
}

/// What the page may ask for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Command {
    /// The session of a place, from 1, is to be played.
    Start(usize),
    /// It is to end.
    Stop(usize),
}

impl Board {
    /// A place for each of these missions, all of which are wanted; `shares` says how cores are shared.
    #[must_use]
    pub fn new(missions: impl IntoIterator<Item = String>, expected: Needs, shares: &str) -> Self {
        let place = |(turn, mission)| Place {
            mission,
            is_wanted: true,
            turn,
            state: State::Waiting(Wait::Turn),
            figures: Figures::default(),
        };
        let places: Vec<Place> = (0..).zip(missions).map(place).collect();
        let next_turn = places.len() as u64;
        Self { places, load: Load::default(), expected, shares: shares.to_owned(), next_turn }
    }

    /// Has something be done.
    ///
    /// # Errors
    /// Why it cannot be, in words.
    pub fn obey(&mut self, command: Command) -> Result<(), String> {
        let (Command::Start(number) | Command::Stop(number)) = command;
        let turn = self.next_turn;
        let index = number.checked_sub(1).filter(|index| *index < self.places.len());
        let place = &mut self.places[index.ok_or_else(|| format!("There is no session {number}."))?];
        match command {
            Command::Start(_) if place.is_wanted => {}
            Command::Start(_) => {
                (place.is_wanted, place.turn) = (true, turn);
                if !matches!(place.state, State::Ending) {
                    place.state = State::Waiting(Wait::Turn);
                }
                self.next_turn += 1;
            }
            Command::Stop(_) => {
                place.is_wanted = false;
                if matches!(place.state, State::Waiting(_)) {
                    place.state = State::Stopped;
                }
            }
        }
        Ok(())
    }

    /// The places whose sessions wait, those who have waited longest first.
    pub(crate) fn queue(&self) -> Vec<usize> {
        let is_waiting = |index: &usize| matches!(self.places[*index].state, State::Waiting(_));
        let mut waiting: Vec<usize> = (0..self.places.len()).filter(is_waiting).collect();
        waiting.sort_by_key(|index| self.places[*index].turn);
        waiting
    }

    /// What the page shows.
    pub(crate) fn page(&self) -> Value {
        let queue = self.queue();
        let position = |index: usize| queue.iter().position(|waiting| *waiting == index).map(|at| at + 1);
        let sessions = self.places.iter().enumerate();
        let sessions: Vec<Value> = sessions.map(|(index, place)| place.page(index + 1, position(index))).collect();
        let open = self.places.iter().filter(|place| matches!(place.state, State::Open(_))).count();
        json!({
            "sessions": sessions,
            "open": open,
            "cores": self.load.cores,
            "busy_cores": self.load.busy_cores,
            "free_bytes": self.load.free_bytes,
            "most_missed": MOST_MISSED,
            "shares": self.shares,
        })
    }
}

impl Place {
    fn page(&self, number: usize, position: Option<usize>) -> Value {
        let (state, why, door) = match &self.state {
            State::Stopped => ("stopped", String::new(), None),
            State::Waiting(wait) => ("waiting", wait.to_string(), None),
            State::Starting => ("starting", String::new(), None),
            State::Open(door) => ("open", String::new(), Some(door)),
            State::Ending => ("ending", String::new(), None),
            State::Failed(reason) => ("failed", reason.clone(), None),
        };
        let measured = door.map(|_| &self.figures);
        json!({
            "number": number,
            "mission": self.mission,
            "wanted": self.is_wanted,
            "state": state,
            "why": why,
            "position": position,
            "port": door.map(|door| door.port),
            "token": door.map(|door| door.token.as_str()),
            "cores": measured.and_then(|figures| figures.cores),
            "memory_bytes": measured.map(|figures| figures.memory_bytes),
            "missed": measured.filter(|figures| figures.ticks > 0).map(Figures::missed_share),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn board() -> Board {
        Board::new(["a", "b", "c"].map(str::to_owned), Needs::default(), "alike")
    }

    #[test]
    fn who_is_wanted_again_waits_behind_the_others() {
        let mut board = board();
        assert_eq!(board.queue(), [0, 1, 2]);
        board.obey(Command::Stop(1)).expect("a place");
        assert_eq!((board.queue(), &board.places[0].state), (vec![1, 2], &State::Stopped));
        for _ in 0..2 {
            board.obey(Command::Start(1)).expect("a place");
            assert_eq!(board.queue(), [1, 2, 0], "asking twice changes nothing");
        }
        let positions: Vec<Value> = (0..3).map(|index| board.page()["sessions"][index]["position"].clone()).collect();
        assert_eq!(positions, [json!(3), json!(1), json!(2)]);
    }

    #[test]
    fn one_that_ends_is_played_again_only_once_it_has_ended() {
        let mut board = board();
        board.places[1].state = State::Open(Door { port: 7, token: "t".to_owned() });
        board.obey(Command::Stop(2)).expect("a place");
        assert!(matches!(board.places[1].state, State::Open(_)), "whoever keeps it ends it");
        board.places[1].state = State::Ending;
        board.obey(Command::Start(2)).expect("a place");
        assert!(board.places[1].is_wanted && board.places[1].state == State::Ending);
    }

    #[test]
    fn places_that_there_are_not_are_named() {
        for number in [0, 4, usize::MAX] {
            let said = board().obey(Command::Start(number)).expect_err("no place");
            assert_eq!(said, format!("There is no session {number}."));
        }
    }

    #[test]
    fn figures_of_sessions_that_are_not_played_are_not_shown() {
        let mut board = board();
        board.places[0].figures = Figures { cores: Some(0.5), memory_bytes: 1, ticks: 600, missed: 3 };
        assert_eq!(board.page()["sessions"][0]["missed"], Value::Null);
        board.places[0].state = State::Open(Door { port: 4711, token: "ab".to_owned() });
        let page = board.page();
        let session = &page["sessions"][0];
        let shown = (&session["port"], &session["token"], &session["missed"], &session["cores"], &page["open"]);
        assert_eq!(shown, (&json!(4711), &json!("ab"), &json!(0.005), &json!(0.5), &json!(1)));
    }
}

//! What the study's server needs of whoever plays sessions. How they are played it does not know.

use std::path::PathBuf;

use serde::Serialize;

use crate::{
    design::Study,
    pair::{pair_called, pair_label, pair_of},
    plan::{place_of, pseudonym},
    probe::Happening,
    progress::Ending,
    tutorial::Activity,
};

/// A session that is to be played.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Wanted {
    /// What it is found by in the study: participant or pair, step, and which try.
    pub name: String,
    /// What the participant is called; in a study of pairs, what the pair is.
    pub participant: String,
    /// How many people have a page of their own in it; 0 if one participant plays it, at the page that all have.
    pub seats: u32,
    /// The mission, as the study names it.
    pub mission: String,
    /// Flags of `cohabit play`.
    pub arguments: Vec<String>,
    /// Where it is recorded.
    pub log: PathBuf,
    /// The logs of sessions of the same mission that ended before their time, the newest first: it goes on from there.
    pub before: Vec<PathBuf>,
    /// The seed of its world; that of the study, so that a mission is the same for all.
    pub seed: u64,
    /// Whether it is a tutorial: it tells what was tried, and goes on when its goals are met.
    pub is_tutorial: bool,
}

/// Where the page of a session is: at the host that the study's own pages are at.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PageAddress {
    /// Its port.
    pub port: u16,
    /// What lets a page in.
    pub token: String,
    /// What lets the wizard's page in, if a wizard takes part.
    pub wizard: Option<String>,
    /// What lets the page of each seat in, if people have seats.
    pub seats: Vec<String>,
}

/// How a session is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Look {
    /// It has no page yet.
    Starting,
    /// Its page can be opened.
    Open(PageAddress),
    /// Its mission is over; its page can still be seen.
    Over(Ending),
    /// It is no more, for this reason.
    Gone(String),
}

/// How well a session runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Health {
    /// The share of its last ticks that began a whole tick too late, 0 to 1; nothing, if there were none.
    pub missed: Option<f64>,
    /// From the newest words to the robot's answer, ms.
    pub answered_ms: Option<f64>,
    /// From these to its first motion, ms.
    pub moved_ms: Option<f64>,
}

/// Plays sessions.
pub trait Player: Send {
    /// Starts one.
    ///
    /// # Errors
    /// Why it cannot be started now.
    fn start(&mut self, wanted: &Wanted) -> Result<Box<dyn Playing>, String>;
}

/// A session that is played. Dropping it ends it at once.
pub trait Playing: Send {
    /// How it is.
    fn look(&mut self) -> Look;

    /// What has happened in it since it was last looked at.
    fn happened(&mut self) -> Vec<Happening>;

    /// What the participant at a seat, from 0, has done in it since this was last asked; of a tutorial alone. Whoever plays by themselves
    /// is at seat 0.
    fn tried(&mut self, seat: usize) -> Vec<Activity>;

    /// Whether a wizard is to take part, and nobody sits at the seat.
    fn lacks_wizard(&self) -> bool {
        false
    }

    /// Has its world stand still, or go on; this is told again and again.
    fn hold(&mut self, _stands_still: bool) {}

    /// How well it runs.
    fn health(&self) -> Health {
        Health::default()
    }

    /// Asks it to end; it is [`Look::Gone`] soon.
    fn end(&mut self);
}

/// Whose a session is.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Whose {
    /// That of the participant at a place.
    Participant(u32),
    /// That of a pair, by its number.
    Pair(u32),
}

impl Whose {
    /// Whom logs name for sessions of the participant at a place: them, or in a study of pairs their pair.
    #[must_use]
    pub fn of(study: &Study, place: u32) -> Self {
        if study.pairing.is_some() { Self::Pair(pair_of(place)) } else { Self::Participant(place) }
    }

    /// What they are called.
    #[must_use]
    pub fn label(self) -> String {
        match self {
            Self::Participant(place) => pseudonym(place),
            Self::Pair(pair) => pair_label(pair),
        }
    }

    fn called(label: &str) -> Option<Self> {
        place_of(label).map(Self::Participant).or_else(|| pair_called(label).map(Self::Pair))
    }

    /// The number of the pair that it is, or belongs to.
    #[must_use]
    pub const fn pair(self) -> u32 {
        match self {
            Self::Participant(place) => pair_of(place),
            Self::Pair(pair) => pair,
        }
    }

    /// Whether the participant at a place is among them.
    #[must_use]
    pub const fn includes(self, place: u32) -> bool {
        match self {
            Self::Participant(own) => own == place,
            Self::Pair(pair) => pair == pair_of(place),
        }
    }
}

/// What a session is called: whose it is, step from 1, and which try from 1.
#[must_use]
pub fn session_name(whose: Whose, step: usize, attempt: u32) -> String {
    format!("{}-{:02}-{attempt}", whose.label(), step + 1)
}

/// What a try at a mission of the participant at a place is called, the first `together` of which their pair played.
#[must_use]
pub fn name_of_try(place: u32, step: usize, attempt: u32, together: u32) -> String {
    let whose = if attempt <= together { Whose::Pair(pair_of(place)) } else { Whose::Participant(place) };
    session_name(whose, step, attempt)
}

/// Whose session it is that is called so, and of which step, from 0.
#[must_use]
pub fn step_of(session: &str) -> Option<(Whose, usize)> {
    let mut parts = session.split('-');
    let (whose, step, attempt) = (parts.next()?, parts.next()?, parts.next()?);
    attempt.parse::<u32>().ok()?;
    let whose = Whose::called(whose)?;
    parts.next().is_none().then_some((whose, step.parse::<usize>().ok()?.checked_sub(1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_sessions_say_whose_they_are() {
        assert_eq!(session_name(Whose::Participant(7), 2, 3), "P07-03-3");
        assert_eq!(step_of("P07-03-3"), Some((Whose::Participant(7), 2)));
        assert_eq!(step_of("pair04-03-3"), Some((Whose::Pair(4), 2)));
        let tries = [1, 2, 3].map(|attempt| name_of_try(7, 2, attempt, 2));
        assert_eq!(tries, ["pair04-03-1", "pair04-03-2", "P07-03-3"]);
        assert!(Whose::Pair(4).includes(8) && !Whose::Pair(4).includes(9) && Whose::Participant(7).includes(7));
        for other in ["", "P07", "P07-00-1", "P07-03", "P07-03-3-1", "play-17", "P7-03-1", "pair4-03-1"] {
            assert_eq!(step_of(other), None, "{other}");
        }
    }
}

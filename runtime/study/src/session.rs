//! What the study's server needs of whoever plays sessions. How they are played it does not know.

use std::path::PathBuf;

use crate::{plan::pseudonym, probe::Happening, progress::Ending, tutorial::Activity};

/// A session that is to be played.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Wanted {
    /// What it is found by in the study: participant, step, and which try.
    pub name: String,
    /// The participant's pseudonym.
    pub participant: String,
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

    /// What the participant has done in it since it was last looked at; of a tutorial alone.
    fn tried(&mut self) -> Vec<Activity>;

    /// Whether a wizard is to take part, and nobody sits at the seat.
    fn lacks_wizard(&self) -> bool {
        false
    }

    /// Asks it to end; it is [`Look::Gone`] soon.
    fn end(&mut self);
}

/// What a session is called: participant, step from 1, and which try from 1.
#[must_use]
pub fn session_name(place: u32, step: usize, attempt: u32) -> String {
    format!("{}-{:02}-{attempt}", pseudonym(place), step + 1)
}

/// The participant's place and the step, from 0, of a session that is called so.
#[must_use]
pub fn step_of(session: &str) -> Option<(u32, usize)> {
    let mut parts = session.split('-');
    let (participant, step, attempt) = (parts.next()?, parts.next()?, parts.next()?);
    attempt.parse::<u32>().ok()?;
    let place = crate::plan::place_of(participant)?;
    parts.next().is_none().then_some((place, step.parse::<usize>().ok()?.checked_sub(1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_sessions_say_whose_they_are() {
        assert_eq!(session_name(7, 2, 3), "P07-03-3");
        assert_eq!(step_of("P07-03-3"), Some((7, 2)));
        for other in ["", "P07", "P07-00-1", "P07-03", "P07-03-3-1", "play-17", "P7-03-1"] {
            assert_eq!(step_of(other), None, "{other}");
        }
    }
}

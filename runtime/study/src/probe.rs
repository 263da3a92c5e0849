//! Probes: single questions that are asked while a mission is played, which goes on meanwhile or stands still.

use cohabit_dialog::Given;

/// A question that is asked during missions, at most once in each.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// The questionnaire with this one question, by name.
    pub questionnaire: String,
    /// When it is asked.
    pub at: Moment,
    /// Whether the mission stands still until it is answered.
    pub pauses: bool,
}

/// When a probe is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moment {
    /// When something happens.
    Happens(Happening),
    /// When the mission was played for so long, s.
    Played(f64),
}

/// What happens in a session.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Happening {
    /// A goal is met.
    GoalMet,
    /// Something that the robot was to do failed.
    ActionFailed,
    /// The robot asks something.
    QuestionAsked,
}

/// A probe that was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Probed {
    /// Which, by its number among the study's.
    pub probe: usize,
    /// When, ms since 1970.
    pub asked_ms: u64,
    /// When it was answered, ms since 1970, and what; nothing, if the mission ended before.
    pub answer: Option<(u64, Option<Given>)>,
}

/// What a moment is called that comes with time.
const MINUTES: &str = "minutes";

impl Happening {
    const ALL: [Self; 3] = [Self::GoalMet, Self::ActionFailed, Self::QuestionAsked];

    const fn name(self) -> &'static str {
        match self {
            Self::GoalMet => "goal_met",
            Self::ActionFailed => "action_failed",
            Self::QuestionAsked => "question_asked",
        }
    }

    /// The one that is called so; nothing, if it is no happening.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }
}

impl Moment {
    /// The names of all moments.
    pub const NAMES: [&'static str; 4] =
        [Happening::ALL[0].name(), Happening::ALL[1].name(), Happening::ALL[2].name(), MINUTES];

    /// As a study's file and tables have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Happens(happening) => happening.name(),
            Self::Played(_) => MINUTES,
        }
    }

    /// After how long it is, s, if that is what it depends on.
    #[must_use]
    pub const fn played_s(self) -> Option<f64> {
        match self {
            Self::Played(seconds) => Some(seconds),
            Self::Happens(_) => None,
        }
    }

    /// Whether it is now, `happened` having happened just before, and the mission having been played for `played_s`.
    #[must_use]
    pub fn is_now(self, happened: &[Happening], played_s: f64) -> bool {
        match self {
            Self::Happens(what) => happened.contains(&what),
            Self::Played(seconds) => played_s >= seconds,
        }
    }
}

/// The first of the probes that is due, if none is open: one that was not asked in this mission yet. What happens while another
/// question waits for its answer is passed over.
#[must_use]
pub fn due(probes: &[Probe], probed: &[Probed], happened: &[Happening], played_s: f64) -> Option<usize> {
    let is_open = probed.iter().any(|one| one.answer.is_none());
    let is_new = |number: &usize| !probed.iter().any(|one| one.probe == *number);
    let is_due = |number: &usize| probes[*number].at.is_now(happened, played_s);
    (0..probes.len()).filter(|_| !is_open).filter(is_new).find(is_due)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_is_asked_once_and_alone() {
        let probe = |at| Probe { questionnaire: "trust".to_owned(), at, pauses: false };
        let probes = [probe(Moment::Happens(Happening::GoalMet)), probe(Moment::Played(60.0))];
        let asked = |probe, answer| Probed { probe, asked_ms: 5, answer };
        assert_eq!(due(&probes, &[], &[], 59.0), None);
        assert_eq!(due(&probes, &[], &[Happening::ActionFailed], 59.0), None);
        assert_eq!(due(&probes, &[], &[Happening::GoalMet], 59.0), Some(0));
        assert_eq!(due(&probes, &[], &[Happening::GoalMet], 61.0), Some(0));
        assert_eq!(due(&probes, &[asked(0, None)], &[], 61.0), None, "one at a time");
        assert_eq!(due(&probes, &[asked(0, Some((6, None)))], &[Happening::GoalMet], 61.0), Some(1));
        let both = [asked(0, Some((6, None))), asked(1, Some((7, None)))];
        assert_eq!(due(&probes, &both, &[Happening::GoalMet], 99.0), None, "once in a mission");
    }
}

//! The wizard's seat (Wizard of Oz) without a page, a clock or a robot: how it is set, when what is held back is answered, and what a
//! wizard may decide.
//!
//! What a robot is told is held back where a wizard takes part, or where answers have a constant delay. One rule says when it is
//! answered ([`Holding::next`]), so both conditions of a study have the same latency.

mod click;
mod planned;

use std::{fmt, str::FromStr, time::Duration};

use serde::{Deserialize, Serialize};

use crate::expression::FacialExpression;
pub(crate) use click::Click;
pub use planned::PlannedError;

/// The longest text of a phrase, and of what a wizard has the robot say, in characters.
pub const LONGEST_SAYING: usize = 400;
/// What the robot says at the time-out, if nothing else is set.
pub const MOMENT: &str = "One moment, please.";

/// What is held back, and for how long.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Holding {
    /// Nothing is answered sooner after it was said; a stop is carried out at once.
    pub delay: Duration,
    /// Who decides what is answered, if a wizard takes part.
    pub wizard: Option<WizardSettings>,
}

/// How a wizard takes part.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct WizardSettings {
    /// How long they may take; as long as they like, if absent.
    pub timeout: Option<Duration>,
    /// What follows then.
    pub on_timeout: OnTimeout,
    /// What the robot says then, if that is what follows.
    pub moment: String,
    /// What they can have the robot say by a key.
    pub phrases: Vec<Phrase>,
    /// The errors that they can have the robot make.
    pub errors: Vec<PlannedError>,
}

/// What follows when a wizard has not decided in time.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum OnTimeout {
    /// The robot does what it proposed.
    #[default]
    Act,
    /// It says that it takes a moment, and goes on waiting.
    Say,
    /// It goes on waiting.
    Wait,
}

/// A canned phrase.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
pub struct Phrase {
    /// The key that says it: a letter or a digit.
    pub key: char,
    /// What the robot says.
    pub text: String,
    /// Whether what was proposed waits on, rather than being answered by it.
    pub waits: bool,
}

/// Whether somebody sits at a session's seat.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum SeatState {
    /// Nobody does.
    #[default]
    Empty,
    /// A wizard's page is open.
    Taken,
}

impl SeatState {
    /// As the bus tells it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Empty => "empty",
            Self::Taken => "taken",
        }
    }

    /// The one of that name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        [Self::Empty, Self::Taken].into_iter().find(|one| one.name() == name)
    }
}

/// What is wrong with a setting of the seat.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum NotOfWizard {
    /// No such thing follows a time-out.
    #[error("`{0}` is none of `act`, `say` and `wait`")]
    OnTimeout(String),
    /// It is no phrase.
    #[error("`{0}` is no phrase: write a key and a text, such as `h=Hello!`, or `m:wait=One moment.`")]
    Phrase(String),
    /// Its key cannot be pressed alone.
    #[error("`{0}` is no key for a phrase: use one small letter or digit")]
    Key(String),
    /// Its text is too long, or there is none.
    #[error("the phrase of key `{0}` has to have 1 to {LONGEST_SAYING} characters")]
    Text(char),
    /// It is no planned error.
    #[error("that is no planned error ({0}): write JSON such as `{{\"name\": \"slip\", \"do\": \"stop\"}}`")]
    PlannedError(String),
    /// It has no name to be called by.
    #[error("`{0}` is no name of a planned error: write a name of one short line")]
    ErrorName(String),
    /// The robot would neither say nor do anything, or too much.
    #[error("the robot has to say or do something at the planned error `{0}`, in {LONGEST_SAYING} characters")]
    ErrorText(String),
    /// There is no such step, or nothing takes its place.
    #[error("the step of the planned error `{0}` counts from 1, and needs something to do in its place")]
    ErrorStep(String),
}

impl Holding {
    /// Whether anything is held back at all.
    #[must_use]
    pub fn holds(&self) -> bool {
        !self.delay.is_zero() || self.wizard.is_some()
    }

    /// What is to follow now with what is held back so.
    pub(crate) fn next(&self, held: HeldSince, now_nanos: u64) -> Next {
        let answered_at = held.received_nanos.saturating_add(nanos(self.delay));
        let at = |due: u64, then: Next| if now_nanos >= due { then } else { Next::Wait(Some(due)) };
        let Some(wizard) = self.wizard.as_ref().filter(|_| !held.is_decided) else {
            return at(answered_at, Next::Answer);
        };
        let Some(timeout) = wizard.timeout.filter(|_| !held.is_late) else { return Next::Wait(None) };
        let late_at = held.proposed_nanos.saturating_add(nanos(timeout));
        match wizard.on_timeout {
            OnTimeout::Act => at(late_at.max(answered_at), Next::TimeOut(OnTimeout::Act)),
            other => at(late_at, Next::TimeOut(other)),
        }
    }
}

fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// Since when something is held back, ns of the monotonic clock, and how far the wizard is with it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct HeldSince {
    /// When it was said.
    pub received_nanos: u64,
    /// When it could be decided.
    pub proposed_nanos: u64,
    /// Whether it is decided.
    pub is_decided: bool,
    /// Whether the time-out has passed.
    pub is_late: bool,
}

/// What is to follow.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Next {
    /// Nothing, until then; nothing without somebody's doing, if absent.
    Wait(Option<u64>),
    /// It is answered.
    Answer,
    /// The wizard is late.
    TimeOut(OnTimeout),
}

/// What a wizard decides.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Decision {
    /// The robot does what it proposes.
    Accept {
        /// In this turn.
        turn: u64,
        /// Which proposal of that turn was seen.
        revision: u32,
    },
    /// A plain request is understood in place of what was said, and proposed.
    Edit {
        /// In this turn.
        turn: u64,
        /// The request.
        text: String,
    },
    /// The robot says and does this; instead of what it proposes, if a turn is named. Nothing of both dismisses that.
    Own {
        /// The turn.
        turn: Option<u64>,
        /// What it says.
        #[serde(default)]
        say: String,
        /// The key of the phrase that it says.
        #[serde(default)]
        phrase: Option<char>,
        /// A plain request that it carries out without a word.
        #[serde(default)]
        order: String,
    },
    /// The robot does what was clicked without a word; instead of what it proposes, if a turn is named.
    Click {
        /// The turn.
        turn: Option<u64>,
        /// What.
        click: Click,
        /// From the click on a thing to the choice of what is done with it, ms; the server knows, and the page does not say.
        #[serde(skip)]
        chosen_ms: Option<f64>,
    },
    /// The robot makes a planned error; instead of what it proposes, if a turn is named.
    Inject {
        /// The turn.
        turn: Option<u64>,
        /// The error's name.
        error: String,
    },
    /// The robot's face shows something.
    Express {
        /// What.
        expression: FacialExpression,
    },
}

/// What is proposed to a wizard.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Proposal {
    /// The turn.
    pub turn: u64,
    /// Which proposal of that turn it is.
    pub revision: u32,
    /// What the person said.
    pub said: String,
    /// What the wizard had understood in its place.
    pub edits: Vec<String>,
    /// What kind of answer it is.
    pub kind: String,
    /// The steps of its plan, in words.
    pub steps: Vec<String>,
    /// What the robot says.
    pub reply: String,
    /// How likely it is what was meant, 0 to 1.
    pub sureness: f32,
    /// What was said since, and waits for this one to be answered.
    pub waiting: Vec<String>,
    /// Whether it is decided, and answered once the delay has passed.
    pub is_decided: bool,
    /// Whether the time-out has passed.
    pub is_late: bool,
    /// How long it is until something follows without the wizard, ms.
    pub left_ms: Option<u64>,
}

impl OnTimeout {
    const ALL: [Self; 3] = [Self::Act, Self::Say, Self::Wait];

    /// As people write it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Act => "act",
            Self::Say => "say",
            Self::Wait => "wait",
        }
    }
}

impl fmt::Display for OnTimeout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for OnTimeout {
    type Err = NotOfWizard;

    fn from_str(text: &str) -> Result<Self, NotOfWizard> {
        Self::ALL.into_iter().find(|one| one.name() == text).ok_or_else(|| NotOfWizard::OnTimeout(text.to_owned()))
    }
}

/// What stands behind a phrase's key where what was proposed waits on.
const WAITS: &str = ":wait";

impl Phrase {
    /// A phrase.
    ///
    /// # Errors
    /// [`NotOfWizard`], if its key or its text cannot be.
    pub fn new(key: &str, text: &str, waits: bool) -> Result<Self, NotOfWizard> {
        let mut letters = key.chars();
        let key = match (letters.next(), letters.next()) {
            (Some(key @ ('a'..='z' | '0'..='9')), None) => key,
            _ => return Err(NotOfWizard::Key(key.to_owned())),
        };
        let text = text.trim();
        if !(1..=LONGEST_SAYING).contains(&text.chars().count()) || text.contains('\n') {
            return Err(NotOfWizard::Text(key));
        }
        Ok(Self { key, text: text.to_owned(), waits })
    }
}

impl fmt::Display for Phrase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}={}", self.key, if self.waits { WAITS } else { "" }, self.text)
    }
}

impl FromStr for Phrase {
    type Err = NotOfWizard;

    fn from_str(text: &str) -> Result<Self, NotOfWizard> {
        let (key, says) = text.split_once('=').ok_or_else(|| NotOfWizard::Phrase(text.to_owned()))?;
        let bare = key.strip_suffix(WAITS);
        Self::new(bare.unwrap_or(key), says, bare.is_some())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn holding(delay_ms: u64, timeout: Option<(u64, OnTimeout)>, has_wizard: bool) -> Holding {
        let wizard = WizardSettings {
            timeout: timeout.map(|(ms, _)| Duration::from_millis(ms)),
            on_timeout: timeout.map(|(_, on)| on).unwrap_or_default(),
            moment: MOMENT.to_owned(),
            phrases: Vec::new(),
            errors: Vec::new(),
        };
        Holding { delay: Duration::from_millis(delay_ms), wizard: has_wizard.then_some(wizard) }
    }

    const WORDS: HeldSince =
        HeldSince { received_nanos: 1000 * MS, proposed_nanos: 1000 * MS, is_decided: false, is_late: false };

    #[test]
    fn answers_come_after_the_delay_with_and_without_a_wizard() {
        let decided = HeldSince { is_decided: true, ..WORDS };
        for (holding, held) in [(holding(500, None, false), WORDS), (holding(500, None, true), decided)] {
            assert_eq!(holding.next(held, 1499 * MS), Next::Wait(Some(1500 * MS)));
            assert_eq!(holding.next(held, 1500 * MS), Next::Answer);
        }
        // Who decides later is answered at once.
        assert_eq!(holding(500, None, true).next(decided, 9000 * MS), Next::Answer);
        assert_eq!(holding(0, None, true).next(decided, 1000 * MS), Next::Answer);
        assert!(!holding(0, None, false).holds() && holding(1, None, false).holds() && holding(0, None, true).holds());
    }

    #[test]
    fn a_time_out_counts_from_the_proposal_and_never_answers_before_the_delay() {
        let check = |timeout: Option<(u64, OnTimeout)>, held: HeldSince, at_ms: u64, expected: Next| {
            assert_eq!(holding(500, timeout, true).next(held, at_ms * MS), expected, "{timeout:?} {held:?} {at_ms}");
        };
        check(None, WORDS, 1_000_000, Next::Wait(None));
        for on in OnTimeout::ALL {
            check(Some((3000, on)), WORDS, 3999, Next::Wait(Some(4000 * MS)));
            check(Some((3000, on)), WORDS, 4000, Next::TimeOut(on));
            check(
                Some((3000, on)),
                HeldSince { proposed_nanos: 7000 * MS, ..WORDS },
                9999,
                Next::Wait(Some(10_000 * MS)),
            );
            check(Some((3000, on)), HeldSince { is_late: true, ..WORDS }, 9000, Next::Wait(None));
            check(Some((3000, on)), HeldSince { is_decided: true, is_late: true, ..WORDS }, 9000, Next::Answer);
        }
        check(Some((100, OnTimeout::Act)), WORDS, 1200, Next::Wait(Some(1500 * MS)));
        check(Some((100, OnTimeout::Say)), WORDS, 1200, Next::TimeOut(OnTimeout::Say));
    }

    #[test]
    fn phrases_and_time_outs_read_as_they_are_written() {
        for phrase in ["h=Hello!", "m:wait=One moment = a while.", "1=Yes."] {
            assert_eq!(phrase.parse::<Phrase>().unwrap().to_string(), phrase);
        }
        assert!(!"h=Hello!".parse::<Phrase>().unwrap().waits && "h:wait=Hello!".parse::<Phrase>().unwrap().waits);
        for (wrong, part) in [
            ("Hello!", "is no phrase"),
            ("=Hello!", "no key"),
            ("hi=Hello!", "no key"),
            ("H=Hello!", "no key"),
            ("h= ", "1 to 400"),
        ] {
            let error = wrong.parse::<Phrase>().unwrap_err().to_string();
            assert!(error.contains(part), "{wrong}: {error}");
        }
        for on in OnTimeout::ALL {
            assert_eq!(on.to_string().parse(), Ok(on));
        }
        assert!("never".parse::<OnTimeout>().is_err());
    }
}

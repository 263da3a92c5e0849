//! How a robot words what it says: for studies of that. What it understands and does is the same.

use std::{fmt, str::FromStr};

use cohabit_language::Understanding;

use super::Conversation;

/// What begins the sentence that says what the robot does.
const OK: &str = "OK, ";

/// How a robot words what it says.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Manner {
    /// Whether it is polite.
    pub politeness: Politeness,
    /// How much it says.
    pub verbosity: Verbosity,
}

/// Whether a robot is polite.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Politeness {
    /// It says what is to be said.
    #[default]
    Plain,
    /// It agrees with pleasure, asks whether it may ask, and is sorry where it refuses.
    Polite,
}

/// How much a robot says.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Verbosity {
    /// It says what it is about to do, and what is to be known of that.
    #[default]
    Full,
    /// It says no more than that it does it.
    Brief,
}

impl Politeness {
    /// In one word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Polite => "polite",
        }
    }
}

impl Verbosity {
    /// In one word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Full => "full",
            Self::Brief => "brief",
        }
    }
}

impl fmt::Display for Politeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Verbosity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Politeness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = [Self::Plain, Self::Polite].into_iter().find(|one| one.name() == text);
        named.ok_or_else(|| "one of `plain`, `polite`".to_owned())
    }
}

impl FromStr for Verbosity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = [Self::Full, Self::Brief].into_iter().find(|one| one.name() == text);
        named.ok_or_else(|| "one of `full`, `brief`".to_owned())
    }
}

impl Conversation {
    /// The same, of a robot that words what it says so.
    pub(crate) fn speaking(self, manner: Manner) -> Self {
        Self { manner, ..self }
    }
}

impl Manner {
    /// The same, worded so. An answer is what was asked for, and that the robot stops is said at once.
    pub(super) fn worded(self, mut understanding: Understanding) -> Understanding {
        match &mut understanding {
            Understanding::Plan { reply, .. } => *reply = self.agreed(reply),
            Understanding::Question { text, .. } => *text = self.asked(text),
            Understanding::Refusal { text, .. } => *text = self.refused(text),
            Understanding::Answer { .. } | Understanding::Stop { .. } => {}
        }
        understanding
    }

    /// `The fridge is closed, so I open it first. OK, picking up the milk.`
    fn agreed(self, reply: &str) -> String {
        let begins = |at: &usize| *at == 0 || reply[..*at].ends_with(". ");
        let Some(at) = reply.rmatch_indices(OK).map(|(at, _)| at).find(begins) else { return reply.to_owned() };
        let (before, does) = (&reply[..at], &reply[at + OK.len()..]);
        let word = match self.politeness {
            Politeness::Plain => "OK",
            Politeness::Polite => "Certainly",
        };
        // What is said of the robot itself, such as that it waits to be told, has to be known.
        if self.verbosity == Verbosity::Full || does.starts_with("I ") {
            return format!("{before}{word}, {does}");
        }
        let stops = before.split_inclusive(". ").next().filter(|first| first.starts_with(OK)).unwrap_or_default();
        format!("{stops}{word}.")
    }

    fn asked(self, question: &str) -> String {
        match self.politeness {
            Politeness::Plain => question.to_owned(),
            Politeness::Polite => format!("May I ask? {question}"),
        }
    }

    fn refused(self, refusal: &str) -> String {
        match self.politeness {
            Politeness::Polite if !refusal.starts_with("I am sorry") => format!("I am sorry. {refusal}"),
            _ => refusal.to_owned(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_language::Clarification;

    use super::*;
    use crate::conversation::tests::{conversation, knowledge, plans, says};

    const POLITE: Manner = Manner { politeness: Politeness::Polite, verbosity: Verbosity::Full };
    const BRIEF: Manner = Manner { politeness: Politeness::Plain, verbosity: Verbosity::Brief };
    const BOTH: Manner = Manner { politeness: Politeness::Polite, verbosity: Verbosity::Brief };

    #[test]
    fn what_a_robot_does_is_told_in_its_manner() {
        let noted = "The fridge is closed, so I open it first. OK, picking up the milk.";
        let stops = "OK, I stop. OK, going to the lab.";
        for (manner, reply, expected) in [
            (Manner::default(), noted, noted),
            (POLITE, noted, "The fridge is closed, so I open it first. Certainly, picking up the milk."),
            (BRIEF, noted, "OK."),
            (BOTH, noted, "Certainly."),
            (BRIEF, stops, "OK, I stop. OK."),
            (POLITE, stops, "OK, I stop. Certainly, going to the lab."),
            (BRIEF, "OK, I wait. Tell me when to go on.", "OK, I wait. Tell me when to go on."),
            (BOTH, "I look for it first.", "I look for it first."),
            (BOTH, "", ""),
        ] {
            let worded = manner.worded(Understanding::Plan { steps: Vec::new(), reply: reply.to_owned() });
            assert_eq!(worded.reply(), expected, "{manner:?}");
        }
    }

    #[test]
    fn a_polite_robot_asks_whether_it_may_ask_and_is_sorry_once() {
        let refusal = |text: &str| Understanding::Refusal { text: text.to_owned(), is_lost: false };
        assert_eq!(POLITE.worded(refusal("I cannot reach it.")).reply(), "I am sorry. I cannot reach it.");
        assert_eq!(POLITE.worded(refusal("I am sorry, no.")).reply(), "I am sorry, no.");
        assert_eq!(BRIEF.worded(refusal("I cannot reach it.")).reply(), "I cannot reach it.");
        let question = Understanding::Question {
            kind: Clarification::Reference,
            about: "bowl".to_owned(),
            text: "Which bowl do you mean?".to_owned(),
            candidates: Vec::new(),
            options: Vec::new(),
        };
        assert_eq!(POLITE.worded(question).reply(), "May I ask? Which bowl do you mean?");
    }

    #[test]
    fn a_conversation_is_worded_so_and_its_plans_are_the_same() {
        let knowledge = knowledge();
        let said = |manner: Manner| {
            let (_, outbox) = conversation().speaking(manner).hear("go to the main office", &knowledge);
            assert!(plans(&outbox), "{outbox:?}");
            says(&outbox)
        };
        assert!(said(Manner::default()).starts_with("OK, going to"), "{}", said(Manner::default()));
        assert!(said(POLITE).starts_with("Certainly, going to"), "{}", said(POLITE));
        assert_eq!(said(BRIEF), "OK.");
    }

    #[test]
    fn manners_are_named_in_a_word() {
        assert_eq!(
            ["plain", "polite"].map(|name| name.parse::<Politeness>().unwrap().to_string()),
            ["plain", "polite"]
        );
        assert_eq!(["full", "brief"].map(|name| name.parse::<Verbosity>().unwrap().to_string()), ["full", "brief"]);
        assert_eq!("rude".parse::<Politeness>(), Err("one of `plain`, `polite`".to_owned()));
        assert_eq!("mute".parse::<Verbosity>(), Err("one of `full`, `brief`".to_owned()));
    }
}

//! What a wizard decided (Wizard of Oz): the text of a dialog entry of kind `Decided`, as JSON. It is the audit trail of the seat.

use serde::{Deserialize, Serialize};

use crate::entry::DialogEntry;

/// The most bytes of an entry's text.
const LONGEST_BYTES: usize = 8000;
/// What is cut keeps so many characters, none of which takes more than six bytes.
const LONGEST_PART: usize = 200;

/// A decision about something that was held back, or of the wizard's own accord.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct WizardDecision {
    /// What came of the proposal.
    pub outcome: DecisionOutcome,
    /// What the person said; empty where the wizard acted of their own accord.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub said: String,
    /// What the robot would have done, as it was last proposed before the wizard wrote anything.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proposed: Option<Proposed>,
    /// The plain requests that the wizard had understood in place of what was said, one after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edits: Vec<String>,
    /// What the wizard had the robot say.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub spoke: String,
    /// The key of the canned phrase that this was, if it was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phrase: Option<char>,
    /// What the wizard had the robot do.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub ordered: String,
    /// What the wizard chose by a click: `point`, `look`, `go_to_room`, `go_to_point`, `turn`, `move`, or what is done to the object.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clicked: Option<String>,
    /// The object that was clicked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// What the wizard had the robot's face show.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expression: Option<String>,
    /// The name of the planned error that the wizard injected.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub injected: Option<String>,
    /// From the click on a thing to the choice of what is done with it, ms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen_ms: Option<f64>,
    /// Whether the time-out had passed first.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_late: bool,
    /// From the proposal to the wizard's decision, ms; nothing, if they made none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decided_ms: Option<f64>,
    /// From the person's words to the robot's answer, ms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answered_ms: Option<f64>,
    /// Whether nobody decided it: a program played the session.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub synthetic: bool,
}

/// What came of a proposal.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DecisionOutcome {
    /// The robot did what it had proposed.
    Accepted,
    /// It did what it understood of a request that the wizard wrote in place of the person's words.
    Edited,
    /// It said or did what the wizard wrote or picked instead.
    Replaced,
    /// It did nothing about it, since the wizard dismissed it.
    Dismissed,
    /// The wizard had not decided in time, so it did what it had proposed.
    TimedOut,
    /// The person told the robot to stop before the wizard had decided.
    Stopped,
    /// Nothing was proposed: the wizard acted of their own accord.
    Unprompted,
    /// The session ended before it was decided.
    Undecided,
}

impl DecisionOutcome {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Accepted,
        Self::Edited,
        Self::Replaced,
        Self::Dismissed,
        Self::TimedOut,
        Self::Stopped,
        Self::Unprompted,
        Self::Undecided,
    ];

    /// As tables have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Accepted => "accepted",
            Self::Edited => "edited",
            Self::Replaced => "replaced",
            Self::Dismissed => "dismissed",
            Self::TimedOut => "timed_out",
            Self::Stopped => "stopped",
            Self::Unprompted => "unprompted",
            Self::Undecided => "undecided",
        }
    }

    /// Whether the robot did something else than it would have done by itself.
    #[must_use]
    pub const fn is_intervention(self) -> bool {
        matches!(self, Self::Edited | Self::Replaced | Self::Dismissed | Self::Unprompted)
    }
}

/// What the robot proposed.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Proposed {
    /// What kind of answer: `plan`, `question`, `answer`, `refusal` or `stop`.
    pub kind: String,
    /// The steps of its plan, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<String>,
    /// What it would have said.
    pub reply: String,
}

impl WizardDecision {
    /// The kind of those entries.
    pub const KIND: &str = "Decided";

    /// One of which only is known what came of it.
    #[must_use]
    pub const fn of_outcome(outcome: DecisionOutcome) -> Self {
        Self {
            outcome,
            said: String::new(),
            proposed: None,
            edits: Vec::new(),
            spoke: String::new(),
            phrase: None,
            ordered: String::new(),
            clicked: None,
            object: None,
            expression: None,
            injected: None,
            chosen_ms: None,
            is_late: false,
            decided_ms: None,
            answered_ms: None,
            synthetic: false,
        }
    }

    /// What an entry tells, if it is of that kind.
    #[must_use]
    pub fn of(entry: &DialogEntry) -> Option<Self> {
        if entry.kind == Self::KIND { serde_json::from_str(&entry.text).ok() } else { None }
    }

    /// The same as the text of an entry; what is too long for one is cut.
    #[must_use]
    pub fn text(&self) -> String {
        let whole = serde_json::to_string(self).unwrap_or_default();
        if whole.len() <= LONGEST_BYTES { whole } else { serde_json::to_string(&self.cut()).unwrap_or_default() }
    }

    fn cut(&self) -> Self {
        let cut = |text: &String| text.chars().take(LONGEST_PART).collect::<String>();
        let proposed = self.proposed.as_ref();
        let proposed =
            proposed.map(|one| Proposed { kind: one.kind.clone(), steps: Vec::new(), reply: cut(&one.reply) });
        Self {
            said: cut(&self.said),
            proposed,
            edits: self.edits.last().map(cut).into_iter().collect(),
            spoke: cut(&self.spoke),
            ordered: cut(&self.ordered),
            ..self.clone()
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn decisions_read_as_they_are_written() {
        let decision = WizardDecision {
            said: "fetch me the thing".to_owned(),
            proposed: Some(Proposed { kind: "refusal".to_owned(), steps: Vec::new(), reply: "What thing?".to_owned() }),
            edits: vec!["pick up the red mug".to_owned()],
            clicked: Some("pick_up".to_owned()),
            object: Some(7),
            expression: Some("sorry".to_owned()),
            injected: Some("wrong object".to_owned()),
            chosen_ms: Some(800.0),
            is_late: true,
            decided_ms: Some(2500.0),
            ..WizardDecision::of_outcome(DecisionOutcome::Edited)
        };
        let read: WizardDecision = serde_json::from_str(&decision.text()).unwrap();
        assert_eq!(read, decision);
        let endless = WizardDecision { said: "\u{1}".repeat(9000), spoke: "語".repeat(9000), ..decision };
        let cut: WizardDecision = serde_json::from_str(&endless.text()).unwrap();
        assert!(endless.text().len() <= LONGEST_BYTES && cut.edits == endless.edits && cut.said.len() == LONGEST_PART);
        for outcome in DecisionOutcome::ALL {
            assert_eq!(serde_json::to_value(outcome).unwrap(), outcome.name());
        }
    }
}

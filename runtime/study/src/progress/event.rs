//! What happens to a participant, as their journal has it.

use cohabit_dialog::Given;
use serde::{Deserialize, Serialize};

use crate::plan::Plan;

/// Something that happens to a participant.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Event {
    /// They have read the information.
    Read,
    /// They agree.
    Consented {
        /// The version of the consent form.
        version: String,
        /// The boxes that they ticked, by number, from 0.
        ticked: Vec<usize>,
        /// Whether one of them is about being heard: as the study's form has it, whatever a page says.
        #[serde(default)]
        audio: bool,
    },
    /// They do not agree.
    Declined,
    /// They have filled in some of a questionnaire.
    Drafted {
        /// Its name.
        questionnaire: String,
        /// What stands in each question so far.
        answers: Vec<Option<Given>>,
    },
    /// They answer a questionnaire.
    Answered {
        /// Its name.
        questionnaire: String,
        /// An answer to each question.
        answers: Vec<Option<Given>>,
    },
    /// Their condition is assigned.
    Assigned {
        /// What they do: what they have done, and all the rest.
        plan: Box<Plan>,
    },
    /// They want to begin a mission, or go on after a break or a tutorial.
    GoesOn,
    /// Their mission's session is started.
    Started,
    /// The same of a session that they play with their partner.
    StartedTogether {
        /// For the so-manieth time, from 1: the same for both.
        attempt: u32,
    },
    /// Their mission was played on.
    Played {
        /// For so long, s.
        seconds: f64,
    },
    /// They are asked something during their mission.
    Probed {
        /// Which of the study's probes.
        probe: usize,
    },
    /// They answer that.
    ProbeAnswered {
        /// Which of the study's probes.
        probe: usize,
        /// The answer.
        answer: Option<Given>,
    },
    /// They have tried something in a tutorial.
    Tried {
        /// Which of its exercises, from 0.
        exercise: usize,
    },
    /// Their mission's session ended before its time.
    Interrupted {
        /// Why.
        reason: String,
    },
    /// Their mission is over.
    Over {
        /// How.
        ending: Ending,
    },
    /// Their mission is skipped, since their partner and they agree, or either may decide.
    PartnerSkipped,
    /// They have waited for their partner in vain, and go on alone from now on.
    GoesAlone,
    /// Their partner does so.
    PartnerGoesAlone,
    /// They have waited for their partner in vain, and stop.
    StopsWaiting,
    /// Their partner takes no part any more.
    PartnerLeft,
    /// They take no part any more.
    Withdrew,
    /// They are excluded.
    Excluded {
        /// Why.
        reason: String,
    },
}

/// How a mission ends.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// All of its goals are met; of a tutorial: all was tried.
    Complete,
    /// Its goals cannot be met any more.
    Failed,
    /// Its time is up.
    TimeUp,
    /// The participant skipped it; of a tutorial: went on before all was tried.
    Skipped,
    /// The experimenter ended it.
    Stopped,
}

impl Ending {
    /// As tables have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Failed => "failed",
            Self::TimeUp => "time_up",
            Self::Skipped => "skipped",
            Self::Stopped => "stopped",
        }
    }
}

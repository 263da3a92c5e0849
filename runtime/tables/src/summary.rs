//! What sessions say about the conditions they were played under.

pub(crate) mod compared;
mod effects;
pub(crate) mod outcomes;
mod text;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    fit::Fit,
    interval::{mean_95, wilson_95},
    played::Played,
};
use compared::{Compared, mean};
pub use effects::Effect;
use outcomes::Outcome;

/// Outcomes by condition, and how they depend on the conditions.
///
/// Where some participant has several sessions, these are not independent: means and intervals are then of participants'
/// means, and fits have a random intercept for each participant. Where a session is of a pair, what comes of it is the pair's: that takes
/// the participant's place, and there is one intercept for each pair. Else each session is an observation of its own. Success is
/// fitted as the number 0 or 1, so its terms are differences of shares (a linear probability model).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Sessions.
    pub sessions: usize,
    /// Participants, where some have several sessions; pairs of them, where these play together.
    pub participants: Option<usize>,
    /// Whose several sessions are: each `participant`'s, or each `pair`'s or `group`'s of those who play together.
    pub unit: &'static str,
    /// The conditions by which they are compared.
    pub conditions: Vec<String>,
    /// All sessions, then those of each combination of the conditions.
    pub groups: Vec<Group>,
    /// Each outcome on the conditions and the interactions asked for; nothing where there are none.
    pub fits: Vec<Fit>,
    /// How large the differences between levels are.
    pub effects: Vec<Effect>,
    /// What a reader should know of these sessions.
    pub notes: Vec<String>,
}

/// Sessions that were played under the same conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The conditions; none of all sessions together.
    pub conditions: BTreeMap<String, String>,
    /// How many sessions.
    pub sessions: usize,
    /// What came of them.
    pub measures: Vec<Measure>,
}

/// An outcome's mean, or share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measure {
    /// The outcome.
    pub outcome: String,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Sessions that have it.
    pub sessions: usize,
    /// Its mean over those; where participants have several sessions, the mean of their means.
    pub mean: Option<f64>,
    /// The 95 % interval of the mean: Wilson's of a share where each participant has one session, or where all are alike, else
    /// Student's; nothing where that has one observation.
    pub interval_95: Option<[f64; 2]>,
}

/// Why sessions cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum SummaryError {
    /// There is no such condition.
    #[error("no session notes `{name}`: conditions are {}", known.join(", "))]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
}

impl Summary {
    /// Compares sessions by these conditions: settings, `mission` or `participant`; `a:b` adds the interaction of two. By all
    /// settings in which they differ, if none are given.
    ///
    /// # Errors
    /// [`SummaryError::Unknown`].
    pub fn new(played: &[Played], by: &[String]) -> Result<Self, SummaryError> {
        Ok(Self::of(&Compared::new(played, by)?))
    }

    /// The summary of sessions that were read.
    pub(crate) fn of(compared: &Compared) -> Self {
        let everybody: Vec<usize> = (0..compared.len()).collect();
        let all = Group::new(compared, BTreeMap::new(), &everybody);
        let groups = compared.groups().into_iter().filter(|group| !group.conditions.is_empty());
        let each = groups.map(|group| Group::new(compared, group.conditions, &group.members));
        let has_conditions = !compared.conditions.is_empty();
        Self {
            sessions: compared.len(),
            participants: compared.is_repeated.then(|| compared.participants_of(&everybody)),
            unit: compared.unit,
            conditions: compared.conditions.clone(),
            groups: std::iter::once(all).chain(each).collect(),
            fits: if has_conditions { fits(compared) } else { Vec::new() },
            effects: if has_conditions { Effect::all(compared) } else { Vec::new() },
            notes: notes(compared),
        }
    }
}

fn fits(compared: &Compared) -> Vec<Fit> {
    let fit = |outcome: &Outcome| {
        let observed = compared.observations(outcome);
        let model = if compared.is_repeated { Fit::mixed } else { Fit::least_squares };
        (!observed.is_empty()).then(|| model(&outcome.name, outcome.unit, &compared.terms, &observed))
    };
    compared.outcomes.iter().filter_map(fit).collect()
}

fn notes(compared: &Compared) -> Vec<String> {
    let unnamed = (compared.is_repeated && compared.unnamed > 0)
        .then(|| format!("{} sessions name no participant: each counts as one of its own", compared.unnamed));
    let incomplete = (compared.incomplete > 0).then(|| {
        format!(
            "sessions whose logs were cut off or lack something: {} of {}; what is not in them counts as not done, and the column \
             `problems` of the table `sessions` says what that is",
            compared.incomplete,
            compared.len()
        )
    });
    unnamed.into_iter().chain(incomplete).collect()
}

impl Group {
    fn new(compared: &Compared, conditions: BTreeMap<String, String>, members: &[usize]) -> Self {
        let measure = |outcome| Measure::new(compared, outcome, members);
        Self { conditions, sessions: members.len(), measures: compared.outcomes.iter().map(measure).collect() }
    }
}

impl Measure {
    fn new(compared: &Compared, outcome: &Outcome, members: &[usize]) -> Self {
        let values = compared.values(outcome, members);
        let means: Vec<f64> = values.values().map(|own| mean(own)).collect();
        let is_single = values.values().all(|own| own.len() == 1);
        Self {
            outcome: outcome.name.clone(),
            unit: outcome.unit,
            sessions: values.values().map(Vec::len).sum(),
            mean: (!means.is_empty()).then(|| mean(&means)),
            interval_95: interval_95(outcome, &means, is_single),
        }
    }
}

/// The interval of a mean of participants' means, each of a single session or of several. Student's interval of a share has no
/// width where all participants always succeeded, or never; then participants count as single trials, which is
/// conservative.
pub(crate) fn interval_95(outcome: &Outcome, means: &[f64], is_single: bool) -> Option<[f64; 2]> {
    if !outcome.is_share || means.is_empty() {
        return mean_95(means);
    }
    let is_same = [0.0, 1.0].iter().any(|share| means.iter().all(|value| value == share));
    if is_single || is_same {
        return Some(wilson_95(means.iter().filter(|value| **value == 1.0).count(), means.len()));
    }
    mean_95(means).map(|limits| limits.map(|limit| limit.clamp(0.0, 1.0)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

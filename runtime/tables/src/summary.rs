//! What sessions say about the conditions they were played under.

mod text;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::{
    answers,
    fit::{Fit, value},
    interval::{mean_95, wilson_95},
    played::Played,
    sessions::{self, Latency},
};

/// Outcomes by condition, and how they depend on the conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Sessions.
    pub sessions: usize,
    /// The conditions by which they are compared.
    pub conditions: Vec<String>,
    /// All sessions, then those of each combination of the conditions.
    pub groups: Vec<Group>,
    /// Each outcome on the conditions; nothing where there are none.
    pub fits: Vec<Fit>,
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
    /// Its mean over those.
    pub mean: Option<f64>,
    /// The 95 % interval of the mean: Wilson's of a share, else Student's; nothing where one session has it.
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

/// The condition that is no setting.
const MISSION: &str = "mission";
/// The other one.
const PARTICIPANT: &str = "participant";

/// What comes of a session.
enum Outcome<'a> {
    /// A share.
    Success,
    /// How many there were.
    Count(&'static str, fn(&Played) -> usize),
    /// How long something took.
    Latency(&'static str, Latency),
    /// What a questionnaire amounts to, 0 to 100.
    Score(&'a str),
}

impl Outcome<'_> {
    fn name(&self) -> String {
        match self {
            Self::Success => "success".to_owned(),
            Self::Count(name, _) | Self::Latency(name, _) => (*name).to_owned(),
            Self::Score(questionnaire) => format!("{questionnaire} score"),
        }
    }

    const fn unit(&self) -> &'static str {
        match self {
            Self::Latency(..) => "ms",
            Self::Success | Self::Count(..) | Self::Score(_) => "",
        }
    }

    fn of(&self, played: &Played) -> Option<f64> {
        match self {
            Self::Success => played.success().map(|success| f64::from(u8::from(success))),
            Self::Count(_, count) => Some(count(played) as f64),
            Self::Latency(_, which) => played.mean_ms(*which),
            Self::Score(questionnaire) => played.score(questionnaire),
        }
    }
}

/// All that may come of these sessions.
fn outcomes(played: &[Played]) -> Vec<Outcome<'_>> {
    let always = [
        Outcome::Success,
        Outcome::Count("actions", |played| played.robots_actions().count()),
        Outcome::Count("failed actions", Played::failed_actions),
        Outcome::Count("questions", Played::questions),
        Outcome::Latency("answered", Latency::Answered),
        Outcome::Latency("understood", Latency::Understood),
        Outcome::Latency("moved", Latency::Moved),
        Outcome::Latency("framed", Latency::Framed),
        Outcome::Latency("shown", Latency::Shown),
    ];
    always.into_iter().chain(answers::scored(played).into_iter().map(Outcome::Score)).collect()
}

/// All that a session may be compared by.
fn conditions(played: &Played) -> BTreeMap<String, String> {
    let session = &played.log.session;
    let mut all = session.settings.clone();
    all.insert(MISSION.to_owned(), session.mission_file.clone());
    all.extend(session.participant.clone().map(|label| (PARTICIPANT.to_owned(), label)));
    all
}

impl Summary {
    /// Compares sessions by these conditions: settings, `mission` or `participant`. By all settings in which they differ,
    /// if none are given.
    ///
    /// # Errors
    /// [`SummaryError::Unknown`].
    pub fn new(played: &[Played], by: &[String]) -> Result<Self, SummaryError> {
        let own: Vec<BTreeMap<String, String>> = played.iter().map(conditions).collect();
        let names = if by.is_empty() { differing(played, &own) } else { known(by, &own)? };
        let mut groups = BTreeMap::<Vec<&str>, Vec<&Played>>::new();
        for (played, own) in played.iter().zip(&own) {
            groups.entry(names.iter().map(|name| value(own, name)).collect()).or_default().push(played);
        }
        let outcomes = outcomes(played);
        let of_key = |(key, members): (Vec<&str>, Vec<&Played>)| {
            let conditions = names.iter().cloned().zip(key.into_iter().map(str::to_owned)).collect();
            Group::new(conditions, &members, &outcomes)
        };
        let all = Group::new(BTreeMap::new(), &played.iter().collect::<Vec<_>>(), &outcomes);
        let each = groups.into_iter().map(of_key).filter(|group| !group.conditions.is_empty());
        let fit = |outcome: &Outcome<'_>| {
            let observed: Vec<_> =
                played.iter().zip(&own).filter_map(|(played, own)| Some((outcome.of(played)?, own))).collect();
            (!observed.is_empty()).then(|| Fit::new(&outcome.name(), outcome.unit(), &names, &observed))
        };
        Ok(Self {
            sessions: played.len(),
            groups: std::iter::once(all).chain(each).collect(),
            fits: if names.is_empty() { Vec::new() } else { outcomes.iter().filter_map(fit).collect() },
            conditions: names,
        })
    }
}

/// The settings in which sessions differ.
fn differing(played: &[Played], own: &[BTreeMap<String, String>]) -> Vec<String> {
    let differs = |name: &&str| own.iter().any(|one| value(one, name) != value(&own[0], name));
    sessions::settings(played).into_iter().filter(differs).map(str::to_owned).collect()
}

fn known(by: &[String], own: &[BTreeMap<String, String>]) -> Result<Vec<String>, SummaryError> {
    let missing = by.iter().find(|name| !own.iter().any(|one| one.contains_key(*name)));
    match missing {
        None => Ok(by.to_vec()),
        Some(name) => {
            let mut known: Vec<String> = own.iter().flat_map(|one| one.keys().cloned()).collect();
            known.sort();
            known.dedup();
            Err(SummaryError::Unknown { name: name.clone(), known })
        }
    }
}

impl Group {
    fn new(conditions: BTreeMap<String, String>, members: &[&Played], outcomes: &[Outcome<'_>]) -> Self {
        let measure = |outcome: &Outcome<'_>| {
            let values: Vec<f64> = members.iter().filter_map(|played| outcome.of(played)).collect();
            Measure::new(outcome, &values)
        };
        Self { conditions, sessions: members.len(), measures: outcomes.iter().map(measure).collect() }
    }
}

impl Measure {
    fn new(outcome: &Outcome<'_>, values: &[f64]) -> Self {
        let sum: f64 = values.iter().sum();
        let interval_95 = match values.len() {
            0 => None,
            count if matches!(outcome, Outcome::Success) => Some(wilson_95(sum as usize, count)),
            _ => mean_95(values),
        };
        Self {
            outcome: outcome.name(),
            unit: outcome.unit(),
            sessions: values.len(),
            mean: (!values.is_empty()).then(|| sum / values.len() as f64),
            interval_95,
        }
    }
}

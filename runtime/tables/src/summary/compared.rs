//! Sessions beside each other: whose each was, under which conditions, and what came of it.

use std::collections::{BTreeMap, BTreeSet};

use super::{SummaryError, outcomes::Outcome};
use crate::{
    design::{Conditions, INTERACTION, level},
    fit::Observation,
    played::Played,
    sessions,
};

/// The condition that is no setting.
const MISSION: &str = "mission";
/// The other one.
const PARTICIPANT: &str = "participant";
/// The setting that notes how many people have a page of their own in a session: it is then theirs together.
const SEATS: &str = "seats";

/// Sessions to be compared by conditions.
#[derive(Clone, Debug)]
pub(crate) struct Compared {
    /// Of each session: what each condition was.
    pub own: Vec<Conditions>,
    /// Whose each was: a participant's, or a pair's or group's who play together.
    pub unit: &'static str,
    /// Of each session: whose it was. A session without a name counts as a participant of its own.
    pub participants: Vec<String>,
    /// Sessions without a participant's name.
    pub unnamed: usize,
    /// Sessions whose logs do not tell all of them.
    pub incomplete: usize,
    /// The conditions that are compared.
    pub conditions: Vec<String>,
    /// These, and the interactions asked for: what outcomes are fitted on.
    pub terms: Vec<String>,
    /// Whether some participant has several sessions, so that sessions are not independent.
    pub is_repeated: bool,
    /// What came of the sessions.
    pub outcomes: Vec<Outcome>,
}

/// The sessions that were played under the same conditions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// The level of each condition.
    pub conditions: Conditions,
    /// Places of its sessions.
    pub members: Vec<usize>,
}

impl Compared {
    /// Sessions by the conditions asked for; by all settings in which they differ, if none are.
    pub fn new(played: &[Played], by: &[String]) -> Result<Self, SummaryError> {
        // What came of a session that was interrupted is in the one that goes on from it.
        let kept: Vec<usize> = (0..played.len()).filter(|at| !played[*at].is_continued).collect();
        let whole = || kept.iter().map(|at| &played[*at]);
        let own: Vec<Conditions> = whole().map(conditions).collect();
        let names = whole().map(|played| played.log.session.participant.clone().filter(|name| !name.is_empty()));
        let by = if by.is_empty() { differing(played, &own) } else { by.to_vec() };
        let participants = names.zip(whole()).map(|(name, played)| (name, played.name.as_str()));
        let mut outcomes = Outcome::all(played);
        for outcome in &mut outcomes {
            outcome.values = kept.iter().map(|at| outcome.values[*at]).collect();
        }
        let unit = unit(played);
        let incomplete = whole().filter(|played| !played.log.problems().is_empty()).count();
        Ok(Self { unit, incomplete, ..Self::of(own, participants.collect(), outcomes, &by)? })
    }

    /// Sessions of these conditions, participants (by name, or else by the session's name) and outcomes.
    pub fn of(
        own: Vec<Conditions>,
        participants: Vec<(Option<String>, &str)>,
        outcomes: Vec<Outcome>,
        by: &[String],
    ) -> Result<Self, SummaryError> {
        let (conditions, terms) = known(by, &own)?;
        let mut counts = BTreeMap::<&str, usize>::new();
        for name in participants.iter().filter_map(|(name, _)| name.as_deref()) {
            *counts.entry(name).or_default() += 1;
        }
        let is_repeated = counts.values().any(|count| *count > 1) && !conditions.iter().any(|name| name == PARTICIPANT);
        let unnamed = participants.iter().filter(|(name, _)| name.is_none()).count();
        let label = |(name, session): (Option<String>, &str)| match name {
            Some(name) if is_repeated => name,
            _ => format!("session {session}"),
        };
        let participants = participants.into_iter().map(label).collect();
        Ok(Self {
            own,
            unit: PARTICIPANT,
            participants,
            unnamed,
            incomplete: 0,
            conditions,
            terms,
            is_repeated,
            outcomes,
        })
    }

    /// Sessions.
    pub const fn len(&self) -> usize {
        self.own.len()
    }

    /// How many participants there are among these sessions.
    pub fn participants_of(&self, members: &[usize]) -> usize {
        members.iter().map(|place| &self.participants[*place]).collect::<BTreeSet<_>>().len()
    }

    /// The sessions of each combination of levels, in the order of these.
    pub fn groups(&self) -> Vec<Group> {
        let mut groups = BTreeMap::<Vec<&str>, Vec<usize>>::new();
        for (place, own) in self.own.iter().enumerate() {
            groups.entry(self.conditions.iter().map(|name| level(own, name)).collect()).or_default().push(place);
        }
        let group = |(levels, members): (Vec<&str>, Vec<usize>)| {
            let named = self.conditions.iter().cloned().zip(levels.into_iter().map(str::to_owned));
            Group { conditions: named.collect(), members }
        };
        groups.into_iter().map(group).collect()
    }

    /// The same, but conditions that vary between participants alone come first: so the sessions of a participant are in groups
    /// beside each other.
    pub fn between_first(mut self) -> Self {
        let varies = |name: &String| {
            let mut met = BTreeMap::<&str, &str>::new();
            let mut each = self.participants.iter().zip(&self.own).map(|(who, own)| (who.as_str(), level(own, name)));
            each.any(|(who, own)| *met.entry(who).or_insert(own) != own)
        };
        let (within, between): (Vec<String>, Vec<String>) = self.conditions.iter().cloned().partition(varies);
        self.conditions = between.into_iter().chain(within).collect();
        self
    }

    /// The values of an outcome in these sessions, by participant.
    pub fn values<'a>(&'a self, outcome: &Outcome, members: &[usize]) -> BTreeMap<&'a str, Vec<f64>> {
        let mut values = BTreeMap::<&str, Vec<f64>>::new();
        for place in members {
            if let Some(value) = outcome.values[*place] {
                values.entry(&self.participants[*place]).or_default().push(value);
            }
        }
        values
    }

    /// The sessions that have an outcome.
    pub fn observations(&self, outcome: &Outcome) -> Vec<Observation<'_>> {
        let each = outcome.values.iter().zip(&self.participants).zip(&self.own);
        each.filter_map(|((value, participant), conditions)| {
            Some(Observation { value: (*value)?, participant, conditions })
        })
        .collect()
    }
}

/// The mean of values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Whose sessions these are.
fn unit(played: &[Played]) -> &'static str {
    let seats = played.iter().filter_map(|one| one.log.session.settings.get(SEATS)?.parse::<u32>().ok());
    match seats.max().unwrap_or(0) {
        0 | 1 => PARTICIPANT,
        2 => "pair",
        _ => "group",
    }
}

/// All that a session may be compared by.
fn conditions(played: &Played) -> Conditions {
    let session = &played.log.session;
    let mut all = session.settings.clone();
    all.insert(MISSION.to_owned(), session.mission_file.clone());
    all.extend(session.participant.clone().map(|label| (PARTICIPANT.to_owned(), label)));
    all
}

/// The settings in which sessions differ.
fn differing(played: &[Played], own: &[Conditions]) -> Vec<String> {
    let differs = |name: &&str| own.iter().any(|one| level(one, name) != level(&own[0], name));
    sessions::settings(played).into_iter().filter(differs).map(str::to_owned).collect()
}

/// The conditions, and these with the interactions behind them. What interacts is itself a condition.
fn known(by: &[String], own: &[Conditions]) -> Result<(Vec<String>, Vec<String>), SummaryError> {
    let is_condition = |name: &str| own.iter().any(|one| one.contains_key(name));
    let is_interaction = |name: &&String| !is_condition(name) && name.contains(INTERACTION);
    let (mut conditions, mut interactions) = (Vec::<String>::new(), Vec::<String>::new());
    for name in by {
        let parts: Vec<&str> = if is_interaction(&name) { name.split(INTERACTION).collect() } else { vec![name] };
        if let Some(unknown) = parts.iter().find(|part| !is_condition(part)) {
            let known: BTreeSet<String> = own.iter().flat_map(|one| one.keys().cloned()).collect();
            return Err(SummaryError::Unknown { name: (*unknown).to_owned(), known: known.into_iter().collect() });
        }
        for part in parts.iter().map(|part| (*part).to_owned()) {
            if !conditions.contains(&part) {
                conditions.push(part);
            }
        }
        if parts.len() > 1 && !interactions.contains(name) {
            interactions.push(name.clone());
        }
    }
    let terms = conditions.iter().cloned().chain(interactions).collect();
    Ok((conditions, terms))
}

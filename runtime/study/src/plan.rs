//! What one participant does, step by step, and under which conditions.

use std::collections::BTreeMap;

use cohabit_cdf::PackId;
use serde::{Deserialize, Serialize};

use crate::{
    design::{Choice, Limits},
    settings::Settings,
    tutorial::Exercise,
};

/// What one participant does. It is written down when they enrol and never drawn again; where their condition depends on what
/// they answer first, it is so once they have.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Plan {
    /// The participant's place, from 1: by it they are called.
    pub place: u32,
    /// Whose place in the order of all they have, if it is not their own: that of somebody who has left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stands_for: Option<u32>,
    /// Whether nobody takes part: a program plays them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_synthetic: bool,
    /// Whether the condition is assigned after these steps, and more steps follow then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub awaits_assignment: bool,
    /// The level of each covariate that the condition was assigned by.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub covariates: BTreeMap<String, String>,
    /// The world packs that all missions are played with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub world: Vec<PackId>,
    /// The level of each between-participants factor.
    pub between: Vec<Choice>,
    /// What is done, in order.
    pub steps: Vec<Step>,
}

/// One thing that is done.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// A questionnaire is answered.
    Questionnaire {
        /// Its name.
        name: String,
        /// The mission that it is about, by the number of its step, if it is about one.
        about: Option<usize>,
    },
    /// A mission is played.
    Mission(PlannedMission),
    /// A break.
    Break {
        /// The number of its block.
        block: usize,
        /// The longest that it lasts, s.
        limit_s: Option<f64>,
    },
}

/// A mission that is played.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PlannedMission {
    /// The number of its block.
    pub block: usize,
    /// The mission, as the study names it.
    pub mission: String,
    /// Whether it is for practice, which tables leave out.
    #[serde(default)]
    pub is_practice: bool,
    /// Of a tutorial: what is to be tried.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub exercises: Vec<Exercise>,
    /// The level of each within-participant factor; none outside the block of missions.
    pub within: Vec<Choice>,
    /// All settings of its session.
    pub settings: Settings,
    /// How long it is played.
    pub limits: Limits,
}

/// What a participant is called: a label, not a name.
#[must_use]
pub fn pseudonym(place: u32) -> String {
    format!("P{place:02}")
}

/// The place of a participant who is called so.
#[must_use]
pub fn place_of(pseudonym: &str) -> Option<u32> {
    let place = pseudonym.strip_prefix('P')?.parse().ok().filter(|place| *place > 0)?;
    (self::pseudonym(place) == pseudonym).then_some(place)
}

impl PlannedMission {
    /// Whether it goes on until all of its exercises were tried.
    #[must_use]
    pub const fn is_tutorial(&self) -> bool {
        !self.exercises.is_empty()
    }
}

impl Plan {
    /// The place in the order of all by which conditions and missions were assigned.
    #[must_use]
    pub const fn order(&self) -> u32 {
        match self.stands_for {
            Some(order) => order,
            None => self.place,
        }
    }

    /// Whether a step is a mission for practice.
    #[must_use]
    pub fn is_practice(&self, step: usize) -> bool {
        matches!(self.steps.get(step), Some(Step::Mission(PlannedMission { is_practice: true, .. })))
    }

    /// The levels of all factors under which a step is done; a practice is done under none.
    #[must_use]
    pub fn choices(&self, step: usize) -> Vec<Choice> {
        let within = match self.steps.get(step) {
            Some(Step::Mission(mission)) if mission.is_practice => return Vec::new(),
            Some(Step::Mission(mission)) => mission.within.clone(),
            Some(Step::Questionnaire { about: Some(about), .. }) if *about < step => return self.choices(*about),
            _ => Vec::new(),
        };
        self.between.iter().cloned().chain(within).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pseudonyms_read_as_they_are_written() {
        for (place, name) in [(1, "P01"), (31, "P31"), (100, "P100")] {
            assert_eq!((pseudonym(place).as_str(), place_of(name)), (name, Some(place)));
        }
        for wrong in ["", "P", "P0", "P1", "P00", "p01", "P+1", "P01.json", "../P01"] {
            assert_eq!(place_of(wrong), None, "{wrong}");
        }
    }
}

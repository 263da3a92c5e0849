//! How probable it is that a candidate is the object meant.
//!
//! Two steps. That none of the candidates is meant, because a word was misheard, misspelt or wrong, is a logistic
//! regression over what speaks for such a [`Doubt`]. Which of them is meant otherwise is a conditional logit (McFadden
//! 1974): each has a utility, linear in its [`Features`], and their probabilities are the softmax of these. Rivals thus
//! lower each other's probability, as they should: a mug is less surely the one meant where there is another. Both are
//! fitted to simulated sessions by `dialog/language/fit`, which also says how well the probabilities hold.

use std::collections::BTreeMap;

use cohabit_cdf::ObjectId;
use serde::Deserialize;

use super::WORSE_NAME;

/// What is known of a candidate with regard to a referring expression.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Features {
    /// By [`Self::NAMES`], in their order.
    pub values: [f32; Self::COUNT],
}

/// What speaks for it that none of the candidates is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Doubt {
    /// By [`Self::NAMES`], in their order.
    pub values: [f32; Self::COUNT],
}

/// Which feature.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Feature {
    Name,
    ColorMismatch,
    StateMismatch,
    RoomMismatch,
    RelationMismatch,
    SameRoom,
    SameRoomSought,
    Visible,
    HeldFirst,
    StateFits,
    AtPlace,
    Hidden,
    InMission,
    Recency,
    Distance,
    DistanceSought,
}

impl Features {
    /// How many there are.
    pub const COUNT: usize = 16;

    /// Their names. Those without a unit here are 0 or 1.
    pub const NAMES: [&str; Self::COUNT] = [
        // How much the words mean its class: 1 for its name, less for words further down its list.
        "name",
        "color_mismatch",
        "state_mismatch",
        "room_mismatch",
        // Relations that were said and do not hold: a count.
        "relation_mismatch",
        "same_room",
        // The same, where it is to be found: who says `find` does not mean what is before them.
        "same_room_sought",
        "visible",
        // In the hand, and wanted for something that is done with what is in the hand.
        "held_first",
        "state_fits",
        // On or in what was gone to or opened last.
        "at_place",
        // Behind a closed door.
        "hidden",
        "in_mission",
        // 1 for what was spoken of last, then 2/3, then 1/3.
        "recency",
        // In units of 10 m, 3 at most.
        "distance_10m",
        "distance_10m_sought",
    ];

    const MISMATCHES: [Feature; 4] =
        [Feature::ColorMismatch, Feature::StateMismatch, Feature::RoomMismatch, Feature::RelationMismatch];

    fn get(&self, feature: Feature) -> f32 {
        self.values[feature as usize]
    }

    pub(crate) fn set(&mut self, feature: Feature, value: f32) {
        self.values[feature as usize] = value;
    }

    pub(crate) fn set_if(&mut self, feature: Feature, holds: bool) {
        self.set(feature, f32::from(u8::from(holds)));
    }
}

impl Doubt {
    /// How many there are.
    pub const COUNT: usize = 6;

    /// Their names.
    pub const NAMES: [&str; Self::COUNT] = [
        // Always 1.
        "always",
        // Words of the utterance whose spelling was repaired, 3 at most.
        "repairs",
        // Words of the referring expression that mean nothing to the robot, 3 at most.
        "unknown_words",
        // How much less than its name the words mean even the best candidate.
        "loose_name",
        // Whether every candidate is other than was said in colour, state, room or place.
        "mismatch",
        // Whether none is there for the sake of the mission, although other things are.
        "outside_mission",
    ];

    pub(crate) fn new(repairs: usize, unknown: usize, has_mission: bool, candidates: &[Features]) -> Self {
        let at_most_3 = |count: usize| count.min(3) as f32;
        let is = |holds: bool| f32::from(u8::from(holds));
        let best_name = candidates.iter().map(|one| one.get(Feature::Name)).fold(0.0, f32::max);
        let in_mission = candidates.iter().any(|one| one.get(Feature::InMission) > 0.0);
        let fits = candidates.iter().any(|one| Features::MISMATCHES.iter().all(|feature| one.get(*feature) == 0.0));
        Self {
            values: [
                1.0,
                at_most_3(repairs),
                at_most_3(unknown),
                1.0 - best_name,
                is(!fits),
                is(has_mission && !in_mission),
            ],
        }
    }
}

/// What may be meant by a referring expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Referents {
    /// The candidates, the most probable first.
    pub candidates: Vec<Referent>,
    /// What speaks for none of them.
    pub doubt: Doubt,
    /// The probability that none of them is meant.
    pub none: f32,
}

impl Referents {
    /// Those of which nothing is otherwise than it was said, and whose name fits as well as any; the most probable first.
    #[must_use]
    pub fn fitting(&self) -> Vec<ObjectId> {
        let is_as_said = |one: &&Referent| Features::MISMATCHES.iter().all(|one_of| one.features.get(*one_of) == 0.0);
        let fitting: Vec<&Referent> = self.candidates.iter().filter(is_as_said).collect();
        let named = |one: &Referent| one.features.get(Feature::Name);
        let best = fitting.iter().map(|one| named(one)).fold(0.0, f32::max);
        fitting.into_iter().filter(|one| named(one) > best - WORSE_NAME).map(|one| one.object).collect()
    }
}

/// A candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Referent {
    /// Which.
    pub object: ObjectId,
    /// Its features.
    pub features: Features,
    /// The probability that it is the one meant.
    pub probability: f32,
}

/// How much each feature counts.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    candidate: [f32; Features::COUNT],
    none: [f32; Doubt::COUNT],
}

#[derive(Deserialize)]
struct WeightFile {
    candidate: BTreeMap<String, f32>,
    none: BTreeMap<String, f32>,
}

impl Weights {
    /// Those in `data/confidence.toml`.
    pub(crate) fn builtin() -> Self {
        let file: WeightFile = toml::from_str(include_str!("../../data/confidence.toml"))
            .expect("invariant: the built-in weights parse, which a test holds");
        Self { candidate: by_name(&file.candidate, Features::NAMES), none: by_name(&file.none, Doubt::NAMES) }
    }

    /// The probabilities of candidates with these features, and of none of them.
    pub(crate) fn probabilities(&self, candidates: &[Features], doubt: &Doubt) -> (Vec<f32>, f32) {
        let none = if candidates.is_empty() { 1.0 } else { 1.0 / (1.0 + (-product(&self.none, &doubt.values)).exp()) };
        let utilities: Vec<f32> = candidates.iter().map(|one| product(&self.candidate, &one.values)).collect();
        (softmax(&utilities).into_iter().map(|share| share * (1.0 - none)).collect(), none)
    }
}

/// The weights of these features, in their order.
pub(crate) fn by_name<const N: usize>(weights: &BTreeMap<String, f32>, names: [&str; N]) -> [f32; N] {
    names.map(|name| *weights.get(name).expect("invariant: every feature has a weight, which a test holds"))
}

/// The shares of alternatives of these utilities.
pub(crate) fn softmax(utilities: &[f32]) -> Vec<f32> {
    let highest = utilities.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let parts: Vec<f32> = utilities.iter().map(|utility| (utility - highest).exp()).collect();
    let whole: f32 = parts.iter().sum();
    parts.iter().map(|part| part / whole).collect()
}

pub(crate) fn product(weights: &[f32], values: &[f32]) -> f32 {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_add_up_to_one_and_rivals_share() {
        let weights = Weights::builtin();
        let mut mug = Features::default();
        mug.set(Feature::Name, 1.0);
        mug.set(Feature::SameRoom, 1.0);
        let doubt = Doubt::new(0, 0, false, &[mug]);
        let (alone, none) = weights.probabilities(&[mug], &doubt);
        assert!((alone[0] + none - 1.0).abs() < 1e-5);
        let (two, none) = weights.probabilities(&[mug, mug], &doubt);
        assert!((two[0] - two[1]).abs() < 1e-6 && two[0] < alone[0] && (two[0] + two[1] + none - 1.0).abs() < 1e-5);
        let (misheard, _) = weights.probabilities(&[mug], &Doubt::new(3, 0, false, &[mug]));
        assert!(misheard[0] < alone[0], "a repaired word is a doubt");
        assert!(weights.probabilities(&[], &doubt).1 > 0.999);
    }
}

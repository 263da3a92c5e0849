//! Effect sizes of conditions, two levels at a time.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{
    compared::{Compared, mean},
    outcomes::Outcome,
};
use crate::{
    design::{Conditions, level, levels, numbers, reference},
    effect::{
        EffectSize, d_av, d_z, hedges_g, mean_share_difference, paired_mean_share_difference, paired_share_difference,
        share_difference,
    },
};

/// How far a level of a condition is from its reference, over all levels of the other conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// The outcome.
    pub outcome: String,
    /// The condition.
    pub condition: String,
    /// Its level.
    pub level: String,
    /// The level that it is compared with: the commonest.
    pub reference: String,
    /// Whether the same participants are compared with themselves.
    pub within: bool,
    /// Participants at the level and at the reference; of pairs those who met both.
    pub participants: [usize; 2],
    /// Sizes: of a true or false outcome the difference of shares, else standardised differences.
    pub sizes: Vec<EffectSize>,
}

/// The values of a participant at two levels.
type Pair<'a> = [&'a [f64]; 2];

impl Effect {
    /// Of each outcome and each condition that is no number: each level against the reference, where they have a size.
    pub(super) fn all(compared: &Compared) -> Vec<Self> {
        let own: Vec<&Conditions> = compared.own.iter().collect();
        let factors = compared.conditions.iter().filter(|name| numbers(name, &own).is_none());
        let of_outcome = |outcome| {
            let of_factor = |condition: &String| {
                let levels = levels(condition, &own);
                let reference = reference(&levels);
                let others = levels.into_keys().filter(|level| *level != reference);
                others
                    .filter_map(|level| Self::new(compared, outcome, condition, [level, reference]))
                    .collect::<Vec<_>>()
            };
            factors.clone().flat_map(of_factor).collect::<Vec<_>>()
        };
        compared.outcomes.iter().flat_map(of_outcome).collect()
    }

    fn new(compared: &Compared, outcome: &Outcome, condition: &str, both: [&str; 2]) -> Option<Self> {
        let at = |wanted: &str| {
            let members: Vec<usize> =
                (0..compared.len()).filter(|place| level(&compared.own[*place], condition) == wanted).collect();
            compared.values(outcome, &members)
        };
        let values = both.map(at);
        let pairs: Vec<Pair<'_>> = values[0]
            .iter()
            .filter_map(|(participant, level)| Some([level.as_slice(), values[1].get(participant)?.as_slice()]))
            .collect();
        let within = pairs.len() > 1;
        let (participants, sizes) = if within {
            ([pairs.len(); 2], paired_sizes(outcome.is_share, &pairs))
        } else {
            let alone = [alone(&values[0], &values[1]), alone(&values[1], &values[0])];
            (alone.each_ref().map(Vec::len), independent_sizes(outcome.is_share, &alone))
        };
        let [level, reference] = both.map(str::to_owned);
        let (outcome, condition) = (outcome.name.clone(), condition.to_owned());
        (!sizes.is_empty()).then_some(Self { outcome, condition, level, reference, within, participants, sizes })
    }
}

/// The values of those who met one level but not the other.
fn alone<'a>(own: &'a BTreeMap<&str, Vec<f64>>, other: &BTreeMap<&str, Vec<f64>>) -> Vec<&'a [f64]> {
    own.iter()
        .filter(|(participant, _)| !other.contains_key(*participant))
        .map(|(_, values)| values.as_slice())
        .collect()
}

/// One value a participant and level are counts; several are means.
fn paired_sizes(is_share: bool, pairs: &[Pair<'_>]) -> Vec<EffectSize> {
    let means: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(mean)).collect();
    if !is_share {
        return [d_z(&means), d_av(&means)].into_iter().flatten().collect();
    }
    let is_single = pairs.iter().flatten().all(|values| values.len() == 1);
    let count = |wanted: [f64; 2]| means.iter().filter(|pair| **pair == wanted).count();
    let counts = || [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]].map(count);
    let size = if is_single { paired_share_difference(counts()) } else { paired_mean_share_difference(&means) };
    size.into_iter().collect()
}

fn independent_sizes(is_share: bool, both: &[Vec<&[f64]>; 2]) -> Vec<EffectSize> {
    let means = both.each_ref().map(|values| values.iter().map(|own| mean(own)).collect::<Vec<f64>>());
    let [level, reference] = &means;
    let is_single = both.iter().flatten().all(|values| values.len() == 1);
    let count = |values: &[f64]| [values.iter().filter(|value| **value == 1.0).count(), values.len()];
    let size = match (is_share, is_single) {
        (false, _) => hedges_g(level, reference),
        (true, true) => share_difference(count(level), count(reference)),
        (true, false) => mean_share_difference(level, reference),
    };
    size.into_iter().collect()
}

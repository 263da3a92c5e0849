//! Minimisation: a newcomer gets the between-participants condition with which the levels of covariates are spread most evenly over
//! conditions, or with a small chance another one, so that nobody can tell what comes next.
//!
//! By S. J. Pocock and R. Simon: Sequential treatment assignment with balancing for prognostic factors in the controlled clinical
//! trial, Biometrics 31(1), 1975; with the range as the measure of imbalance, and all covariates counting alike.

use std::collections::BTreeMap;

use cohabit_dialog::{Form, Given, Item};

use crate::{
    chance::{Purpose, chance},
    design::{Choice, Covariate, CovariateSource, Minimisation},
    plan::Plan,
};

/// The level of a covariate of somebody who does not say.
const UNKNOWN: &str = "unknown";
/// The level of somebody whose link names none of the levels.
const OTHER: &str = "other";

/// Which of these conditions the participant at a place gets, whose levels of covariates are these; the others are those who have
/// theirs. The same ones give the same.
#[must_use]
pub fn minimise(
    (minimisation, seed): (&Minimisation, u64),
    conditions: &[Vec<Choice>],
    (place, own): (u32, &BTreeMap<String, String>),
    others: &[&Plan],
) -> usize {
    let imbalances: Vec<usize> =
        (0..conditions.len()).map(|condition| imbalance(minimisation, conditions, condition, own, others)).collect();
    let least = imbalances.iter().min().copied().unwrap_or(0);
    let (best, rest): (Vec<usize>, Vec<usize>) =
        (0..conditions.len()).partition(|condition| imbalances[*condition] == least);
    let mut drawn = chance(seed, Purpose::Minimisation, u64::from(place));
    // Where all are alike, none is better.
    let among = if rest.is_empty() || drawn.is(minimisation.certainty) { best } else { rest };
    drawn.pick(&among).copied().unwrap_or(0)
}

/// How unevenly the levels of a newcomer's covariates would be spread if they got a condition: over all covariates, the sum of how
/// many more there are of the newcomer's level in one condition than in another.
fn imbalance(
    minimisation: &Minimisation,
    conditions: &[Vec<Choice>],
    given: usize,
    own: &BTreeMap<String, String>,
    others: &[&Plan],
) -> usize {
    let range = |covariate: &Covariate| {
        let level = own.get(&covariate.name);
        let alike = |plan: &&&Plan| plan.covariates.get(&covariate.name) == level;
        let counts = conditions.iter().enumerate().map(|(number, condition)| {
            let there = others.iter().filter(alike).filter(|plan| plan.between == *condition).count();
            there + usize::from(number == given)
        });
        let counts: Vec<usize> = counts.collect();
        counts.iter().max().unwrap_or(&0) - counts.iter().min().unwrap_or(&0)
    };
    minimisation.covariates.iter().map(range).sum()
}

impl Minimisation {
    /// The questionnaires that have to be answered before a condition can be assigned.
    pub fn questionnaires(&self) -> impl Iterator<Item = &str> {
        self.covariates.iter().filter_map(|covariate| match &covariate.from {
            CovariateSource::Answer { questionnaire, .. } => Some(questionnaire.as_str()),
            CovariateSource::Link { .. } => None,
        })
    }

    /// The levels that a link with these parameters tells.
    #[must_use]
    pub fn told_by_link(&self, parameters: &BTreeMap<String, String>) -> BTreeMap<String, String> {
        let told = |covariate: &Covariate| match &covariate.from {
            CovariateSource::Link { parameter, levels } => {
                let given = parameters.get(parameter).map(String::as_str);
                let level = match given {
                    None => UNKNOWN,
                    Some(given) if levels.iter().any(|level| level == given) => given,
                    Some(_) => OTHER,
                };
                Some((covariate.name.clone(), level.to_owned()))
            }
            CovariateSource::Answer { .. } => None,
        };
        self.covariates.iter().filter_map(told).collect()
    }
}

/// The level that an answer is.
#[must_use]
pub fn level_of(item: &Item, cuts: &[i32], given: Option<&Given>) -> String {
    match (&item.form, given) {
        (Form::Choice(choices), Some(Given::Value(value))) => {
            let chosen = usize::try_from(*value).ok().and_then(|value| choices.get(value.checked_sub(1)?));
            chosen.cloned().unwrap_or_else(|| UNKNOWN.to_owned())
        }
        (Form::Scale(_), Some(Given::Value(value))) => {
            let (below, above) = (cuts.iter().rfind(|cut| **cut <= *value), cuts.iter().find(|cut| **cut > *value));
            match (below, above) {
                (None, None) => value.to_string(),
                (None, Some(above)) => format!("below {above}"),
                (Some(below), None) => format!("{below} or more"),
                (Some(below), Some(above)) => format!("{below} to below {above}"),
            }
        }
        _ => UNKNOWN.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use cohabit_dialog::Scale;
    use proptest::prelude::*;

    use super::*;

    fn minimisation(covariates: usize, certainty: f64) -> Minimisation {
        let covariate = |number: usize| Covariate {
            name: format!("c{number}"),
            from: CovariateSource::Link { parameter: format!("c{number}"), levels: Vec::new() },
        };
        Minimisation { covariates: (0..covariates).map(covariate).collect(), certainty }
    }

    fn conditions(count: usize) -> Vec<Vec<Choice>> {
        (0..count).map(|number| vec![Choice { factor: "b".to_owned(), level: number.to_string() }]).collect()
    }

    /// The plans of people whose covariates have these levels, one after the other.
    fn assigned(minimisation: &Minimisation, arms: usize, seed: u64, people: &[Vec<u8>]) -> Vec<Plan> {
        let conditions = conditions(arms);
        let mut plans = Vec::<Plan>::new();
        for (place, levels) in (1..).zip(people) {
            let own =
                levels.iter().enumerate().map(|(number, level)| (format!("c{number}"), level.to_string())).collect();
            let others: Vec<&Plan> = plans.iter().collect();
            let condition = minimise((minimisation, seed), &conditions, (place, &own), &others);
            plans.push(Plan { place, covariates: own, between: conditions[condition].clone(), ..Plan::default() });
        }
        plans
    }

    /// Of each level of each covariate, how many more there are in one condition than in another.
    fn ranges(plans: &[Plan], arms: usize) -> Vec<usize> {
        let mut counts = BTreeMap::<(&str, &str), Vec<usize>>::new();
        for plan in plans {
            let arm: usize = plan.between[0].level.parse().unwrap_or(0);
            for (name, level) in &plan.covariates {
                counts.entry((name, level)).or_insert_with(|| vec![0; arms])[arm] += 1;
            }
        }
        let range = |counts: &Vec<usize>| counts.iter().max().unwrap_or(&0) - counts.iter().min().unwrap_or(&0);
        counts.values().map(range).collect()
    }

    proptest! {
        #[test]
        fn one_covariate_is_spread_to_within_one(
            seed: u64, arms in 2_usize..5, people in prop::collection::vec(prop::collection::vec(0_u8..3, 1), 1..60),
        ) {
            let plans = assigned(&minimisation(1, 1.0), arms, seed, &people);
            prop_assert!(ranges(&plans, arms).iter().all(|range| *range <= 1), "{:?}", ranges(&plans, arms));
            prop_assert_eq!(plans, assigned(&minimisation(1, 1.0), arms, seed, &people));
        }

        #[test]
        fn several_covariates_are_spread_evenly(
            seed: u64, people in prop::collection::vec((0_u8..2, 0_u8..3, 0_u8..2), 60),
        ) {
            let people: Vec<Vec<u8>> = people.into_iter().map(|(a, b, c)| vec![a, b, c]).collect();
            let plans = assigned(&minimisation(3, 1.0), 2, seed, &people);
            // Of 60 people, at random, a level of half of them would differ by 6 or more in a third of all studies.
            prop_assert!(ranges(&plans, 2).iter().all(|range| *range <= 6), "{:?}", ranges(&plans, 2));
        }

        #[test]
        fn a_chance_is_left(seed: u64) {
            let people = vec![vec![0_u8]; 400];
            let plans = assigned(&minimisation(1, 0.8), 2, seed, &people);
            let arm = |plan: &Plan| plan.between[0].level == "0";
            let balanced = |before: &[Plan]| before.iter().filter(|plan| arm(plan)).count() * 2 == before.len();
            let (mut uneven, mut followed) = (0, 0);
            for (at, plan) in plans.iter().enumerate().filter(|(at, _)| !balanced(&plans[..*at])) {
                let in_first = plans[..at].iter().filter(|plan| arm(plan)).count();
                uneven += 1;
                followed += usize::from(arm(plan) == (in_first * 2 < at));
            }
            // Five standard errors of 0.8.
            let share = followed as f64 / f64::from(uneven);
            prop_assert!((share - 0.8).abs() < 5.0 * (0.16 / f64::from(uneven)).sqrt(), "{share} of {uneven}");
        }
    }

    #[test]
    fn levels_are_those_of_answers_and_links() {
        let item = |form| Item { ask: "?".to_owned(), form, optional: true, reversed: false };
        let scale = Scale { least: 1, most: 7, step: 1, left: String::new(), right: String::new() };
        let (scale, choice) = (item(Form::Scale(scale)), item(Form::Choice(vec!["yes".to_owned(), "no".to_owned()])));
        for (item, cuts, given, expected) in [
            (&scale, &[][..], Some(3), "3"),
            (&scale, &[3, 5][..], Some(2), "below 3"),
            (&scale, &[3, 5][..], Some(3), "3 to below 5"),
            (&scale, &[3, 5][..], Some(7), "5 or more"),
            (&scale, &[3][..], None, "unknown"),
            (&choice, &[][..], Some(2), "no"),
        ] {
            assert_eq!(level_of(item, cuts, given.map(Given::Value).as_ref()), expected);
        }
        let levels = vec!["delft".to_owned()];
        let covariate =
            Covariate { name: "site".to_owned(), from: CovariateSource::Link { parameter: "at".to_owned(), levels } };
        let minimisation = Minimisation { covariates: vec![covariate], certainty: 1.0 };
        for (given, expected) in [(Some("delft"), "delft"), (Some("x"), "other"), (None, "unknown")] {
            let parameters = given.map(|given| ("at".to_owned(), given.to_owned())).into_iter().collect();
            assert_eq!(minimisation.told_by_link(&parameters)["site"], expected);
        }
    }
}

//! An outcome fitted on conditions: by ordinary least squares where each session is an observation of its own, by a linear
//! mixed model ([`MixedModel`]) where some participant has several.

mod least_squares;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::{
    design::{Conditions, Design, level, numbers, parts},
    mixed::{Contrast, MixedModel, Ratio, WaldTest},
};

/// One session's outcome.
#[derive(Clone, Copy, Debug)]
pub struct Observation<'a> {
    /// The outcome, in its unit.
    pub value: f64,
    /// Whose session it was.
    pub participant: &'a str,
    /// What each condition was.
    pub conditions: &'a BTreeMap<String, String>,
}

/// How an outcome depends on the conditions, as a sum of what each does by itself and of the interactions asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Fit {
    /// The outcome.
    pub outcome: String,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// Sessions that have it.
    pub sessions: usize,
    /// The share of its variance that the conditions explain; nothing where it does not vary, or of a mixed model.
    pub r_squared: Option<f64>,
    /// The random intercept of the participants; nothing of least squares.
    pub random_intercept: Option<RandomIntercept>,
    /// The outcome where all conditions are at their reference, then what each other value adds, or each unit of a number.
    pub terms: Vec<Term>,
    /// Of each condition that is part of no interaction, and of each interaction: the joint test that it does nothing. With
    /// treatment coding the terms of a condition that interacts are its effect at the other's reference, so it has none.
    pub tests: Vec<ConditionTest>,
    /// Conditions that these sessions do not tell apart from those before them.
    pub left_out: Vec<String>,
    /// What a reader should know of these data.
    pub notes: Vec<String>,
    /// Why there is no fit, if there is none.
    pub reason: Option<String>,
}

/// What a condition does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// Which condition, and which value, against which.
    pub name: String,
    /// The estimate, in the outcome's unit.
    pub estimate: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Degrees of freedom: n − p of least squares, Satterthwaite's of a mixed model.
    pub freedom: f64,
    /// Estimate by standard error; nothing where there is no error.
    pub t: Option<f64>,
    /// Its 95 % interval, by Student's t.
    pub interval_95: [f64; 2],
    /// How probable as large an estimate were if it did nothing.
    pub p: f64,
}

/// Whether a condition does anything.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConditionTest {
    /// The condition, or the interaction.
    pub condition: String,
    /// The statistic F.
    pub f: f64,
    /// Degrees of freedom of the numerator and of the denominator.
    pub freedom: [f64; 2],
    /// How probable as large a statistic were if it did nothing.
    pub p: f64,
}

/// How participants differ from each other beside the conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RandomIntercept {
    /// Participants.
    pub participants: usize,
    /// Standard deviation of their intercepts, `σ_b`, in the outcome's unit.
    pub standard_deviation: f64,
    /// Standard deviation of the residuals, σ, in the outcome's unit.
    pub residual_standard_deviation: f64,
    /// The share of the variance that is between participants.
    pub intraclass_correlation: f64,
    /// The restricted log-likelihood (REML).
    pub log_likelihood: f64,
    /// Whether the search for the ratio of variances converged.
    pub converged: bool,
    /// Conditions that vary within participants.
    pub within: Vec<String>,
    /// Conditions that vary between participants alone.
    pub between: Vec<String>,
}

impl Fit {
    /// Fits a linear mixed model with a random intercept for each participant, by REML.
    #[must_use]
    pub fn mixed(outcome: &str, unit: &'static str, conditions: &[String], observed: &[Observation<'_>]) -> Self {
        let own: Vec<&Conditions> = observed.iter().map(|one| one.conditions).collect();
        let design = Design::new(conditions, &own);
        let mut fit = Self::empty(outcome, unit, observed.len(), &design);
        let mains: Vec<&String> = conditions.iter().filter(|name| parts(name, &own).is_none()).collect();
        fit.notes.extend(note_of_one_level(&mains, observed));
        let columns: Vec<Vec<f64>> = design.columns.iter().map(|column| column.values.clone()).collect();
        let values: Vec<f64> = observed.iter().map(|one| one.value).collect();
        match MixedModel::fit(&columns, &values, &numbered(observed)) {
            Ok(model) => fit.take(&model, &design, conditions, &own, &within(&mains, observed)),
            Err(error) => fit.reason = Some(error.to_string()),
        }
        fit
    }

    fn empty(outcome: &str, unit: &'static str, sessions: usize, design: &Design) -> Self {
        Self { outcome: outcome.to_owned(), unit, sessions, left_out: design.left_out.clone(), ..Self::default() }
    }

    fn take(
        &mut self,
        model: &MixedModel,
        design: &Design,
        conditions: &[String],
        own: &[&Conditions],
        within: &[(String, bool)],
    ) {
        self.terms = design
            .columns
            .iter()
            .enumerate()
            .map(|(place, column)| Term::new(&column.name, &model.effect(place)))
            .collect();
        self.tests = condition_tests(design, conditions, own, |places| model.test(places));
        let named = |wanted: bool| {
            within.iter().filter(|(_, varies)| *varies == wanted).map(|(name, _)| name.clone()).collect()
        };
        self.random_intercept = Some(RandomIntercept {
            participants: model.participants,
            standard_deviation: model.participant_sd,
            residual_standard_deviation: model.residual_sd,
            intraclass_correlation: model.intraclass_correlation(),
            log_likelihood: model.log_likelihood,
            converged: model.ratio != Ratio::NotConverged,
            within: named(true),
            between: named(false),
        });
        self.notes.extend(note_of_ratio(model.ratio).map(str::to_owned));
    }
}

impl Term {
    fn new(name: &str, contrast: &Contrast) -> Self {
        Self {
            name: name.to_owned(),
            estimate: contrast.estimate,
            standard_error: contrast.standard_error,
            freedom: contrast.freedom,
            t: Some(contrast.t).filter(|t| t.is_finite()),
            interval_95: contrast.interval_95,
            p: contrast.p,
        }
    }
}

/// A test of each condition that is part of no other one.
fn condition_tests(
    design: &Design,
    conditions: &[String],
    own: &[&Conditions],
    test: impl Fn(&[usize]) -> Option<WaldTest>,
) -> Vec<ConditionTest> {
    let interacting: BTreeSet<&str> = conditions.iter().filter_map(|name| parts(name, own)).flatten().collect();
    let alone = conditions.iter().enumerate().filter(|(_, name)| !interacting.contains(name.as_str()));
    alone
        .filter_map(|(place, name)| {
            let WaldTest { f, freedom, p } = test(&design.columns_of(place))?;
            Some(ConditionTest { condition: name.clone(), f, freedom, p })
        })
        .collect()
}

const fn note_of_ratio(ratio: Ratio) -> Option<&'static str> {
    match ratio {
        Ratio::Interior => None,
        Ratio::Boundary => Some("participants do not differ more than their own sessions do: this is least squares"),
        Ratio::NotConverged => Some("the search for the variance of participants did not converge: take it with care"),
        Ratio::NotRepeated => Some("no participant has two sessions: this is least squares"),
    }
}

/// Participants by number, in the order of their names.
fn numbered(observed: &[Observation<'_>]) -> Vec<usize> {
    let names: BTreeSet<&str> = observed.iter().map(|one| one.participant).collect();
    let number: BTreeMap<&str, usize> = names.into_iter().zip(0..).collect();
    observed.iter().map(|one| number[one.participant]).collect()
}

/// Of each condition, the levels that each participant met.
pub(crate) fn met<'a>(condition: &str, observed: &[Observation<'a>]) -> BTreeMap<&'a str, BTreeSet<&'a str>> {
    let mut met = BTreeMap::<_, BTreeSet<_>>::new();
    for one in observed {
        met.entry(one.participant).or_default().insert(level(one.conditions, condition));
    }
    met
}

/// Whether each condition varies within some participant.
fn within(conditions: &[&String], observed: &[Observation<'_>]) -> Vec<(String, bool)> {
    let varies = |name: &String| met(name, observed).values().any(|levels| levels.len() > 1);
    conditions.iter().map(|name| ((*name).clone(), varies(name))).collect()
}

/// Names those who met fewer levels of a condition that varies within participants than others did.
fn note_of_one_level(conditions: &[&String], observed: &[Observation<'_>]) -> Vec<String> {
    let own: Vec<&Conditions> = observed.iter().map(|one| one.conditions).collect();
    let note = |name: &&String| {
        let met = met(name, observed);
        let single: Vec<&str> =
            met.iter().filter(|(_, levels)| levels.len() == 1).map(|(participant, _)| *participant).collect();
        let is_mixed = numbers(name, &own).is_none() && !single.is_empty() && single.len() < met.len();
        is_mixed.then(|| format!("met one level of {name} only: {}", single.join(", ")))
    };
    conditions.iter().filter_map(note).collect()
}

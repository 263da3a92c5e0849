//! Missions made up at random for somebody simulated who speaks: of the twelve types of Alexa Arena's trajectory data set, drawn and
//! certified by the project's generator. Kept is what the robot solves by the expert's words, and in which people can tell all that
//! they want from all else.

mod script;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout};
use cohabit_engine::SessionPlan;
use cohabit_generate::{Chance, Generated, Order, Spec};
use cohabit_language::{Known, KnownObject, Language, Oracle};

use crate::{
    generate::script::script,
    lock_step::truth,
    meaning::Meaning,
    play::{Settings, play},
    simulated::expert,
    task::{Line, Task},
};

/// Drafts of one mission that are tried before its type is given up.
const MOST_DRAFTS: usize = 40;

/// Why no missions could be made.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// The expert solves none of a type.
    #[error("make missions: none of {MOST_DRAFTS} drafts of `{0}` with the seed {1} can be solved; try another seed")]
    Unsolved(String, u64),
    /// The expert's session failed.
    #[error("make missions: {0}")]
    Play(#[from] cohabit_record::LogError),
}

/// So many missions, all types in turn, with what the expert's words are about as their script. The same seed makes the same
/// missions.
///
/// # Errors
/// [`GenerateError`].
pub fn generate(count: usize, seed: u64, language: &Language) -> Result<Vec<Task>, GenerateError> {
    let spec = Spec::of_the_paper(language.catalog());
    (0..count).map(|number| one(number, seed, &spec, language)).collect()
}

fn one(number: usize, seed: u64, spec: &Spec, language: &Language) -> Result<Task, GenerateError> {
    let (kinds, layouts) = (spec.types().collect::<Vec<_>>(), Layout::builtin_ids());
    let kind = kinds[number % kinds.len()];
    let mut chance = Chance::new(seed, number as u64);
    for _ in 0..MOST_DRAFTS {
        let spec = spec.only(kind, &layouts[chance.below(layouts.len())]);
        let Some(mission) = draft(&spec, chance.number(), language.catalog()) else { continue };
        let cdf = mission.cdf.to_string();
        let Some(wanted) = wanted(&mission, &cdf, seed, language.catalog()) else { continue };
        let task = |script: Vec<Line>| Task {
            id: format!("{kind}-{number:04}"),
            family: Some(kind.to_owned()),
            cdf: cdf.clone(),
            preparation: Vec::new(),
            script,
        };
        let exact = wanted.iter().map(|meaning| Line::utterance(&expert(meaning))).collect();
        if play(&task(exact), &Settings::expert(seed), language)?.success {
            return Ok(task(wanted.into_iter().map(Line::Meant).collect()));
        }
    }
    Err(GenerateError::Unsolved(kind.to_owned(), seed))
}

/// A mission of the only type of a specification; none where chance has chosen what does not go together.
fn draft(spec: &Spec, seed: u64, catalog: &Arc<Catalog>) -> Option<Generated> {
    let (order, mut made) = (Order { count: 1, seed, workers: 1 }, None);
    cohabit_generate::generate(spec, catalog, order, &mut |mission| made = Some(mission)).ok()?;
    made
}

/// What people want in a mission, one thing at a time; none where they could not say it.
fn wanted(mission: &Generated, cdf: &str, seed: u64, catalog: &Arc<Catalog>) -> Option<Vec<Meaning>> {
    let plan = SessionPlan::new(&mission.kind, cdf, Arc::clone(catalog), seed).ok()?;
    let world = plan.build().ok()?;
    let (wanted, truth) = (script(&world, &mission.certificate.plan)?, truth(&world)?);
    let mut named = wanted.iter().flat_map(|meaning| meaning.object().into_iter().chain(meaning.target()));
    let is_clear = named.all(|instance| is_told_apart(instance, &truth, catalog));
    is_clear.then_some(wanted)
}

/// Whether people can tell a thing from all else of its name: it looks otherwise, or is elsewhere.
fn is_told_apart(instance: &str, truth: &Known, catalog: &Catalog) -> bool {
    let Some(object) = truth.objects.iter().find(|object| object.instance == instance) else { return false };
    let oracle = Oracle::new(catalog, truth);
    let told = oracle.reference(object.id);
    let name = |of: &KnownObject| catalog.class(of.class).name.as_str();
    let is_namesake = |other: &&KnownObject| other.id != object.id && name(other) == name(object);
    truth.objects.iter().filter(is_namesake).all(|other| oracle.reference(other.id) != told)
}

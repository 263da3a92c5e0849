//! Missions by the thousand for environments: made up, parted for training and tests; and the table of what can be done.

use cohabit_cdf::{ActionKind, mission};
use cohabit_generate::{Facets, Order, Spec, generate, part};
use pyo3::prelude::*;

use crate::{error::bad_argument, library::Library};

/// A mission's type, its floor plan, the rooms that its plan leads to, and the classes of the things that its goals are about.
type FacetTuple = (String, String, Vec<String>, Vec<String>);
/// An action on an object: its name, what people say for it, and how it is refused: statuses, each with a sentence.
type TableRow = (&'static str, Vec<String>, Vec<(String, String)>);

/// Lines of a file of missions, made up and solved once each; of these types alone, if any are given; with the packs in these
/// folders.
///
/// # Errors
/// A `ValueError` if there is no such type, or there are no more missions of one.
#[pyfunction]
#[pyo3(signature = (count, seed, types, blockers, workers, world=Vec::new()))]
pub fn generate_missions(
    py: Python<'_>,
    count: usize,
    seed: u64,
    types: Option<Vec<String>>,
    blockers: Option<f64>,
    workers: usize,
    world: Vec<String>,
) -> PyResult<Vec<String>> {
    py.detach(|| {
        let library = Library::with_packs(&world)?;
        let catalog = library.catalog();
        let mut spec = Spec::builtin(catalog);
        if let Some(types) = types {
            spec = spec.of_types("types", &types).map_err(bad_argument)?;
        }
        if let Some(share) = blockers {
            spec = spec.with_blockers(share);
        }
        let mut lines = Vec::new();
        let order = Order { count, seed, workers: workers.max(1) };
        let given_up = generate(&spec, catalog, order, &mut |mission| lines.push(mission.as_line().to_string()));
        given_up.map_err(bad_argument)?;
        Ok(lines)
    })
}

/// The name of the part that each mission belongs to, where each part but `train` gets about that share of them.
#[pyfunction]
pub fn part_missions(missions: Vec<FacetTuple>, share: f64, seed: u64) -> Vec<&'static str> {
    let facets = |(kind, floor_plan, rooms, things)| Facets { kind, floor_plan, rooms, things };
    let facets: Vec<Facets> = missions.into_iter().map(facets).collect();
    part(&facets, share, seed).parts.into_iter().map(cohabit_generate::Part::name).collect()
}

/// The names of the built-in missions.
#[pyfunction]
pub fn builtin_missions() -> Vec<&'static str> {
    mission::builtin().iter().map(|(file, _)| file.trim_end_matches(".json")).collect()
}

/// What can be done to objects, by the table of actions, with the packs in these folders.
///
/// # Errors
/// A `ValueError`, if a folder is no world pack.
#[pyfunction]
#[pyo3(signature = (world=Vec::new()))]
pub fn action_table(world: Vec<String>) -> PyResult<Vec<TableRow>> {
    let library = Library::with_packs(&world)?;
    let row = |kind: ActionKind| {
        let (mut words, mut refusals): (Vec<String>, Vec<(String, String)>) = Default::default();
        for rule in library.catalog().table().rules().iter().filter(|rule| rule.action == kind) {
            let new: Vec<String> = rule.words.iter().filter(|word| !words.contains(*word)).cloned().collect();
            words.extend(new);
            for need in &rule.needs {
                let refusal = (format!("{:?}", need.status), need.words.clone());
                if !refusals.contains(&refusal) {
                    refusals.push(refusal);
                }
            }
        }
        (kind.name(), words, refusals)
    };
    Ok(ActionKind::ALL.into_iter().map(row).collect())
}

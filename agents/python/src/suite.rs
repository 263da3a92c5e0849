//! Missions by the thousand for environments: made up, parted for training and tests; and the tools of a body.

use cohabit_agent::{Tool, ToolArgument, tools};
use cohabit_cdf::mission;
use cohabit_generate::{Facets, Order, Spec, generate, part};
use pyo3::prelude::*;

use crate::{error::bad_argument, library::Library};

/// A mission's type, its floor plan, the rooms that its plan leads to, and the classes of the things that its goals are about.
type FacetTuple = (String, String, Vec<String>, Vec<String>);
/// A tool: its name, what it does, and what it takes, if anything: the argument's name and, of a number, the lowest and the highest.
type ToolRow = (&'static str, String, Option<(&'static str, Option<(f64, f64)>)>);

/// Types of which missions were given up: how many, and why the last one was.
type GivenUpRow = (String, usize, String);

/// Lines of a file of missions, made up and solved once each; of these types alone, if any are given; with the packs in these
/// folders. Besides, which types missions were given up of.
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
) -> PyResult<(Vec<String>, Vec<GivenUpRow>)> {
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
        let given_up = given_up.map_err(bad_argument)?;
        Ok((lines, given_up.into_iter().map(|(kind, missed)| (kind, missed.count, missed.reason)).collect()))
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

/// The tools of a body, with the packs in these folders.
///
/// # Errors
/// A `ValueError`, if a folder is no world pack.
#[pyfunction]
#[pyo3(signature = (world=Vec::new()))]
pub fn body_tools(world: Vec<String>) -> PyResult<Vec<ToolRow>> {
    let library = Library::with_packs(&world)?;
    let row = |tool: Tool| {
        let argument = tool.deed.argument().map(|argument| match argument {
            ToolArgument::Object => ("object", None),
            ToolArgument::Number { name, low, high } => (name, Some((low, high))),
        });
        (tool.deed.name(), tool.description, argument)
    };
    Ok(tools(library.catalog().table()).into_iter().map(row).collect())
}

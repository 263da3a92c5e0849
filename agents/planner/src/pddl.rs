//! Missions as planning problems in PDDL, for other planners, and the plans that those find.
//!
//! The domain is that of one mission in one world: its actions are the table's, grounded to the things that matter for the goals.
//! An action is named after its kind, the thing that it is about, and its number, such as `pick_up-bowl_01_1-12`. Besides those
//! there are three kinds that no body does: `meet-N` notes that goal N is met, as a world does by itself; `work-N` has the machine
//! that action N has set going do its work, and `rest-N` has it go off. Reading a plan leaves them out ([`read_plan`]).
//!
//! What is set as a machine is switched on is set by `work-N`, together with what its work does: the conditions of both are those
//! from before it was on.

mod facts;
mod plan_file;
pub mod sexpr;
mod write;

use cohabit_cdf::{Mission, symbolic::SymbolicState};

use crate::{
    limits::Limits,
    plan::{PlanError, grounded},
    problem::{Deed, Problem},
    relaxed::Relaxed,
    search::{Found, search},
};

pub use self::plan_file::{PlanFileError, PlanLine, read_plan};

/// A mission in PDDL.
#[derive(Clone, Debug, PartialEq)]
pub struct Pddl {
    /// The domain file.
    pub domain: String,
    /// The problem file.
    pub problem: String,
    /// The plan that this project's own planner finds, an action a line, without those that no body does; or why there is none.
    pub plan: Result<String, PlanError>,
}

/// What exported files call a thing of this instance id, unless another one is called the same.
#[must_use]
pub fn name(instance: &str) -> String {
    facts::name(instance)
}

/// The mission called `name` in PDDL, from a state on; `met` says which goals are met already.
#[must_use]
pub fn export(name: &str, state: &SymbolicState, mission: &Mission, met: &[bool], limits: &Limits) -> Pddl {
    let mut grounder = grounded(state, mission, met);
    grounder.problem.keep_relevant(&grounder.tables);
    let facts = facts::Facts::new(&grounder);
    let name = facts::name(name);
    let (domain, problem) = (write::domain(&name, &facts), write::problem(&name, &facts));
    Pddl { domain, problem, plan: own_plan(&facts, limits) }
}

/// The plan that the search finds, by the names of actions.
fn own_plan(facts: &facts::Facts<'_>, limits: &Limits) -> Result<String, PlanError> {
    let problem: &Problem = facts.problem;
    let (found, effort) = search(problem, &Relaxed::new(problem), limits);
    let expanded = effort.expanded;
    match found {
        Found::Plan(operators) => {
            let acts = operators.iter().filter(|index| problem.operators[**index].deed != Deed::Nothing);
            Ok(acts.map(|index| format!("({})\n", facts.action(*index))).collect())
        }
        Found::OutOf(of) => Err(PlanError::GaveUp { of, expanded }),
        Found::Exhausted => Err(PlanError::NoPlan { expanded }),
    }
}

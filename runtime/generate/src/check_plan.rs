//! Plans of other planners, checked against the world: carried out in it, action by action.

use cohabit_cdf::{ActionKind, ObjectId};
use cohabit_planner::{pddl::PlanLine, steps_to};
use cohabit_world::World;

use crate::{
    certify::{run, wait},
    lock_step::BODY,
};

/// What came of a plan that the world accepts.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Accepted {
    /// Actions that were carried out, walks among them.
    pub actions: usize,
    /// The tick at which the last one was over.
    pub ticks: u64,
}

/// Why the world does not accept a plan.
#[derive(Clone, Debug, thiserror::Error, Eq, PartialEq)]
pub enum PlanProblem {
    /// It names what is not there.
    #[error(
        "line {line}: there is no `{thing}` in the world when the plan needs it; things are called as in the domain file"
    )]
    NoThing {
        /// Where in the plan, from 1.
        line: usize,
        /// What it names.
        thing: String,
    },
    /// An action is refused.
    #[error("line {line}: the world refuses `{action}` on {instance}: {reason}")]
    Refused {
        /// Where in the plan, from 1.
        line: usize,
        /// The kind of action.
        action: &'static str,
        /// What it is about.
        instance: String,
        /// The world's sentence about it.
        reason: String,
    },
    /// It ends too early.
    #[error("the plan ends, and goals are not met: {}", .goals.join("; "))]
    OpenGoals {
        /// Their numbers and descriptions.
        goals: Vec<String>,
    },
}

/// Carries a plan out. The body goes to each thing that it does not hold, and waits for each machine that it sets going; what
/// comes after the last goal is met is left out.
///
/// # Errors
/// [`PlanProblem`] names the line of the plan.
pub fn check_plan(world: &mut World, plan: &[PlanLine]) -> Result<Accepted, PlanProblem> {
    let mut actions = 0;
    for PlanLine { line, kind, thing } in plan {
        if world.finished().is_some() {
            break;
        }
        let Some(id) = find(world, thing) else {
            return Err(PlanProblem::NoThing { line: *line, thing: thing.clone() });
        };
        for step in steps_to(&world.symbols(BODY), *kind, id) {
            run(world, step.action).map_err(|reason| refused(world, *line, *kind, id, reason))?;
            wait(world, &step);
            actions += 1;
        }
    }
    let open = world.goals().into_iter().filter(|goal| !goal.met);
    let goals: Vec<String> = open.map(|goal| format!("{} ({})", goal.id, goal.description)).collect();
    if goals.is_empty() { Ok(Accepted { actions, ticks: world.tick() }) } else { Err(PlanProblem::OpenGoals { goals }) }
}

fn refused(world: &World, line: usize, kind: ActionKind, id: ObjectId, reason: String) -> PlanProblem {
    let instance = world.object(id).map_or("?", |view| view.instance).to_owned();
    PlanProblem::Refused { line, action: kind.name(), instance, reason }
}

/// The thing that the domain calls so.
fn find(world: &World, thing: &str) -> Option<ObjectId> {
    let named = |view: &cohabit_world::ObjectView<'_>| cohabit_planner::pddl::name(view.instance) == thing;
    world.objects().filter(|view| world.exists(view.id)).find(named).map(|view| view.id)
}

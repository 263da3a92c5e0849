//! A planner for the goals of a mission: symbolic state and goals in, actions out, or the goal that cannot be reached
//! and why.
//!
//! The table of actions and devices is grounded to the things that matter for the goals (the module `problem` is what comes of
//! that), and searched greedily, best first, by the length of a plan that ignores what actions undo. A device or an
//! action that the table has is planned with: nothing here knows one by name. It knows no geometry: a plan goes to each
//! thing before it acts on it, and waits for each machine that it sets going.
//!
//! An [`Executor`] carries plans out step by step, and plans anew when an action fails or the world is not as expected.
//! [`pddl`] writes problems down for other planners, and reads their plans.

mod cnf;
mod effects;
mod executor;
mod explain;
mod goals;
mod ground;
mod limits;
mod matter;
mod operators;
pub mod pddl;
mod plan;
mod problem;
mod relaxed;
mod search;

pub use executor::{Executor, Failure, GivenUp, Next};
pub use limits::Limits;
pub use plan::{Plan, PlanError, Step, plan, plan_without, steps_to};

//! Missions by the thousand: drawn from a specification, checked, solved by the planner, carried out in a world.
//!
//! A [`Spec`] has types of missions as templates. [`generate`] draws from them: the same seed makes the same missions, on any
//! machine and with any number of workers. A [`Generated`] mission carries its plan and a certificate: the digest of the world
//! in which the plan met all goals. [`part`] parts missions for training and for tests of what was never seen in training.
//!
//! Worlds are driven in lock-step: [`carry_out`] has one command carried out, an [`ExpertPlay`] plays a mission to its goals, and an
//! [`Observer`] hears of each tick.

mod certify;
mod chance;
mod check_plan;
mod draft;
mod generate;
mod instructions;
mod lock_step;
mod side_by_side;
mod spec;
mod splits;
mod things;

pub use certify::{Certificate, PlannedStep, certify, world_of};
pub use chance::Chance;
pub use check_plan::{Accepted, PlanProblem, check_plan};
pub use draft::Blocker;
pub use generate::{GenerateError, Generated, GivenUp, Order, generate};
pub use instructions::instruction;
pub use lock_step::{ExpertPlay, Observer, carry_out, tick};
pub use side_by_side::side_by_side;
pub use spec::{BlockerKind, Spec, SpecError};
pub use splits::{Facets, HeldOut, Part, Parted, part};
pub use things::{is_container, is_thing};

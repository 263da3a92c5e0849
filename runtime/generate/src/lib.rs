//! Missions by the thousand: drawn from a specification, checked, solved by the planner, carried out in a world.
//!
//! A [`Spec`] has types of missions as templates. [`generate`] draws from them: the same seed makes the same missions, on any
//! machine and with any number of workers. A [`Generated`] mission carries its plan and a certificate: the digest of the world
//! in which the plan met all goals.

mod certify;
mod chance;
mod check_plan;
mod draft;
mod generate;
mod instructions;
mod spec;

pub use certify::{Certificate, certify};
pub use check_plan::{Accepted, PlanProblem, check_plan};
pub use generate::{GenerateError, Generated, GivenUp, Order, generate};
pub use spec::{Spec, SpecError};

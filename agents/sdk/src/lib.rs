//! The mind of a body: an [`Agent`] hears what is said and what came of its deeds, and decides what to do next.
//!
//! An agent cannot tell whether it runs in the simulator's process or beside it: [`run`] connects it to any transport.
//! [`Eyes`] look through a camera: planes in place, and a list of what is seen by name.
//!
//! This crate never knows the world's insides: an agent acts by commands and learns by outcomes.

mod agent;
mod eyes;
mod past;
mod peer;
mod plan_follower;

pub use agent::{Agent, Deed, Heard};
pub use eyes::{Eyes, Glance, SeenThing};
pub use peer::{PeerError, run};
pub use plan_follower::PlanFollower;

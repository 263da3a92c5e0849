//! The mind of a body: an [`Agent`] hears what is said and what came of its deeds, and decides what to do next.
//!
//! An agent cannot tell whether it runs in the simulator's process or beside it: [`run`] connects it to any transport.
//! Who rather asks than is asked uses a [`Client`]: it claims a body, commands it, and waits for outcomes and turns.
//! [`Eyes`] look through a camera: planes in place, and a list of what is seen by name.
//!
//! This crate never knows the world's insides: an agent acts by commands and learns by outcomes.

mod agent;
mod client;
mod eyes;
mod past;
mod peer;
mod plan_follower;

pub use agent::{Agent, Deed, Heard, Now, Senses};
pub use client::{Client, Outcome, outcome};
pub use eyes::{Eyes, Glance, InView, SeenThing, Sight};
pub use peer::{PeerError, run, wait_for_mission};
pub use plan_follower::PlanFollower;

//! The mind of a body: an [`Agent`] hears what is said and what came of its deeds, and decides what to do next.
//!
//! An agent cannot tell whether it runs in the simulator's process or beside it: [`run`] connects it to any transport.
//! Who rather asks than is asked uses a [`Client`]: it claims a body, commands it, and waits for outcomes and turns.
//! [`Eyes`] look through a camera: planes in place, and a list of what is seen by name.
//!
//! Five kinds of agents are whole: [`PlanFollower`] does what the dialog service plans, [`Scripted`] what a file says,
//! [`Random`] anything, [`Helper`] keeps the office in order by what its own camera shows, and [`Expert`] plays a mission to its
//! goals with a planner.
//!
//! A [`Crowd`] is many at once: pedestrians who walk by social forces, to where a [`Schedule`] has them go.
//!
//! [`tools`] describes what a body can be told to do to whoever plays it by calls, as language models do.
//!
//! This crate never knows the world's insides: an agent acts by commands and learns by outcomes. In lock-step it hears
//! and acts in its turns alone, so what comes of it depends neither on the machine nor on where it runs.
//!
//! A world in this process, with an agent in a thread of its own:
//!
//! ```
//! # use std::{sync::{Arc, atomic::{AtomicBool, Ordering}}, thread};
//! use cohabit_agent::Random;
//! use cohabit_bus::{Local, Topic, Transport, Wake};
//! use cohabit_engine::{SessionPlan, Simulator};
//! # use cohabit_cdf::{Catalog, mission};
//! # use cohabit_render::{CpuRenderer, MeshLibrary};
//! # let catalog = Arc::new(Catalog::builtin());
//! # let (file, text) = mission::builtin()[0];
//! # let meshes = Arc::new(MeshLibrary::build(&catalog)?);
//! let (bus, stop) = (Local::new(1), AtomicBool::new(false));
//! let plan = SessionPlan::new(file, text, catalog, 7)?.in_lock_step(1);
//! let simulator = Simulator::new(&plan, plan.build()?, meshes, Box::new(CpuRenderer::new(1)), &bus)?;
//! let mut ticks = bus.subscriber(Topic::Ticks)?;
//! let mut bell = bus.listener(Wake::State)?;
//! thread::scope(|scope| {
//!     scope.spawn(|| simulator.run(&stop));
//!     scope.spawn(|| cohabit_agent::run(&mut Random::new(7), 0, &bus, &stop));
//!     while ticks.latest()?.is_none_or(|sample| sample.envelope().tick < 60) {
//!         bell.wait(std::time::Duration::from_millis(100))?;
//!     }
//!     stop.store(true, Ordering::Relaxed);
//!     Ok::<(), cohabit_bus::BusError>(())
//! })?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod affordance;
mod agent;
mod client;
mod errand;
mod error;
mod expert;
mod eyes;
mod helper;
mod memory;
mod past;
mod pedestrian;
mod peer;
mod plan_follower;
mod random;
mod script;
mod scripted;
mod symbols;
mod tool;

pub use agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND};
pub use client::{Client, Outcome, outcome};
pub use errand::{Errand, Progress};
pub use error::PeerError;
pub use expert::Expert;
pub use eyes::{Eyes, Glance, InView, SeenThing, Sight};
pub use helper::Helper;
pub use pedestrian::{Crowd, Floor, Paths, Schedule, ScheduleError};
pub use peer::{run, run_in, wait_for_mission};
pub use plan_follower::PlanFollower;
pub use random::Random;
pub use script::{Script, ScriptError};
pub use scripted::Scripted;
pub use tool::{Tool, ToolArgument, ToolDeed, tools};

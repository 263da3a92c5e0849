//! The tick: takes commands from the bus, steps the world, publishes what came of it, and has cameras rendered.
//!
//! In real time the world never waits for anybody: [`Simulator::run`] steps it 60 times a second, or as often as is asked
//! for, and a thread of its own renders the newest scene. In lock-step it waits for each agent that attends. Who steps an [`Engine`] itself takes pictures with [`Stills`], when it wants them. Fed
//! from a log instead of a bus, the same world replays a session, all of it ([`replay`](replay::replay)) or step by step
//! ([`Replayer`]).
//!
//! This crate never knows dialog.

mod appearance;
mod attendance;
mod build;
mod camera_plan;
mod camera_rig;
mod commanders;
mod engine;
mod exposure;
mod intake;
mod motion;
mod pace;
mod projector;
pub mod replay;
pub mod report;
mod scene;
mod shot;
mod simulator;
pub mod snapshot;
mod standing;
mod stills;
mod stopwatch;
mod studio;
mod world_folder;

pub use appearance::{Appearance, HIGHLIGHT_TICKS, Visible};
pub use build::{BuildError, SessionPlan};
pub use camera_plan::{CameraPlan, CameraPlanError, Mount};
pub use engine::{Engine, EngineError};
pub use projector::{Projector, ProjectorError};
pub use replay::{ReplayError, Replayer};
pub use scene::{body_instance_id, furnishings, object_instance_id};
pub use simulator::Simulator;
pub use snapshot::RestoreError;
pub use stills::Stills;
pub use world_folder::{WorldFolderError, read_world_folder, world_folder_files};

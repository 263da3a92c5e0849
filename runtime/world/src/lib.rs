//! The simulated office: what is in it, what can be done to it, and what follows, one fixed tick at a time.
//!
//! A [`World`] is built once from a catalogue, a floor plan and a mission, and then changes only through
//! [`World::step`]: commands in, outcomes and events out. The same inputs at the same ticks give the same
//! [`World::digest`], bit for bit, on every machine of one architecture; a [`World::snapshot`] goes on as the original
//! would have.
//!
//! This crate never knows wall time, threads, sockets, files or pixels. Trigonometry in simulated state comes from
//! `libm` alone, and nothing here iterates a hash map.
//!
//! ```
//! use std::sync::Arc;
//! use cohabit_cdf::{Action, BodyId, Catalog, GoToTarget, Layout, mission};
//! use cohabit_world::{Input, World};
//!
//! let catalog = Arc::new(Catalog::builtin());
//! let (name, text) = mission::builtin().first().expect("there are built-in missions");
//! let mission = mission::read_mission(name, text, &catalog).expect("they are sound").mission;
//! let layout = Arc::new(Layout::builtin(&mission.layout).expect("they name a floor plan"));
//! let mut world = World::new(catalog, layout, Arc::new(mission), 1).expect("and can be built");
//!
//! let table = world.find("TableRound_02_1").expect("the break room has a table");
//! let walk = Action::GoTo { target: GoToTarget::Object(table) };
//! let mut report = world.step(&[Input { command: 1, body: BodyId(0), action: walk }]);
//! while report.outcomes.is_empty() {
//!     report = world.step(&[]);
//! }
//! assert!(report.outcomes[0].status.is_success());
//! ```
//!
//! Frames: see the docs of `cohabit-cdf`; angles are in radians, positive yaw is to the left.
//!
//! Its modules form layers; each knows those of its own layer in no circle, and lower ones:
//! 1. data: `geometry`, `swing`, `floor`, `kinematics`, `body`, `report`, `run`, `entity`, `effect`, `mission_state`, `solver`, `state`
//! 2. readings and motion: `facts`, `reach`, `sight`, `anchors`, `power`, `pushable`, `navigation`, `approach`, `physics`, `motion`, `drive`
//! 3. what follows, pure: the `works` of machines, the `rules` of commands, `goals`, the `story`, the `score`
//! 4. changes: `apply` makes them, `build` makes the first state; `digest`, `snapshot` and `difference` read all of it
//! 5. the `world`, and what goes on in it: `tasks`, `avoid`, `passage`, `push`; `symbols` of it for planners

mod anchors;
mod apply;
mod approach;
mod avoid;
mod body;
mod build;
mod difference;
mod digest;
mod drive;
mod effect;
mod entity;
mod facts;
mod floor;
mod geometry;
mod goals;
mod kinematics;
mod mission_state;
mod motion;
mod navigation;
mod passage;
mod physics;
mod power;
mod push;
mod pushable;
mod reach;
mod report;
mod rules;
mod run;
mod score;
mod sight;
mod snapshot;
mod solver;
mod state;
mod story;
mod swing;
mod symbols;
mod tasks;
mod works;
mod world;

pub use body::BodyView;
pub use build::BuildError;
pub use cohabit_cdf::{Action, BodyId, BodyKind, GoToTarget, ObjectId, Status, Verb};
pub use digest::{DIGEST_PART_BYTES, DIGEST_PARTS};
pub use entity::ObjectView;
pub use glam::{Quat, Vec2, Vec3};
pub use goals::GoalStatus;
pub use report::{CameraTarget, Ending, Event, Input, Outcome, Report, SoundKind};
pub use snapshot::SnapshotError;
pub use world::{DT_NANOS, Phase, World};

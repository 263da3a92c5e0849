//! Floor plans made at random: offices and homes, furnished, in the format of world packs.
//!
//! [`FloorPlans`] draws each plan from a seed and the plan's number alone, so that a plan does not depend on how many there are or
//! who makes them. A plan is drawn in steps, each of which knows those before it alone: which rooms there are (`program`), an outline with a
//! hallway where there are many (`outline`), the floor divided into rooms (`rooms`), doors and windows (`openings`), light switches and
//! fuse boxes (`fixtures`), furniture (`furniture`), small things (`things`), where to stand and where notes can be stuck (`places`). What
//! comes of it is checked by `cohabit-cdf` as every floor plan is; a plan with a fault is drawn anew.
//!
//! What rooms there are and what is in them stands in tables: in `data/office` and `data/home`. Offices have built-in classes alone; homes
//! have those of the world pack that comes with the program as [`Kind::pack`] besides, so their plans are read with it.
//!
//! What builds floor plans from something else than chance takes the same [`parts`].
//!
//! ```
//! use cohabit_floorplans::{FloorPlans, Kind};
//!
//! let plan = FloorPlans::new(Kind::Home, 3, 7)?.plan(0)?;
//! assert_eq!(plan.rooms.len(), 3);
//! # Ok::<(), cohabit_floorplans::PlanError>(())
//! ```

mod chance;
mod draft;
mod fixtures;
mod furniture;
mod geometry;
mod ground;
mod kind;
mod openings;
mod outline;
pub mod pack;
pub mod parts;
mod places;
mod plans;
mod program;
mod rooms;
mod text;
mod things;

pub use kind::{Kind, UnknownKind};
pub use plans::{FloorPlan, FloorPlans, PlanError};

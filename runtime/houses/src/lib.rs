//! Houses of ProcTHOR (the JSON of houses of AI2-THOR) as floor plans.
//!
//! [`Importer::plan`] reads the text of one house. Its rooms go to a lattice of 0.1 m (`lattice`) and become rectangles (`polygon`), with
//! doors, passages and windows in their walls (`openings`); the bare floor is the `shell`. A table says which class of the pack `homes`
//! stands for each type of object (`types`); nothing of AI2-THOR's assets is taken over. What stands on the floor goes to the nearest place
//! where there is room for it and it is in nobody's way (`poses`, `furnish`, `walk`), what lies on it to a free place there. The [`Report`] counts
//! what is left out, by type and reason. A plan is handed out only if the check of floor plans finds nothing in it.
//!
//! The same house always makes the same plan. Text in, text out: this crate knows no files.
//!
//! ```
//! use cohabit_houses::Importer;
//!
//! let house = r#"{ "rooms": [{ "id": "room|1", "roomType": "Bedroom", "floorPolygon": [
//!     { "x": 0, "y": 0, "z": 0 }, { "x": 0, "y": 0, "z": 4 }, { "x": 5, "y": 0, "z": 4 }, { "x": 5, "y": 0, "z": 0 } ] }],
//!     "objects": [{ "id": "Bed|1|0", "position": { "x": 2.5, "y": 0.4, "z": 1 }, "rotation": { "y": 0 } }] }"#;
//! let plan = Importer::default().plan("Thor0000", house)?;
//! assert_eq!((plan.report.rooms, plan.report.placed), (1, 1));
//! # Ok::<(), cohabit_houses::HouseError>(())
//! ```

mod error;
mod furnish;
mod house;
mod importer;
mod json;
mod lattice;
mod names;
mod openings;
pub mod pack;
mod polygon;
mod poses;
mod report;
mod shell;
mod types;
mod walk;

/// The longest text of a house, bytes.
pub const MOST_BYTES: usize = 8 * 1024 * 1024;

pub use error::HouseError;
pub use importer::{ImportedPlan, Importer};
pub use report::{LeftOut, Reason, Report};

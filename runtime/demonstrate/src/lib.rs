//! Demonstrations: missions played by the expert, written down step by step, with what the robot sees.
//!
//! [`demonstrate`] turns missions into a data set in a folder. Each episode is a folder of its own: `steps.jsonl` has a line for
//! each step, with the state before it, the action, instructions for it in several styles, questions about them with an oracle's
//! answers, and what came of it; `frames/` has what the robot sees before it. An episode appears once it is whole, and `manifest.json` once all are, so whoever is interrupted
//! goes on where they were. The same missions and the same recipe give the same bytes, with any number of workers.
//!
//! What each file has stands in `data/card.md`, which goes into the data set's `README.md`, behind how it was made and how much there is.

mod camera;
mod card;
mod dataset;
mod episode;
mod error;
mod instruction;
mod objects;
mod picture;
mod question;
mod recipe;
mod step;
mod summary;
mod truth;

pub use dataset::{demonstrate, write_whole};
pub use error::DemonstrateError;
pub use objects::ObjectEntry;
pub use picture::write_plane;
pub use recipe::{MissionText, Recipe};
pub use summary::Summary;

//! Missions played headless and in lock-step: what is said goes through the real dialog and agent code into the world,
//! and what came of it is counted.
//!
//! A [`Task`] is a mission with what its people say. [`read_tasks`] finds tasks in the formats that missions come in;
//! [`play`] plays one to its end by what is said, [`solve`] by the expert, from its goals alone; a [`Report`] sums many up. [`pool::run`] spreads them over worker processes.
//!
//! Nothing here is special to a mission, and nothing renders. Time is the world's own: nobody thinks while it runs.

mod dataset;
mod family;
mod generate;
mod lock_step;
mod meaning;
mod play;
pub mod pool;
mod report;
mod script;
mod simulated;
mod solve;
mod source;
pub mod steps;
mod task;
mod trace;
mod trajectory;

pub use generate::{GenerateError, generate};
pub use lock_step::LockStep;
pub use meaning::Meaning;
pub use play::{Caps, Played, Said, Settings, Trouble, play};
pub use report::{Report, Tally};
pub use simulated::Style;
pub use solve::solve;
pub use source::{SourceError, read_missions, read_tasks};
pub use task::{Answer, Line, Task};

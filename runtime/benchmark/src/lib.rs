//! A benchmark: the same missions for everybody, submissions that anybody can verify, and a table of them.
//!
//! A [`Benchmark`] is a file of a few lines. Its missions follow from it alone, and have the digest that it names. [`run`] has an
//! agent play those of validation and test, and writes a submission: a header, and a line for each [`Episode`] with all commands
//! that its robot took. [`verify`] plays the commands again in worlds of its own, and names each figure that differs. The
//! [`grids`] of several submissions are a leaderboard, with what the paper on Alexa Arena reports beside it.
//!
//! No figure is taken from an agent or its driver: each follows from commands that are played again, when a submission is
//! written as when it is verified. So whatever leaves a session log can be scored ([`recordings`]), and [`random`] is an agent
//! of a few lines.
//!
//! This crate never knows dialog, pictures or processes: how an agent plays a mission is a function that it is given.

mod benchmark;
mod draft;
mod episode;
mod error;
mod kept;
mod logs;
mod mission;
mod page;
mod paper;
mod random;
mod replay;
mod run;
mod submission;
mod table;
mod totals;
mod verify;

pub use benchmark::{Benchmark, BenchmarkError, Making};
pub use episode::{Caps, Episode, EpisodeEnd, Recording, TickInputs};
pub use error::RunError;
pub use logs::{LogsError, Recordings, recording, recordings};
pub use mission::{Instruction, Mission, Split};
pub use page::page;
pub use paper::{Paper, PaperMethod, PaperVision};
pub use random::random;
pub use replay::play_again;
pub use run::{Play, run};
pub use submission::{AgentCard, Header, Line, Submission, SubmissionError};
pub use table::{Check, Entry, Grid, grids, text};
pub use totals::{SplitTotals, Tally, Totals, totals};
pub use verify::{Difference, verify};

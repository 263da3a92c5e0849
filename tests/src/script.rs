//! A page of README or the guide as a script: from top to bottom it writes the files that it shows, and types its commands.
//!
//! What a block is stands behind its language, where renderers of Markdown show nothing of it:
//!
//! | the line that begins a block | what is done |
//! |---|---|
//! | `sh` | its lines are typed, one after the other |
//! | `sh needs: python` | the same, where the runner has that |
//! | `sh not-run: REASON` | nothing; the reason is told |
//! | `toml study.toml` | it is written into that file |
//! | `toml added-to: study.toml` | it is written to the end of that file |
//! | `toml part-of: study.toml` | it is compared with that file, which has these lines |
//! | `rust not-run: REASON` | nothing; the reason is told |
//! | `text`, `bibtex` | nothing: it is shown |
//!
//! All blocks that are no command lines and no plain text have to say which file they are of, and each file is used: a command, or
//! another file of the page, names it.

mod blocks;
mod part;
mod place;
mod runner;
mod service;
mod started;

pub use blocks::{Block, Role, blocks};
pub use runner::{NotRun, Runner, Told};

//! Why a benchmark is not played to its end.

use std::{io, path::PathBuf};

/// Why a submission was not made.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// There is another file.
    #[error("{path}: it is there already, and is not of this run; name another file, or remove it")]
    Exists {
        /// Which.
        path: PathBuf,
    },
    /// What was interrupted was another run.
    #[error(
        "{path}: what was begun here is of another agent, other settings, another benchmark or another version of the program; \
         name another file, or remove it"
    )]
    OtherRun {
        /// Its file.
        path: PathBuf,
    },
    /// What was interrupted is damaged.
    #[error("{path}:{line}: not as it was written: {reason}; remove the file to begin anew")]
    Damaged {
        /// Its file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A mission was not played.
    #[error("{mission}: {reason}")]
    Mission {
        /// Which.
        mission: String,
        /// Why.
        reason: String,
    },
    /// A recording does not lead to where it did when it was made.
    #[error(
        "{mission}: at tick {tick} its state is not the recorded one; it was recorded by another program: play it with this one"
    )]
    Differs {
        /// The mission.
        mission: String,
        /// The tick.
        tick: u64,
    },
}

impl RunError {
    /// Whether another call would mend it, rather than the same one later.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Exists { .. } | Self::OtherRun { .. } | Self::Damaged { .. } | Self::Differs { .. } => true,
            Self::File { .. } | Self::Mission { .. } => false,
        }
    }
}

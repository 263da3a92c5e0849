//! Why a data set cannot be annotated.

use std::{
    io,
    path::{Path, PathBuf},
};

use cohabit_convert::ConvertError;

/// Why a data set cannot be annotated.
#[derive(Debug, thiserror::Error)]
pub enum AnnotateError {
    /// It is no finished data set, or an episode is not whole.
    #[error(transparent)]
    Dataset(#[from] ConvertError),
    /// A file or folder cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Somebody else writes there.
    #[error("{path} is in use by another `cohabit annotate`: end that one first")]
    Busy {
        /// The journal.
        path: PathBuf,
    },
    /// A line is none of a journal.
    #[error("{path}:{line}: {reason}; the lines before it are intact: mend or remove this one")]
    Line {
        /// The journal.
        path: PathBuf,
        /// Which, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The data set lacks what annotators need.
    #[error("{path}: {reason}")]
    Unfit {
        /// The data set.
        path: PathBuf,
        /// What it lacks, and what helps.
        reason: String,
    },
    /// A file is not what it should be.
    #[error("{path}: {reason}")]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong with it, and what helps.
        reason: String,
    },
    /// The annotators cannot be these.
    #[error("{0}")]
    Annotators(String),
}

impl AnnotateError {
    /// Whether the same call fails again: the arguments or the data set are wrong, not the machine.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Dataset(error) => error.is_bad_input(),
            Self::File { .. } | Self::Busy { .. } => false,
            Self::Line { .. } | Self::Unfit { .. } | Self::Damaged { .. } | Self::Annotators(_) => true,
        }
    }
}

/// Says which file an error of the system is about.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> AnnotateError + use<> {
    let path = path.to_owned();
    move |source| AnnotateError::File { path, source }
}

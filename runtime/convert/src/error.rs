//! Why a data set cannot be converted.

use std::{
    io,
    path::{Path, PathBuf},
};

use cohabit_parquet::ParquetError;

/// Why a data set cannot be converted.
#[derive(Debug, thiserror::Error)]
pub enum ConvertError {
    /// A file or folder cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A table cannot be written.
    #[error("{path}: {source}")]
    Table {
        /// Which.
        path: PathBuf,
        /// Why.
        source: ParquetError,
    },
    /// What is to be converted is no finished data set of demonstrations.
    #[error("{path}: this is no finished data set of `cohabit demonstrate`: {reason}")]
    NoDataset {
        /// Where the data set was to be.
        path: PathBuf,
        /// What is missing or wrong.
        reason: String,
    },
    /// A line of the data set is not what it should be.
    #[error("{path}, line {line}: {reason}; remove the episode's folder, and `cohabit demonstrate` makes it anew")]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A file of the data set is not what it should be.
    #[error("{path}: {reason}; remove the episode's folder, and `cohabit demonstrate` makes it anew")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The data set lacks what the format needs.
    #[error("{path}: {reason}")]
    Unfit {
        /// The data set.
        path: PathBuf,
        /// What it lacks, and what helps.
        reason: String,
    },
    /// Something is where the converted data set is to be.
    #[error("{path}: it is there already; name another folder, or remove it")]
    Exists {
        /// Where.
        path: PathBuf,
    },
}

impl ConvertError {
    /// Whether the same call fails again: the arguments or the data set are wrong, not the machine.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::File { source, .. } => source.kind() == io::ErrorKind::NotFound,
            Self::Table { .. } => false,
            Self::NoDataset { .. }
            | Self::Line { .. }
            | Self::Damaged { .. }
            | Self::Unfit { .. }
            | Self::Exists { .. } => true,
        }
    }
}

/// Says which file an error of the system is about.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> ConvertError + use<> {
    let path = path.to_owned();
    move |source| ConvertError::File { path, source }
}

/// Says which table an error is about.
pub(crate) fn in_table(path: &Path) -> impl FnOnce(ParquetError) -> ConvertError + use<> {
    let path = path.to_owned();
    move |source| ConvertError::Table { path, source }
}

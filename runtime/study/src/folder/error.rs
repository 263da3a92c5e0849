//! Why a study's folder cannot be used.

use std::{io, path::PathBuf};

use crate::journal::JournalError;

/// Why a study's folder cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The system refuses something in it.
    #[error("{path}: {source}")]
    File {
        /// What.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Other users can reach it.
    #[error("{path} can be reached by other users: chmod 700 {path}, or choose another folder")]
    Open {
        /// The folder.
        path: PathBuf,
    },
    /// The study was another one when its first participant came.
    #[error(
        "{path} holds data of another study: {file} was another one when the first participant came (see {path}/study); \
         choose another folder, or put it back as it was"
    )]
    OtherStudy {
        /// The folder.
        path: PathBuf,
        /// What differs.
        file: String,
    },
    /// It is in use.
    #[error("{path} is in use by another `cohabit study`: end that one first")]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// There is no study in it.
    #[error("{path} holds no study: name the folder that was given to `cohabit study run`")]
    NoStudy {
        /// The folder.
        path: PathBuf,
    },
    /// Nobody of that name takes part.
    #[error("{path} holds nothing of `{pseudonym}`: those in it are {known}")]
    NoParticipant {
        /// The folder.
        path: PathBuf,
        /// Who was asked for.
        pseudonym: String,
        /// Who is there.
        known: String,
    },
    /// Somebody has withdrawn, and their data are still there.
    #[error(
        "{path}: {pseudonym} has withdrawn, and their data are not removed yet: wait until their session has ended, or run \
         `cohabit study withdraw {pseudonym} --folder {path}`"
    )]
    Leaving {
        /// The folder.
        path: PathBuf,
        /// Who.
        pseudonym: String,
    },
    /// What is no copy of a study is where that would be.
    #[error(
        "{path} holds files that no study put there, and copies of the study's would replace them: choose another `--folder`"
    )]
    Foreign {
        /// Where they are.
        path: PathBuf,
    },
    /// Programs played those whose data are in it.
    #[error(
        "{path} holds a dry run (see {path}/synthetic.json), which is never mixed with people's data: choose another folder, or \
         remove this one"
    )]
    Synthetic {
        /// The folder.
        path: PathBuf,
    },
    /// There is something in it.
    #[error(
        "{path} is not empty, and a dry run is never mixed with people's data: name a folder that does not exist yet"
    )]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },
    /// A journal cannot be read.
    #[error(transparent)]
    Journal(#[from] JournalError),
}

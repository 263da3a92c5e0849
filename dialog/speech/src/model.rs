//! The model in a folder: which it is, is told by what its encoder takes.

use std::path::Path;

use crate::{
    Recognizer, SpeechError,
    model_file::Parts,
    moonshine::{self, Moonshine},
    onnx,
    speller::Speller,
    whisper::{self, Whisper},
};

/// Opens the model in a folder; `library` is the runtime's.
///
/// # Errors
/// [`SpeechError::Missing`] or [`SpeechError::Broken`].
pub(crate) fn open(folder: &Path, library: &Path, threads: usize) -> Result<Box<dyn Recognizer>, SpeechError> {
    let parts = Parts::find(folder)?;
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

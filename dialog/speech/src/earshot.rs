//! Voice activity without a model file: what stands in where Silero is not installed.

use earshot::Detector;

use crate::{SpeechError, Vad, vad::WINDOW};

/// Samples that it wants at once.
const FRAME: usize = 256;

/// The detector; its weights are part of the program.
pub(crate) struct Earshot(Detector);

impl Earshot {
    pub(crate) fn new() -> Self {
        Self(Detector::default())
    }
}

impl Vad for Earshot {
    fn speech(&mut self, window: &[f32; WINDOW]) -> Result<f32, SpeechError> {
        let frames = window.chunks_exact(FRAME).map(|frame| self.0.predict_f32(frame));
        Ok(frames.fold(0.0, f32::max))
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn name(&self) -> &str {
        "earshot voice activity"
    }
}

//! Voice activity by the Silero model (MIT).

use std::path::Path;

use ort::{inputs, session::Session, value::Tensor};

use crate::{RATE, SpeechError, Vad, model_file::file, onnx, vad::WINDOW};

/// The model, within the data folder.
pub(crate) const MODEL: &str = "silero/silero_vad.onnx";

const NAME: &str = "Silero voice activity";
/// Samples of the window before that the model wants to see again.
const CONTEXT: usize = 64;
/// Numbers that it remembers: `[2, 1, 128]`.
const STATE: usize = 256;

/// The model, and what it remembers.
pub(crate) struct Silero {
    session: Session,
    context: [f32; CONTEXT],
    state: Vec<f32>,
}

impl Silero {
    /// Opens the model of a data folder.
    pub(crate) fn open(folder: &Path) -> Result<Self, SpeechError> {
        let model = file(folder, MODEL)?;
        onnx::load(&folder.join(onnx::LIBRARY))?;
        let mut silero = Self { session: onnx::open(&model, 1)?, context: [0.0; CONTEXT], state: vec![0.0; STATE] };
        let tried = silero.speech(&[0.0; WINDOW]);
        tried.map_err(|error| SpeechError::Broken {
            why: format!("it is another model ({error})"),
            remedy: onnx::remedy(&model),
            path: model,
        })?;
        silero.reset();
        Ok(silero)
    }

    fn run(&mut self, window: &[f32; WINDOW]) -> ort::Result<f32> {
        let input: Vec<f32> = self.context.iter().chain(window).copied().collect();
        let outputs = self.session.run(inputs![
            "input" => Tensor::from_array(([1, CONTEXT + WINDOW], input))?,
            "state" => Tensor::from_array(([2usize, 1, STATE / 2], self.state.clone()))?,
            "sr" => Tensor::from_array(((), vec![i64::from(RATE)]))?,
        ])?;
        let speech = outputs[0].try_extract_tensor::<f32>()?.1.first().copied().unwrap_or(0.0);
        let state = outputs[1].try_extract_tensor::<f32>()?.1;
        if state.len() != STATE {
            return Err(ort::Error::new(format!("its state has {} numbers, not {STATE}", state.len())));
        }
        self.state.copy_from_slice(state);
        self.context.copy_from_slice(&window[WINDOW - CONTEXT..]);
        Ok(speech)
    }
}

impl Vad for Silero {
    fn speech(&mut self, window: &[f32; WINDOW]) -> Result<f32, SpeechError> {
        self.run(window).map_err(|error| SpeechError::Engine { engine: NAME, why: error.to_string() })
    }

    fn reset(&mut self) {
        self.context.fill(0.0);
        self.state.fill(0.0);
    }

    fn name(&self) -> &str {
        NAME
    }
}

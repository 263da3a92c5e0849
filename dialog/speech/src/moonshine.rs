//! Moonshine models (MIT): an encoder of samples, a decoder, and a table of tokens.

use ort::{
    session::{Session, SessionInputValue},
    value::Tensor,
};

use crate::{
    RATE, SpeechError,
    audio::tame,
    decoder::{Decoder, Encoded},
    model_file::Parts,
    speller::{Begun, Model, most_tokens},
    tokens::{BEGIN, Tokens},
};

/// The model's folder, within the data folder.
pub(crate) const FOLDER: &str = "moonshine";
/// What its encoder takes.
pub(crate) const SOUND: &str = "input_values";

/// Shorter sounds are filled up with silence: the model makes nothing of them otherwise.
const SHORTEST: usize = RATE as usize / 2;

/// An opened model.
pub(crate) struct Moonshine {
    encoder: Session,
    decoder: Decoder,
    tokens: Tokens,
}

impl Moonshine {
    /// Opens what goes with an encoder.
    ///
    /// # Errors
    /// [`SpeechError::Missing`] or [`SpeechError::Broken`].
    pub(crate) fn open(encoder: Session, parts: &Parts, threads: usize) -> Result<Self, SpeechError> {
        let tokens = Tokens::of_moonshine(&parts.folder)?;
        Ok(Self { encoder, decoder: Decoder::open(&parts.decoder, threads)?, tokens })
    }
}

impl Model for Moonshine {
    const NAME: &'static str = "Moonshine";
    const LONGEST: usize = 30 * RATE as usize;
    const HAS_PARTIAL: bool = true;

    fn hear(&mut self, samples: &[f32]) -> ort::Result<Begun<'_>> {
        let mut sound: Vec<f32> = samples.iter().map(|sample| tame(*sample)).collect();
        sound.resize(sound.len().max(SHORTEST), 0.0);
        let length = sound.len();
        let most = most_tokens(length);
        let inputs: Vec<(&str, SessionInputValue<'_>)> = vec![
            (SOUND, Tensor::from_array(([1, length], sound))?.into()),
            ("attention_mask", Tensor::from_array(([1, length], vec![1i64; length]))?.into()),
        ];
        let wanted = self.encoder.inputs().len();
        let outputs = self.encoder.run(inputs.into_iter().take(wanted).collect::<Vec<_>>())?;
        let encoded = Encoded::of(&outputs[0], length)?;
        drop(outputs);
        let steps = self.decoder.begin(encoded, &[BEGIN])?;
        if steps.tokens() != self.tokens.len() {
            return Err(ort::Error::new("the decoder's tokens are not those of the table"));
        }
        Ok(Begun { steps, tokens: &self.tokens, most, silence: 0.0 })
    }
}

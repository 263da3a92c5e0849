//! Speech to text.

use crate::{Bias, SpeechError};

/// A reading is much less likely than another if the logarithms of how likely they are differ by more than this.
const NEAR: f32 = 4.0;

/// One reading of what was said.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// The words, as they would be typed.
    pub text: String,
    /// Logarithm of how likely it is, with all that the recogniser was told; comparable within one recognition alone.
    pub score: f32,
    /// How well it fits the sound, from 0 to 1.
    pub confidence: f32,
    /// Words of it that the recogniser was told nothing of; none if it was told nothing at all.
    pub strange: usize,
}

/// What was heard in one utterance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recognition {
    /// The readings, the likeliest first, no two alike; none if nothing was said.
    pub hypotheses: Vec<Hypothesis>,
    /// What was heard without bias.
    pub raw: String,
}

impl Recognition {
    /// The likeliest reading; empty if nothing was said.
    #[must_use]
    pub fn best(&self) -> &str {
        self.hypotheses.first().map_or("", |hypothesis| &hypothesis.text)
    }

    /// How well the likeliest reading fits the sound, from 0 to 1.
    #[must_use]
    pub fn confidence(&self) -> f32 {
        self.hypotheses.first().map_or(0.0, |hypothesis| hypothesis.confidence)
    }

    /// All that may well have been said: the readings that are not much less likely than the first, and what was heard without bias.
    pub fn likely(&self) -> impl Iterator<Item = &str> {
        let least = self.hypotheses.first().map_or(0.0, |first| first.score - NEAR);
        let near = self.hypotheses.iter().filter(move |reading| reading.score >= least);
        near.map(|reading| reading.text.as_str()).chain([self.raw.as_str()])
    }

    /// One reading, of which nothing else is known.
    #[must_use]
    pub fn sure(text: impl Into<String>) -> Self {
        Self::trusted(text, 1.0)
    }

    /// One reading, which is trusted so far.
    #[must_use]
    pub fn trusted(text: impl Into<String>, confidence: f32) -> Self {
        let raw: String = text.into();
        let reading = Hypothesis { text: raw.clone(), score: 0.0, confidence, strange: 0 };
        Self { hypotheses: if raw.is_empty() { Vec::new() } else { vec![reading] }, raw }
    }
}

/// Turns speech into text.
pub trait Recognizer: Send {
    /// What is likely to be said from now on. An engine that cannot be told goes without.
    fn bias(&mut self, bias: &Bias);

    /// What is said in samples at [`crate::RATE`], which are one utterance.
    ///
    /// # Errors
    /// [`SpeechError::Engine`] or [`SpeechError::Server`] if it cannot work.
    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError>;

    /// What was said so far, cheaply; none where the engine has nothing cheaper than recognising it.
    ///
    /// # Errors
    /// As [`Recognizer::recognize`].
    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        let _ = samples;
        Ok(None)
    }

    /// What it is, for people.
    fn name(&self) -> &str;
}

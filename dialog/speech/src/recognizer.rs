//! Speech to text.

use crate::{Bias, SpeechError};

/// One reading of what was said.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// The words, as they would be typed.
    pub text: String,
    /// Logarithm of how likely it is, a token; comparable within one recognition alone.
    pub score: f32,
}

/// What was heard in one utterance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recognition {
    /// The readings, the likeliest first, no two alike; none if nothing was said.
    pub hypotheses: Vec<Hypothesis>,
    /// What was heard without bias.
    pub raw: String,
    /// How far the first reading is to be trusted, from 0 to 1.
    pub confidence: f32,
}

impl Recognition {
    /// The likeliest reading; empty if nothing was said.
    #[must_use]
    pub fn best(&self) -> &str {
        self.hypotheses.first().map_or("", |hypothesis| &hypothesis.text)
    }

    /// The reading that makes most sense to who knows what can be meant: of those with the highest rank, the likeliest.
    #[must_use]
    pub fn sensible(&self, mut sense: impl FnMut(&str) -> u8) -> &str {
        let ranked = self.hypotheses.iter().map(|hypothesis| (sense(&hypothesis.text), &hypothesis.text));
        let best = ranked.reduce(|best, other| if other.0 > best.0 { other } else { best });
        best.map_or("", |(_, text)| text)
    }

    /// One reading, of which nothing else is known.
    #[must_use]
    pub fn sure(text: impl Into<String>) -> Self {
        let raw: String = text.into();
        let hypotheses =
            (!raw.is_empty()).then(|| Hypothesis { text: raw.clone(), score: 0.0 }).into_iter().collect::<Vec<_>>();
        Self { confidence: if hypotheses.is_empty() { 0.0 } else { 1.0 }, hypotheses, raw }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_sense_is_taken() {
        let reading = |text: &str| Hypothesis { text: text.into(), score: 0.0 };
        let hypotheses = vec![reading("turn light"), reading("turn right"), reading("turn on")];
        let recognition = Recognition { hypotheses, ..Recognition::default() };
        assert_eq!(recognition.sensible(|text| u8::from(text != "turn light")), "turn right");
        assert_eq!(recognition.sensible(|_| 0), "turn light");
        assert_eq!((Recognition::default().sensible(|_| 1), Recognition::sure("").best()), ("", ""));
    }
}

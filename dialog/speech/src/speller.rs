//! A recogniser of any model that spells what it hears, token by token.
//!
//! What was heard is spelt [greedily and with a say of what is likely](crate::beam); the [gate](crate::gate) chooses.

use std::path::Path;

use crate::{
    Bias, Hypothesis, RATE, Recognition, Recognizer, SpeechError,
    audio::tame,
    beam::{Search, Spelling, Spelt},
    bias,
    decoder::Steps,
    gate::{self, Heard},
    ngram::NGram,
    onnx,
    tokens::Tokens,
};

/// What is longer is no request, and spelt greedily alone: a beam takes six times as long.
const REQUEST: usize = 12 * RATE as usize;
/// What fits the sound less well is listened to once more, with so much silence around it, samples.
const CLEAR: f32 = 0.6;
const AROUND: usize = RATE as usize / 5;
/// Models repeat themselves where they are lost; nobody says more tokens a second than this.
const TOKENS_EACH_SECOND: f32 = 6.5;
/// Where it is this likely that nothing was said, nothing was: of silence and noise Whisper says so with 0.75 to 0.95, of speech in
/// noise 5 dB below it with 0.5 at most.
const SILENT: f32 = 0.8;
/// Less will do where a token is on average no likelier than this (logarithm): the values of Whisper's makers.
const QUIET: f32 = 0.6;
const UNLIKELY: f32 = -1.0;

/// A model that spells.
pub(crate) trait Model: Send {
    /// What it is, for people.
    const NAME: &'static str;
    /// Longer sounds are parted, where they are quietest: samples.
    const LONGEST: usize;
    /// Whether a part of an utterance takes less time than all of it.
    const HAS_PARTIAL: bool;

    /// Hears a sound, and takes the first step of its spelling.
    fn hear(&mut self, samples: &[f32]) -> ort::Result<Begun<'_>>;
}

/// A sound that can be spelt.
pub(crate) struct Begun<'m> {
    pub(crate) steps: Steps<'m>,
    pub(crate) tokens: &'m Tokens,
    /// How many tokens there may be at most: a model repeats itself where it is lost.
    pub(crate) most: usize,
    /// How likely it is that nothing was said, as far as the model can tell.
    pub(crate) silence: f32,
}

/// A model at work.
pub(crate) struct Speller<M> {
    model: M,
    likely: Option<NGram>,
    name: String,
}

/// The most tokens that are said in so many samples.
pub(crate) fn most_tokens(samples: usize) -> usize {
    (samples as f32 / RATE as f32 * TOKENS_EACH_SECOND).ceil() as usize
}

/// An utterance as it was spelt.
struct Written {
    greedy: (String, Spelling),
    others: Vec<(String, Spelling)>,
    silence: f32,
}

impl<M: Model> Speller<M> {
    /// A model out of a folder. One that is none is found out now, not when somebody speaks.
    ///
    /// # Errors
    /// [`SpeechError::Broken`], which names the decoder.
    pub(crate) fn new(model: M, folder: &Path, decoder: &Path) -> Result<Self, SpeechError> {
        let name = format!("{} ({})", M::NAME, folder.file_name().unwrap_or_default().to_string_lossy());
        let mut speller = Self { model, likely: None, name };
        speller.rehearse().map_err(|error| SpeechError::Broken {
            path: decoder.into(),
            why: format!("it cannot be run: {error}"),
            remedy: onnx::remedy(decoder),
        })?;
        Ok(speller)
    }

    /// Takes a step or two, and learns how they are cheapest.
    fn rehearse(&mut self) -> ort::Result<()> {
        let Begun { steps, tokens, .. } = self.model.hear(&[0.0; RATE as usize / 2])?;
        steps.try_sharing([tokens.end(), 0])
    }

    fn spell(&mut self, samples: &[f32], with_beam: bool) -> ort::Result<Written> {
        let Begun { steps, tokens, most, silence } = self.model.hear(samples)?;
        let search = Search { steps, tokens, model: self.likely.as_ref() };
        let Spelt { greedy, others } = search.run(most, with_beam)?;
        let text = |spelling: Spelling| (tokens.text(&spelling.tokens), spelling);
        Ok(Written { greedy: text(greedy), others: others.into_iter().map(text).collect(), silence })
    }

    /// What is said in a sound that is short enough. Where that is in doubt, it is listened to once more, with silence around it:
    /// the model is then lost at other places.
    fn listen(&mut self, samples: &[f32]) -> ort::Result<Recognition> {
        let is_short = self.likely.is_some() && samples.len() <= REQUEST;
        let heard = self.spell(samples, is_short)?;
        let heard = self.recognition(heard);
        let is_doubtful = |first: &Hypothesis| first.strange > 0 || first.confidence < CLEAR;
        if !is_short || !heard.hypotheses.first().is_some_and(is_doubtful) {
            return Ok(heard);
        }
        let around = [0.0; AROUND];
        let again = self.spell(&[&around, samples, &around].concat(), true)?;
        let again = self.recognition(again);
        let hypotheses = ordered(heard.hypotheses.into_iter().chain(again.hypotheses));
        Ok(Recognition { hypotheses, ..heard })
    }

    fn recognition(&self, written: Written) -> Recognition {
        let Written { greedy, others, silence } = written;
        let (raw, by_sound) = (greedy.0.clone(), greedy.1.by_sound);
        let is_silence = silence > SILENT || (silence > QUIET && greedy.1.each() < UNLIKELY);
        if is_silence || bias::words(&raw).is_empty() {
            return Recognition::default();
        }
        let heard = Heard { text: &raw, by_sound };
        let is_open =
            |(text, other): &(String, Spelling)| gate::is_open(Heard { text, by_sound: other.by_sound }, heard);
        let readings = others.into_iter().filter(is_open).chain([greedy]).map(|(text, spelling)| Hypothesis {
            score: if self.likely.is_some() { spelling.score } else { spelling.by_sound },
            confidence: spelling.each().exp(),
            strange: self.likely.as_ref().map_or(0, |likely| likely.strange(&text)),
            // `break-room` is said like `break room`.
            text: text.replace('-', " "),
        });
        Recognition { hypotheses: ordered(readings), raw: raw.clone() }
    }
}

impl<M: Model> Recognizer for Speller<M> {
    fn bias(&mut self, bias: &Bias) {
        self.likely = NGram::of(bias);
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        let mut parts = Vec::new();
        for part in parted(samples, M::LONGEST) {
            parts.push(self.listen(part).map_err(failed::<M>)?);
        }
        Ok(joined(parts))
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        if !M::HAS_PARTIAL {
            return Ok(None);
        }
        let part = &samples[samples.len().saturating_sub(M::LONGEST)..];
        let written = self.spell(part, false).map_err(failed::<M>)?;
        Ok(Some(written.greedy.0))
    }

    fn name(&self) -> &str {
        &self.name
    }
}

fn failed<M: Model>(error: ort::Error) -> SpeechError {
    SpeechError::Engine { engine: M::NAME, why: error.to_string() }
}

/// Readings, the likeliest first; of those that differ in marks alone, the likeliest.
fn ordered(readings: impl Iterator<Item = Hypothesis>) -> Vec<Hypothesis> {
    let mut readings: Vec<Hypothesis> = readings.collect();
    readings.sort_by(|one, other| other.score.total_cmp(&one.score));
    let mut known: Vec<Vec<String>> = Vec::new();
    readings.retain(|reading| {
        let words = bias::words(&reading.text);
        let is_new = !known.contains(&words);
        known.push(words);
        is_new
    });
    readings
}

/// Parts of a long sound that are short enough, cut where it is quietest in the last third of each.
fn parted(samples: &[f32], longest: usize) -> Vec<&[f32]> {
    const WINDOW: usize = RATE as usize / 10;
    let (mut parts, mut rest) = (Vec::new(), samples);
    while rest.len() > longest {
        let loudness = |at: &usize| {
            let loud: f32 = rest[*at..*at + WINDOW].iter().map(|sample| tame(*sample).abs()).sum();
            (loud * 1e3) as u64
        };
        let quietest = (longest * 2 / 3..longest - WINDOW).step_by(WINDOW).min_by_key(loudness);
        let (part, behind) = rest.split_at(quietest.unwrap_or(longest) + WINDOW / 2);
        parts.push(part);
        rest = behind;
    }
    if !rest.is_empty() {
        parts.push(rest);
    }
    parts
}

/// What was heard in parts, as one.
fn joined(mut parts: Vec<Recognition>) -> Recognition {
    if parts.len() <= 1 {
        return parts.pop().unwrap_or_default();
    }
    let text = |of: &dyn Fn(&Recognition) -> String| {
        parts.iter().map(of).filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let (best, raw) = (text(&|part| part.best().to_owned()), text(&|part| part.raw.clone()));
    let confidence = parts.iter().map(Recognition::confidence).fold(1.0, f32::min);
    let strange = parts.iter().filter_map(|part| part.hypotheses.first()).map(|first| first.strange).sum();
    let mut whole = Recognition { raw, ..Recognition::trusted(best, confidence) };
    whole.hypotheses.iter_mut().for_each(|reading| reading.strange = strange);
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_sound_is_parted_where_it_is_quiet() {
        const LONGEST: usize = 30 * RATE as usize;
        let mut sound = vec![0.5; 100 * RATE as usize];
        sound[25 * RATE as usize..26 * RATE as usize].fill(0.0);
        let parts = parted(&sound, LONGEST);
        assert!((parts[0].len() as f32 / RATE as f32 - 25.5).abs() < 0.6, "{}", parts[0].len());
        assert!(parts.iter().all(|part| part.len() <= LONGEST));
        assert_eq!(parts.iter().map(|part| part.len()).sum::<usize>(), sound.len());
        assert!(parted(&[], LONGEST).is_empty());
    }

    #[test]
    fn what_was_heard_in_parts_is_one() {
        let parts = ["Open the", "", "fridge."].map(Recognition::sure).to_vec();
        let whole = joined(parts);
        assert_eq!(
            (whole.best(), whole.raw.as_str(), whole.confidence()),
            ("Open the fridge.", "Open the fridge.", 0.0)
        );
        assert_eq!(joined(Vec::new()), Recognition::default());
    }
}

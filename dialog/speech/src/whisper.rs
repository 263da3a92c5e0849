//! Whisper models (MIT): an encoder of [loudness by frequency](crate::mel), a decoder, and a byte-level table of tokens; of English
//! alone, or of many languages, which are told that English is spoken.
//!
//! What is likely to be said has its say in the search alone. Telling the model of it beforehand, too, as words or sentences that
//! had been said, made some commands better and as many worse.

use std::{fs, path::Path};

use ort::{
    session::{Session, SessionInputValue},
    value::TensorRef,
};
use serde::Deserialize;

use crate::{
    SpeechError,
    decoder::{Decoder, Encoded},
    mel::{self, Mel},
    model_file::{INSTALL, Parts},
    onnx,
    speller::{Begun, Model, most_tokens},
    tokens::{Comes, Spelt, Tokens},
    vocabulary::{TOKENIZER, Vocabulary, bytes},
};

/// What its encoder takes.
pub(crate) const SOUND: &str = "input_features";

/// Bands of all models but the latest, which say otherwise.
const BANDS: usize = 80;
/// The token that ends an utterance, where the table is that of English alone.
const ENGLISH_END: i64 = 50_256;
/// Times that a transcript may tell, 0.00 to 30.00 s, have tokens of their own after all others.
const TIMES: i64 = 1_501;
/// So many tokens more than are said there may be, for a word cut short.
const MORE_TOKENS: usize = 2;

/// What is written and never spoken (`non_speech_tokens` of Whisper's makers), alone or after a space.
const UNSPOKEN: &str = r##"" # ( ) * + / : ; < = > @ [ \ ] ^ _ ` { | } ~ 「 」 『 』 << >> <<< >>> -- --- -( -[ (' (" (( )) ((( ))) [[ ]] {{ }} ♪♪ ♪♪♪"##;
/// And as they stand.
const UNSPOKEN_AFTER_SPACE: [&str; 2] = [" -", " '"];
/// What notes of music begin with.
const NOTE: &[u8] = "♩".as_bytes().split_at(2).0;

/// An opened model.
pub(crate) struct Whisper {
    encoder: Session,
    decoder: Decoder,
    mel: Mel,
    bands: usize,
    tokens: Tokens,
    marks: Marks,
}

/// Tokens that spell nothing.
struct Marks {
    /// What is said begins after these.
    begin: Vec<i64>,
    /// Nothing is said.
    silence: Option<i64>,
    /// How many tokens the model has.
    all: usize,
}

/// What stands in `config.json` of the front end.
#[derive(Default, Deserialize)]
struct Config {
    num_mel_bins: Option<usize>,
}

impl Whisper {
    /// Opens what goes with an encoder.
    ///
    /// # Errors
    /// [`SpeechError::Missing`] or [`SpeechError::Broken`].
    pub(crate) fn open(encoder: Session, parts: &Parts, threads: usize) -> Result<Self, SpeechError> {
        let missing = || SpeechError::Missing { path: parts.folder.join(TOKENIZER), remedy: INSTALL.into() };
        let vocabulary = Vocabulary::open(&parts.folder)?.ok_or_else(missing)?;
        let marks = Marks::of(&vocabulary).ok_or_else(|| vocabulary.other("a Whisper model"))?;
        let bands = match onnx::shape(&encoder, SOUND).as_deref() {
            Some(&[_, bands, _]) if bands > 0 => bands as usize,
            _ => Config::of(&parts.folder)?.num_mel_bins.unwrap_or(BANDS),
        };
        let tokens = tokens(&vocabulary).ok_or_else(|| vocabulary.other("a Whisper model"))?;
        let decoder = Decoder::open(&parts.decoder, threads)?;
        Ok(Self { encoder, decoder, mel: Mel::new(bands), bands, tokens, marks })
    }
}

impl Model for Whisper {
    const NAME: &'static str = "Whisper";
    const LONGEST: usize = mel::LENGTH;
    // Whatever is said, the encoder hears 30 seconds.
    const HAS_PARTIAL: bool = false;

    fn hear(&mut self, samples: &[f32]) -> ort::Result<Begun<'_>> {
        let most = most_tokens(samples.len()) + MORE_TOKENS;
        let sound = self.mel.loudness(samples);
        let sound = TensorRef::from_array_view(([1, self.bands, mel::MOMENTS], &sound[..]))?;
        let inputs: Vec<(&str, SessionInputValue<'_>)> = vec![(SOUND, sound.into())];
        let outputs = self.encoder.run(inputs)?;
        let encoded = Encoded::of(&outputs[0], samples.len())?;
        drop(outputs);
        let steps = self.decoder.begin(encoded, &self.marks.begin)?;
        if steps.tokens() != self.marks.all {
            let (all, known) = (steps.tokens(), self.marks.all);
            return Err(ort::Error::new(format!("it has {all} tokens, those beside it are of a model with {known}")));
        }
        let silence = self.marks.silence.map_or(0.0, |silence| chance(steps.after_first(), silence));
        Ok(Begun { steps, tokens: &self.tokens, most, silence })
    }
}

/// How likely a token is.
fn chance(logits: &[f32], token: i64) -> f32 {
    let highest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let total: f32 = logits.iter().map(|logit| (logit - highest).exp()).sum();
    logits.get(token as usize).map_or(0.0, |logit| (logit - highest).exp() / total)
}

impl Marks {
    fn of(vocabulary: &Vocabulary) -> Option<Self> {
        let id = |name: &str| vocabulary.id(name);
        let is_english = id("<|endoftext|>")? == ENGLISH_END;
        let told = if is_english { [].as_slice() } else { ["<|en|>", "<|transcribe|>"].as_slice() };
        let names = ["<|startoftranscript|>"].iter().chain(told).chain(&["<|notimestamps|>"]);
        Some(Self {
            begin: names.map(|name| id(name)).collect::<Option<_>>()?,
            silence: id("<|nospeech|>").or(id("<|nocaptions|>")),
            all: (id("<|notimestamps|>")? + 1 + TIMES) as usize,
        })
    }
}

impl Config {
    fn of(folder: &Path) -> Result<Self, SpeechError> {
        let path = folder.join("config.json");
        let Ok(text) = fs::read_to_string(&path) else { return Ok(Self::default()) };
        serde_json::from_str(&text).map_err(|error| SpeechError::Broken {
            why: format!("it is no description of a model: {error}"),
            remedy: onnx::remedy(&path),
            path,
        })
    }
}

/// What the tokens spell. Those after the end are marks and times.
fn tokens(vocabulary: &Vocabulary) -> Option<Tokens> {
    let end = vocabulary.id("<|endoftext|>")?;
    let spelt = |(token, name): (usize, &&str)| match bytes(name) {
        _ if token as i64 == end => Spelt::mark(Comes::Later),
        Some(bytes) if (token as i64) < end => {
            let comes = comes(&bytes);
            Spelt::new(bytes, comes)
        }
        _ => Spelt::mark(Comes::Never),
    };
    Some(Tokens::new(vocabulary.names().iter().enumerate().map(spelt).collect(), end))
}

/// Where a token of these bytes may come.
fn comes(bytes: &[u8]) -> Comes {
    if bytes == b" " {
        return Comes::Later;
    }
    let alone = bytes.strip_prefix(b" ").unwrap_or(bytes);
    let is_unspoken = alone.is_empty()
        || alone.starts_with(NOTE)
        || UNSPOKEN.split(' ').any(|text| text.as_bytes() == alone)
        || UNSPOKEN_AFTER_SPACE.iter().any(|text| text.as_bytes() == bytes);
    if is_unspoken { Comes::Never } else { Comes::Anywhere }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn what_is_never_spoken_does_not_come() {
        let check =
            |text: &[u8], expected: Comes| assert_eq!(comes(text), expected, "{}", String::from_utf8_lossy(text));
        for spoken in [" mug", "'t", "-", ".", " 30", "%", " ¡", "\u{e9}"] {
            check(spoken.as_bytes(), Comes::Anywhere);
        }
        for unspoken in ["(", " [", " -", "♪♪", " \"", ">>>", "_"] {
            check(unspoken.as_bytes(), Comes::Never);
        }
        check(&[0xE2, 0x99], Comes::Never);
        check(b" ", Comes::Later);
        check(b"", Comes::Never);
    }

    #[test]
    fn chances_are_shares() {
        let logits = [0.0, 2.0f32.ln(), 1.0f32.ln()];
        assert!((chance(&logits, 1) - 0.5).abs() < 1e-6 && (chance(&logits, 0) - 0.25).abs() < 1e-6);
        assert_eq!(chance(&logits, 99), 0.0);
    }
}

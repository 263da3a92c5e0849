//! Speech in and out: samples → turns of speech and their text; text → samples.
//!
//! Sound is mono at [`RATE`] samples a second, each from -1 to 1, unless something says otherwise. It never knows language,
//! sockets of the page, or the world: what is likely to be said comes in as plain words and sentences ([`Bias`]), and
//! whether a sentence is complete is asked of the caller. Nothing outside this crate knows an engine.
//!
//! - [`Ear`]: samples in, turns of speech with their text out; made of a [`Listener`] (when somebody speaks) and a
//!   [`Recognizer`] (what they say).
//! - [`Synthesizer`]: text in, samples out, in chunks.
//! - [`Engines::open`] finds what the machine has, and says what it lacks; [`install`] fetches what it lacks.
//! - [`errors`] makes a recogniser's errors at a chosen rate, [`fake`] stands in for engines in tests.
//!
//! ```
//! use cohabit_speech::{Ear, Heard, Turns, fake};
//!
//! let mut ear = Ear::new(Box::new(fake::Loudness), Box::new(fake::Reader::default()), Turns::default());
//! let mut said = Vec::new();
//! for samples in [fake::hidden("open the fridge"), vec![0.0; 16_000]] {
//!     for heard in ear.push(&samples, &mut |text| text.ends_with("fridge"))? {
//!         if let Heard::Said(utterance) = heard {
//!             said.push(utterance.recognition.best().to_owned());
//!         }
//!     }
//! }
//! assert_eq!(said, ["open the fridge"]);
//! # Ok::<(), cohabit_speech::SpeechError>(())
//! ```

mod audio;
mod beam;
mod bias;
mod choice;
mod decoder;
mod distance;
mod ear;
mod earshot;
mod engines;
mod error;
pub mod errors;
mod espeak;
pub mod fake;
mod gate;
pub mod install;
mod listener;
mod mel;
mod model;
mod model_file;
mod moonshine;
mod ngram;
mod onnx;
mod piper;
mod recognizer;
mod silero;
mod speller;
mod synthesizer;
mod tokens;
mod vad;
mod vocabulary;
mod whisper;
mod wyoming;

pub use audio::{RATE, Resampler, from_pcm, resample, to_pcm};
pub use bias::{Bias, Scene};
pub use choice::{Choice, Meaning, Sense, choose};
pub use distance::words as word_distance;
pub use ear::{Ear, Heard, Utterance};
pub use engines::{Engines, Lack, Part, Source, VoiceSettings};
pub use error::SpeechError;
pub use listener::{Listener, Turn, Turns};
pub use recognizer::{Hypothesis, Recognition, Recognizer};
pub use synthesizer::{Synthesizer, sentences};
pub use vad::{Vad, WINDOW};

//! Stop, heard in what is being said before anything else is made of it.

use std::{
    collections::VecDeque,
    mem,
    sync::{Arc, Mutex, PoisonError},
};

use cohabit_language::{find_stop, mentions_stop, says_stop_already};
use cohabit_speech::{Bias, Ear, RATE, Recognition, Recognizer, SpeechError};

use crate::voice::Shared;

/// While a robot is at work, what was said last is listened to for a stop so often, and so much of it, s: a word, and what it may
/// stand in.
const WATCH_EVERY_S: f32 = 0.128;
const WATCHED_S: f32 = 1.4;
/// So long it takes until the robots' own answer to a stop has sounded, ns; and it has no more words.
const OWN_STOP_NANOS: u64 = 5_000_000_000;
const OWN_STOP_WORDS: usize = 4;

/// Listens for a stop, and knows which one is news.
pub struct StopWatch {
    recognizer: Shared,
    readings: Readings,
    /// What came last, and how many samples came since it was listened to.
    last: VecDeque<f32>,
    unwatched: usize,
    /// The first sample of what is being said.
    first: u64,
    /// Whether what is being said has said stop already, and when somebody last did.
    has_stopped: bool,
    stopped_nanos: u64,
}

impl StopWatch {
    /// With the recogniser that all pages share.
    pub fn new(recognizer: Shared) -> Self {
        Self {
            recognizer,
            readings: Readings::default(),
            last: VecDeque::new(),
            unwatched: 0,
            first: 0,
            has_stopped: false,
            stopped_nanos: 0,
        }
    }

    /// The same recogniser, which notes its readings for [`StopWatch::take_readings`].
    pub fn attentive(&self) -> Box<dyn Recognizer> {
        Box::new(Attentive { recognizer: self.recognizer.clone(), readings: Arc::clone(&self.readings) })
    }

    /// All that may well have been said, as it was recognised since this was last asked.
    pub fn take_readings(&self) -> Vec<String> {
        mem::take(&mut *self.readings.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Somebody begins to say something new, at this sample.
    pub fn begin(&mut self, first: u64) {
        (self.first, self.has_stopped) = (first, false);
    }

    /// Whether what is being said has said stop already.
    pub fn has_stopped(&self) -> bool {
        self.has_stopped
    }

    /// Takes samples that the ear does not have yet. Whether what was said last says stop, as far as it was listened to: whenever
    /// a little more was said, and only while there is something to stop.
    pub fn hears(&mut self, samples: &[f32], ear: &Ear, is_of_use: impl FnOnce() -> bool) -> bool {
        let [watched, every] = [WATCHED_S, WATCH_EVERY_S].map(|seconds| (seconds * RATE as f32) as usize);
        self.last.extend(samples);
        let surplus = self.last.len().saturating_sub(watched);
        self.last.drain(..surplus);
        self.unwatched += samples.len();
        let is_due = ear.is_in_turn() && self.unwatched >= every && !self.has_stopped;
        if !is_due || !is_of_use() {
            return false;
        }
        self.unwatched = 0;
        let said = (ear.position() + samples.len() as u64).saturating_sub(self.first) as usize;
        let from = self.last.len().saturating_sub(said);
        let text = self.recognizer.partial(&self.last.make_contiguous()[from..]);
        // Whoever recognises all of it tells an error.
        let text = text.inspect_err(|error| tracing::warn!("{error}")).ok().flatten();
        text.is_some_and(|text| says_stop_already(&text))
    }

    /// Takes down a stop. Whether it is the first in what is being said.
    pub fn is_first(&mut self) -> bool {
        !mem::replace(&mut self.has_stopped, true)
    }

    /// Takes down when a stop is done. Whether it is to be: where a robot answers to one just now, who says that word cannot be
    /// told; then it is done once, lest robots stop each other for ever. They have stopped then.
    pub fn is_to_be_done(&mut self, is_own_word: bool, now_nanos: u64) -> bool {
        let is_answered = is_own_word && now_nanos.saturating_sub(self.stopped_nanos) < OWN_STOP_NANOS;
        if !is_answered {
            self.stopped_nanos = now_nanos;
        }
        !is_answered
    }
}

/// Whether what a robot says may be its answer to a stop.
pub fn may_answer_stop(said: &str) -> bool {
    mentions_stop(said) && said.split(' ').count() <= OWN_STOP_WORDS
}

/// What else was said with a stop, if that is a whole request or question by itself.
pub fn recognition_of_rest(recognition: &Recognition, is_whole: impl Fn(&str) -> bool) -> Option<Recognition> {
    let rest = find_stop(recognition.best())?.rest;
    (!rest.is_empty() && is_whole(&rest)).then(|| Recognition::trusted(rest, recognition.confidence()))
}

/// What was recognised.
type Readings = Arc<Mutex<Vec<String>>>;

/// A recogniser that notes all that may well have been said.
struct Attentive {
    recognizer: Shared,
    readings: Readings,
}

impl Recognizer for Attentive {
    fn bias(&mut self, bias: &Bias) {
        self.recognizer.bias(bias);
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        let recognition = self.recognizer.recognize(samples)?;
        let mut readings = self.readings.lock().unwrap_or_else(PoisonError::into_inner);
        readings.extend(recognition.likely().map(str::to_owned));
        Ok(recognition)
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        self.recognizer.partial(samples)
    }

    fn name(&self) -> &str {
        self.recognizer.name()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_after_a_stop_is_heard_if_it_is_whole() {
        let rest = |said: &str, is_whole: bool| {
            let rest = recognition_of_rest(&Recognition::sure(said), |_| is_whole);
            rest.map(|rest| rest.best().to_owned())
        };
        assert_eq!(rest("stop, come back", true).as_deref(), Some("come back"));
        assert_eq!(rest("stop, there is a cat", false), None);
        assert_eq!(rest("stop", true), None);
        assert_eq!(rest("come back", true), None);
    }
}

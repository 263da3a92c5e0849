//! What is said in sound that never ends: turns of speech, and their text.

use crate::{Bias, Listener, Recognition, Recognizer, SpeechError, Turn, Turns, Vad};

/// What was heard.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// Somebody began to speak, at this sample.
    Began {
        /// Counted from the first one that the ear was given.
        began: u64,
    },
    /// What they said so far, unless it is what it was.
    Partial {
        /// In words; may yet change.
        text: String,
    },
    /// They are done.
    Said(Utterance),
}

/// One turn of speech.
#[derive(Clone, Debug, PartialEq)]
pub struct Utterance {
    /// What was said; without readings, if it was nothing.
    pub recognition: Recognition,
    /// The sound of it.
    pub samples: Vec<f32>,
    /// Which sample it began at, counted from the first one that the ear was given.
    pub began: u64,
    /// Which sample the speech ended at.
    pub ended: u64,
    /// Which sample was the last that was listened to before it was told: at [`crate::RATE`], the pause was so much longer.
    pub told: u64,
    /// Whether it was cut for its length.
    pub is_cut: bool,
}

/// A [`Listener`] with a [`Recognizer`].
///
/// What was said is recognised in the pause that may be the end of it, so that it is known when the turn ends.
pub struct Ear {
    listener: Listener,
    recognizer: Box<dyn Recognizer>,
    /// What was recognised in the last pause, and of how many samples.
    recognized: Option<(usize, Recognition)>,
    partial: String,
}

impl Ear {
    /// An ear that has heard nothing.
    #[must_use]
    pub fn new(vad: Box<dyn Vad>, recognizer: Box<dyn Recognizer>, turns: Turns) -> Self {
        Self { listener: Listener::new(vad, turns), recognizer, recognized: None, partial: String::new() }
    }

    /// What is likely to be said from now on.
    pub fn bias(&mut self, bias: &Bias) {
        self.recognizer.bias(bias);
    }

    /// How many samples it has listened to.
    #[must_use]
    pub fn position(&self) -> u64 {
        self.listener.position()
    }

    /// Whether somebody is speaking.
    #[must_use]
    pub fn is_in_turn(&self) -> bool {
        self.listener.is_in_turn()
    }

    /// Takes samples at [`crate::RATE`], any number of them. `is_complete` says of what was said so far whether it is a whole
    /// sentence; its turn ends with a shorter pause.
    ///
    /// # Errors
    /// Where an engine fails: what was said in the turn is lost, the next one is heard.
    pub fn push(
        &mut self,
        samples: &[f32],
        is_complete: &mut dyn FnMut(&str) -> bool,
    ) -> Result<Vec<Heard>, SpeechError> {
        let Self { listener, recognizer, recognized, .. } = self;
        let mut in_pause = |said: &[f32]| {
            let recognition = recognizer.recognize(said)?;
            let is_complete = is_complete(recognition.best());
            *recognized = Some((said.len(), recognition));
            Ok(is_complete)
        };
        let turns = match listener.push(samples, &mut in_pause) {
            Ok(turns) => turns,
            Err(error) => {
                self.reset();
                return Err(error);
            }
        };
        let mut heard = Vec::new();
        for turn in turns {
            heard.extend(self.hear(turn)?);
        }
        Ok(heard)
    }

    /// No pause ends a turn until [`Ear::finish`], as where a key is held.
    pub fn hold(&mut self) {
        self.listener.hold();
    }

    /// Ends the turn at once, as where a key is released; none if nobody spoke.
    ///
    /// # Errors
    /// Where the recogniser fails.
    pub fn finish(&mut self) -> Result<Option<Heard>, SpeechError> {
        self.listener.finish().map_or(Ok(None), |turn| self.hear(turn))
    }

    /// Forgets what was said in an open turn, as where the microphone goes.
    pub fn reset(&mut self) {
        self.listener.reset();
        self.recognized = None;
        self.partial.clear();
    }

    fn hear(&mut self, turn: Turn) -> Result<Option<Heard>, SpeechError> {
        match turn {
            Turn::Began { began } => {
                self.partial.clear();
                self.recognized = None;
                Ok(Some(Heard::Began { began }))
            }
            Turn::Partial { samples } => {
                let text = self.recognizer.partial(&samples)?.unwrap_or_default();
                if text.is_empty() || text == self.partial {
                    return Ok(None);
                }
                self.partial.clone_from(&text);
                Ok(Some(Heard::Partial { text }))
            }
            Turn::Ended { samples, began, ended, is_cut } => {
                let spoken = (ended - began) as usize;
                let recognition = match self.recognized.take() {
                    Some((of, recognition)) if (spoken..=samples.len()).contains(&of) => recognition,
                    _ => self.recognizer.recognize(&samples)?,
                };
                let told = self.listener.position();
                Ok(Some(Heard::Said(Utterance { recognition, samples, began, ended, told, is_cut })))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::{RATE, fake};

    fn ear() -> Ear {
        Ear::new(Box::new(fake::Loudness), Box::new(fake::Reader::default()), Turns::default())
    }

    fn said(heard: &[Heard]) -> Vec<&str> {
        let said = heard.iter().filter_map(|heard| match heard {
            Heard::Said(utterance) => Some(utterance.recognition.best()),
            _ => None,
        });
        said.collect()
    }

    #[test]
    fn what_is_said_is_told_and_when() {
        let mut ear = ear();
        let sound = [vec![0.0; 8_000], fake::hidden("go to the lab"), vec![0.0; 20_000]].concat();
        let heard: Vec<Heard> =
            sound.chunks(320).flat_map(|piece| ear.push(piece, &mut |text| text == "go to the lab").unwrap()).collect();
        assert_eq!(said(&heard), ["go to the lab"]);
        let Some(Heard::Said(utterance)) = heard.last() else { panic!("{heard:?}") };
        let pause_s = (utterance.told - utterance.ended) as f32 / RATE as f32;
        let expected_s = Turns::default().complete_after_s;
        assert!((expected_s..expected_s + 0.05).contains(&pause_s), "{pause_s}");
        assert!(matches!(heard[0], Heard::Began { began } if began < 8_000));
    }

    #[test]
    fn what_is_incomplete_is_waited_for() {
        let mut ear = ear();
        let sound = [fake::hidden("put the mug"), vec![0.0; 40_000]].concat();
        let heard: Vec<Heard> = sound.chunks(320).flat_map(|piece| ear.push(piece, &mut |_| false).unwrap()).collect();
        let Some(Heard::Said(utterance)) = heard.last() else { panic!("{heard:?}") };
        assert_eq!(utterance.recognition.best(), "put the mug");
        assert!((utterance.told - utterance.ended) as f32 / RATE as f32 >= Turns::default().incomplete_after_s);
    }

    #[test]
    fn a_key_that_is_released_ends_a_turn() {
        let mut ear = ear();
        ear.hold();
        assert_eq!(said(&ear.push(&fake::hidden("stop"), &mut |_| true).unwrap()), [] as [&str; 0]);
        let Some(Heard::Said(utterance)) = ear.finish().unwrap() else { panic!() };
        assert_eq!(utterance.recognition.best(), "stop");
        assert_eq!(ear.finish().unwrap(), None);
    }
}

//! What is said in sound that never ends: turns of speech, and their text.

use std::borrow::Cow;

use crate::{Bias, Listener, RATE, Recognition, Recognizer, SpeechError, Turn, Turns, Vad};

/// Nothing joins what is longer, samples: all of it would be recognised again.
const LONGEST_JOINED: usize = 12 * RATE as usize;

/// What was heard.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// Somebody began to speak, at this sample.
    Began {
        /// Counted from the first one that the ear was given.
        began: u64,
        /// Whether they go on with what they said before: that is told again, with what they say now.
        joins: bool,
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
    /// Whether it begins with all of the utterance before it, in whose place it stands.
    pub joins: bool,
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
    /// What was said last, while more may join it.
    last: Option<Last>,
    /// What came before the open turn, and is one with it.
    before: Option<Last>,
    joins: u64,
}

/// A turn that may be gone on with.
struct Last {
    samples: Vec<f32>,
    began: u64,
    told: u64,
}

impl Ear {
    /// An ear that has heard nothing.
    #[must_use]
    pub fn new(vad: Box<dyn Vad>, recognizer: Box<dyn Recognizer>, turns: Turns) -> Self {
        Self {
            listener: Listener::new(vad, turns),
            recognizer,
            recognized: None,
            partial: String::new(),
            last: None,
            before: None,
            joins: (turns.joins_s * RATE as f32) as u64,
        }
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
        let Self { listener, recognizer, recognized, before, .. } = self;
        let mut in_pause = |said: &[f32]| {
            let recognition = recognizer.recognize(&with(before.as_ref(), said))?;
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

    /// No pause ends a turn until [`Ear::finish`], as where a key is held. What is said then is one of its own.
    pub fn hold(&mut self) {
        self.part();
        self.listener.hold();
    }

    /// What was told last is done with: what is said next, or just now, does not join it.
    pub fn part(&mut self) {
        self.last = None;
        if self.before.take().is_some() {
            self.recognized = None;
        }
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
        self.part();
        self.recognized = None;
        self.partial.clear();
    }

    fn hear(&mut self, turn: Turn) -> Result<Option<Heard>, SpeechError> {
        match turn {
            Turn::Began { began } => {
                self.partial.clear();
                self.recognized = None;
                let position = self.listener.position();
                self.before = self.last.take().filter(|last| position <= last.told + self.joins);
                Ok(Some(Heard::Began { began, joins: self.before.is_some() }))
            }
            Turn::Partial { samples } => {
                let text = self.recognizer.partial(&with(self.before.as_ref(), &samples))?.unwrap_or_default();
                if text.is_empty() || text == self.partial {
                    return Ok(None);
                }
                self.partial.clone_from(&text);
                Ok(Some(Heard::Partial { text }))
            }
            Turn::Ended { samples, began, ended, is_cut } => {
                let (spoken, length) = ((ended - began) as usize, samples.len());
                let before = self.before.take();
                let samples = with(before.as_ref(), &samples).into_owned();
                let recognition = match self.recognized.take() {
                    Some((of, recognition)) if (spoken..=length).contains(&of) => recognition,
                    _ => self.recognizer.recognize(&samples)?,
                };
                let (told, joins) = (self.listener.position(), before.is_some());
                let began = before.map_or(began, |before| before.began);
                let may_go_on = samples.len() <= LONGEST_JOINED && !is_cut && !recognition.best().is_empty();
                if self.joins > 0 && may_go_on {
                    self.last = Some(Last { samples: samples.clone(), began, told });
                }
                Ok(Some(Heard::Said(Utterance { recognition, samples, began, ended, told, is_cut, joins })))
            }
        }
    }
}

/// The samples, after what comes before them.
fn with<'s>(before: Option<&Last>, samples: &'s [f32]) -> Cow<'s, [f32]> {
    match before {
        Some(before) => Cow::Owned([&before.samples, samples].concat()),
        None => Cow::Borrowed(samples),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::fake;

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
        assert!(matches!(heard[0], Heard::Began { began, joins: false } if began < 8_000));
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

    /// All that is told of two parts of a sentence, the first of which might be one, with a pause of so many samples between.
    fn in_two(pause: usize, between: impl Fn(&mut Ear)) -> Vec<Utterance> {
        let turns = Turns { joins_s: 1.0, ..Turns::default() };
        let mut ear = Ear::new(Box::new(fake::Loudness), Box::new(fake::Reader::default()), turns);
        let mut heard = Vec::new();
        for part in [fake::hidden("take the mug"), vec![0.0; pause], fake::hidden("and drop it"), vec![0.0; 20_000]] {
            for piece in part.chunks(320) {
                heard.extend(ear.push(piece, &mut |_| true).unwrap());
            }
            if heard.iter().any(|heard| matches!(heard, Heard::Said(_))) {
                between(&mut ear);
            }
        }
        heard.into_iter().filter_map(|heard| if let Heard::Said(said) = heard { Some(said) } else { None }).collect()
    }

    #[test]
    fn who_goes_on_soon_has_said_one_thing() {
        let [first, both] = &in_two(10_000, |_| ())[..] else { panic!() };
        assert_eq!((first.recognition.best(), first.joins), ("take the mug", false));
        assert_eq!((both.recognition.best(), both.joins, both.began), ("take the mug and drop it", true, first.began));
        for [_, second] in
            [in_two(40_000, |_| ()), in_two(10_000, Ear::part)].map(|said| <[_; 2]>::try_from(said).unwrap())
        {
            assert_eq!((second.recognition.best(), second.joins), ("and drop it", false));
        }
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

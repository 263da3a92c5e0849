//! Stand-ins for engines, for tests of what uses them: a text hidden in samples is heard, a reply is a beep a letter.

use std::{f32::consts::PI, ops::ControlFlow};

use crate::{Bias, RATE, Recognition, Recognizer, SpeechError, Synthesizer, Vad, vad::WINDOW};

/// Samples of one hidden bit, and how loud it is.
const BIT: usize = 32;
const LOUD: f32 = 0.5;
/// What a hidden text begins with.
const MARK: [u8; 2] = [0xA5, 0x3C];

/// Voice activity that takes all that is loud for speech.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loudness;

impl Vad for Loudness {
    fn speech(&mut self, window: &[f32; WINDOW]) -> Result<f32, SpeechError> {
        let power = window.iter().map(|sample| sample * sample).sum::<f32>() / WINDOW as f32;
        Ok(if power.sqrt() > LOUD * 0.1 { 1.0 } else { 0.0 })
    }

    fn reset(&mut self) {}

    fn name(&self) -> &str {
        "loudness"
    }
}

/// Samples in which a text of at most 65,535 bytes is hidden; they last 16 ms a byte, and survive 16 bits a sample.
#[must_use]
pub fn hidden(text: &str) -> Vec<f32> {
    let length = u16::try_from(text.len()).unwrap_or(u16::MAX);
    let bytes = MARK.iter().copied().chain(length.to_le_bytes()).chain(text.bytes().take(usize::from(length)));
    let bits = bytes.flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1));
    bits.flat_map(|bit| [if bit { LOUD } else { -LOUD }; BIT]).collect()
}

/// The texts that are hidden in samples, one after the other; a text of which less than all is there counts as far as it goes.
fn found(samples: &[f32]) -> Vec<String> {
    let (mut texts, mut at) = (Vec::new(), 0);
    while at < samples.len() {
        let byte = |index: usize| byte(samples.get(at + index * 8 * BIT..)?);
        let header = [byte(0), byte(1), byte(2), byte(3)];
        let (true, Some(low), Some(high)) = (header[..2] == MARK.map(Some), header[2], header[3]) else {
            at += 1;
            continue;
        };
        let length = usize::from(u16::from_le_bytes([low, high]));
        let bytes: Vec<u8> = (0..length).map_while(|index| byte(4 + index)).collect();
        at += (4 + bytes.len()) * 8 * BIT;
        texts.push(String::from_utf8_lossy(&bytes).into_owned());
    }
    texts
}

fn byte(samples: &[f32]) -> Option<u8> {
    let bit = |bit: usize| {
        let sample = samples.get(bit * BIT + BIT / 2)?;
        (sample.abs() > LOUD / 2.0).then_some(u8::from(*sample > 0.0) << bit)
    };
    (0..8).map(bit).sum()
}

/// A recogniser of texts that are [`hidden`] in samples, or, where none is, of sounds by their length.
#[derive(Clone, Debug, Default)]
pub struct Reader {
    /// Tenths of a second → what is heard in a sound that lasts so long or longer, up to the next.
    pub by_length: Vec<(usize, String)>,
    /// How far it trusts what it hears; 1 if not set.
    pub confidence: Option<f32>,
    /// What it was told is likely.
    pub told: Bias,
}

impl Reader {
    fn read(&self, samples: &[f32]) -> Recognition {
        let texts = found(samples);
        let tenths = samples.len() * 10 / RATE as usize;
        let by_length = || self.by_length.iter().rfind(|(from, _)| tenths >= *from).map(|(_, text)| text.clone());
        let text = if texts.is_empty() { by_length().unwrap_or_default() } else { texts.join(" ") };
        Recognition::trusted(text, self.confidence.unwrap_or(1.0))
    }
}

impl Recognizer for Reader {
    fn bias(&mut self, bias: &Bias) {
        self.told = bias.clone();
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        Ok(self.read(samples))
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        Ok(Some(self.read(samples).raw))
    }

    fn name(&self) -> &str {
        "a reader of hidden texts"
    }
}

/// A synthesiser that beeps, 50 ms a letter, in chunks of 100 ms.
#[derive(Clone, Debug, Default)]
pub struct Beeper;

impl Synthesizer for Beeper {
    fn rate(&self) -> u32 {
        RATE
    }

    fn speak(&mut self, text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<(), SpeechError> {
        let letters = text.chars().filter(|c| c.is_alphanumeric()).count();
        let sample = |at: usize| (8_000.0 * (2.0 * PI * 440.0 * at as f32 / RATE as f32).sin()) as i16;
        let samples: Vec<i16> = (0..letters * RATE as usize / 20).map(sample).collect();
        for part in samples.chunks(RATE as usize / 10) {
            if chunk(part).is_break() {
                break;
            }
        }
        Ok(())
    }

    fn name(&self) -> &str {
        "a beeper"
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::{from_pcm, to_pcm};

    #[test]
    fn what_is_hidden_is_found() {
        let mut reader = Reader::default();
        for text in ["stop", "go to the break room and pick up the bowl", "schön"] {
            let sound = [vec![0.0; 4_321], hidden(text), vec![0.0; 999]].concat();
            assert_eq!(reader.recognize(&from_pcm(&to_pcm(&sound))).unwrap().best(), text);
        }
        let two = [hidden("open it"), vec![0.0; 5_000], hidden("and go")].concat();
        assert_eq!(reader.recognize(&two).unwrap().best(), "open it and go");
        assert_eq!(reader.partial(&hidden("open it")[..8 * 8 * BIT]).unwrap().unwrap(), "open");
    }

    #[test]
    fn where_nothing_is_hidden_the_length_tells() {
        let by_length = vec![(5, "stop".to_owned()), (20, "open the fridge".to_owned())];
        let mut reader = Reader { by_length, confidence: Some(0.4), ..Reader::default() };
        let mut heard = |seconds: f32| reader.recognize(&vec![0.1; (seconds * RATE as f32) as usize]).unwrap();
        assert_eq!((heard(0.1).best(), heard(1.0).best(), heard(9.0).best()), ("", "stop", "open the fridge"));
        assert_eq!((heard(0.1).confidence(), heard(1.0).confidence()), (0.0, 0.4));
    }

    #[test]
    fn a_beeper_can_be_stopped() {
        let mut chunks = 0;
        let stop = &mut |_: &[i16]| {
            chunks += 1;
            if chunks == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        Beeper.speak(&"a".repeat(100), stop).unwrap();
        assert_eq!(chunks, 3);
    }
}

//! Samples: what may be in them, and other rates.

use std::f32::consts::PI;

use crate::SpeechError;

/// Samples a second of what is listened to.
pub const RATE: u32 = 16_000;

/// Rates that sound is recorded at.
const RATES: std::ops::RangeInclusive<u32> = 4_000..=384_000;
/// Zero crossings of the windowed sinc on either side; 16 keep 70 dB of what must not fold back out.
const CROSSINGS: f64 = 16.0;

/// Samples from 16-bit ones.
#[must_use]
pub fn from_pcm(pcm: &[i16]) -> Vec<f32> {
    pcm.iter().map(|sample| f32::from(*sample) / 32768.0).collect()
}

/// 16-bit samples; what is too loud is cut off, what is no number is silence.
#[must_use]
pub fn to_pcm(samples: &[f32]) -> Vec<i16> {
    samples.iter().map(|sample| (tame(*sample) * 32767.0) as i16).collect()
}

/// A sample as it may be: from -1 to 1, silence where it is no number.
pub(crate) fn tame(sample: f32) -> f32 {
    if sample.is_finite() { sample.clamp(-1.0, 1.0) } else { 0.0 }
}

/// Samples at another rate, all at once.
///
/// # Errors
/// [`SpeechError::Sound`] for a rate that no sound has.
pub fn resample(samples: &[f32], from_hz: u32, to_hz: u32) -> Result<Vec<f32>, SpeechError> {
    let mut resampler = Resampler::new(from_hz, to_hz)?;
    let mut out = resampler.push(samples);
    out.extend(resampler.finish());
    Ok(out)
}

/// Takes samples at one rate, in pieces of any length, and gives them at another: a windowed sinc.
#[derive(Clone, Debug)]
pub struct Resampler {
    from_hz: u32,
    to_hz: u32,
    /// What is still needed of what came, and where in all of it that begins.
    kept: Vec<f32>,
    kept_from: i64,
    given: i64,
    taken: i64,
}

impl Resampler {
    /// From one rate to another.
    ///
    /// # Errors
    /// [`SpeechError::Sound`] for a rate that no sound has.
    pub fn new(from_hz: u32, to_hz: u32) -> Result<Self, SpeechError> {
        match [from_hz, to_hz].into_iter().find(|rate| !RATES.contains(rate)) {
            Some(rate) => Err(SpeechError::Sound(format!(
                "{rate} samples a second; from {} to {} can be used",
                RATES.start(),
                RATES.end()
            ))),
            None => Ok(Self { from_hz, to_hz, kept: Vec::new(), kept_from: 0, given: 0, taken: 0 }),
        }
    }

    /// Takes samples, gives those that can be told already.
    pub fn push(&mut self, samples: &[f32]) -> Vec<f32> {
        if self.from_hz == self.to_hz {
            return samples.iter().map(|sample| tame(*sample)).collect();
        }
        self.kept.extend(samples.iter().map(|sample| tame(*sample)));
        self.taken += samples.len() as i64;
        self.give(self.taken - self.reach())
    }

    /// Gives the rest: nothing comes after what was taken.
    pub fn finish(&mut self) -> Vec<f32> {
        if self.from_hz == self.to_hz { Vec::new() } else { self.give(self.taken) }
    }

    /// Gives what lies before a place of what was taken.
    fn give(&mut self, before: i64) -> Vec<f32> {
        let mut out = Vec::new();
        loop {
            let place = self.given as f64 * f64::from(self.from_hz) / f64::from(self.to_hz);
            if place >= before as f64 {
                break;
            }
            out.push(self.at(place));
            self.given += 1;
        }
        let next = self.given as f64 * f64::from(self.from_hz) / f64::from(self.to_hz);
        let unneeded = (next as i64 - self.reach() - self.kept_from).clamp(0, self.kept.len() as i64);
        self.kept.drain(..unneeded as usize);
        self.kept_from += unneeded;
        out
    }

    fn at(&self, place: f64) -> f32 {
        let (reach, cutoff) = (self.reach(), self.cutoff());
        let first = (place as i64 - reach).max(self.kept_from);
        let last = (place as i64 + reach).min(self.taken - 1);
        let weighted = (first..=last).map(|at| {
            let sample = self.kept[(at - self.kept_from) as usize];
            sample * kernel((place - at as f64) as f32, cutoff as f32)
        });
        weighted.sum::<f32>().clamp(-1.0, 1.0)
    }

    /// The share of what the input can hold that the output can.
    fn cutoff(&self) -> f64 {
        (f64::from(self.to_hz) / f64::from(self.from_hz)).min(1.0)
    }

    /// How many samples around a place its value depends on.
    fn reach(&self) -> i64 {
        (CROSSINGS / self.cutoff()).ceil() as i64
    }
}

/// A sinc under a Hann window, of unit gain.
fn kernel(distance: f32, cutoff: f32) -> f32 {
    let width = CROSSINGS as f32 / cutoff;
    if distance.abs() >= width {
        return 0.0;
    }
    let angle = PI * distance * cutoff;
    let sinc = if angle.abs() < 1e-6 { 1.0 } else { angle.sin() / angle };
    cutoff * sinc * 0.5 * (1.0 + (PI * distance / width).cos())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn tone(hz: f32, rate: u32, count: usize) -> Vec<f32> {
        (0..count).map(|at| 0.5 * (2.0 * PI * hz * at as f32 / rate as f32).sin()).collect()
    }

    fn loudness(samples: &[f32]) -> f32 {
        (samples.iter().map(|sample| sample * sample).sum::<f32>() / samples.len() as f32).sqrt()
    }

    #[test]
    fn a_tone_stays_itself_at_another_rate() {
        for (from, to) in [(48_000, 16_000), (22_050, 16_000), (44_100, 16_000), (16_000, 22_050), (8_000, 16_000)] {
            let out = resample(&tone(440.0, from, from as usize), from, to).unwrap();
            assert_eq!(out.len(), to as usize, "{from} to {to}");
            let expected = tone(440.0, to, to as usize);
            let inner = 400..out.len() - 400;
            let off = inner.map(|at| (out[at] - expected[at]).abs()).fold(0.0, f32::max);
            assert!(off < 0.01, "{from} to {to}: off by {off}");
        }
    }

    #[test]
    fn what_the_new_rate_cannot_hold_is_gone() {
        let out = resample(&tone(12_000.0, 48_000, 48_000), 48_000, 16_000).unwrap();
        assert!(loudness(&out[400..out.len() - 400]) < 0.001);
    }

    #[test]
    fn pieces_give_what_the_whole_gives() {
        let whole = tone(440.0, 48_000, 10_000);
        let mut resampler = Resampler::new(48_000, 16_000).unwrap();
        let mut out: Vec<f32> = whole.chunks(7).flat_map(|piece| resampler.push(piece)).collect();
        out.extend(resampler.finish());
        assert_eq!(out, resample(&whole, 48_000, 16_000).unwrap());
    }

    #[test]
    fn what_is_no_sound_becomes_silence_or_is_refused() {
        let odd = [f32::NAN, f32::INFINITY, -7.0, 0.25];
        assert_eq!(resample(&odd, 16_000, 16_000).unwrap(), [0.0, 0.0, -1.0, 0.25]);
        assert_eq!(to_pcm(&odd), [0, 0, -32767, 8191]);
        assert!(resample(&odd, 48_000, 16_000).unwrap().iter().all(|sample| sample.is_finite()));
        assert!(resample(&[], 48_000, 16_000).unwrap().is_empty());
        assert!(resample(&odd, 0, 16_000).unwrap_err().to_string().contains("0 samples a second"));
        assert_eq!(from_pcm(&[i16::MIN, 0]), [-1.0, 0.0]);
    }
}

//! What Whisper hears of a sound: how loud each band of frequencies is, on the scale of hearing, from moment to moment.
//!
//! As its makers' own `log_mel_spectrogram`: windows of 25 ms every 10 ms, bands on Slaney's mel scale, `log10`, at most 8 below the
//! loudest, `(x + 4) / 4`. Filters are computed, not kept.

use std::{f64::consts::PI, ops::Range, sync::Arc};

use rustfft::{Fft, FftPlanner, num_complex::Complex};

use crate::{RATE, audio::tame};

/// The sound is filled up with silence to so much, samples.
pub(crate) const LENGTH: usize = 30 * RATE as usize;
/// A window, and how far it is to the next, samples.
const WINDOW: usize = 400;
const HOP: usize = 160;
/// Moments in a sound.
pub(crate) const MOMENTS: usize = LENGTH / HOP;

/// Less than this is nothing, and nothing counts as more than so much less than the loudest, powers of ten.
const LEAST: f32 = 1e-10;
const DEEPEST: f32 = 8.0;

/// A way to hear in so many bands.
pub(crate) struct Mel {
    bands: Vec<Band>,
    window: Vec<f32>,
    fft: Arc<dyn Fft<f32>>,
}

/// What frequencies count for in a band, from the first that does.
struct Band {
    from: usize,
    weights: Vec<f32>,
}

impl Mel {
    /// In so many bands.
    pub(crate) fn new(bands: usize) -> Self {
        let window = (0..WINDOW).map(|at| (0.5 - 0.5 * (2.0 * PI * at as f64 / WINDOW as f64).cos()) as f32).collect();
        // Edges lie evenly on the mel scale; each band goes from one to the next but one.
        let highest = mel(f64::from(RATE) / 2.0);
        let edges: Vec<f64> = (0..bands + 2).map(|at| hertz(highest * at as f64 / (bands + 1) as f64)).collect();
        let bands = edges.windows(3).map(|edges| Band::new([edges[0], edges[1], edges[2]])).collect();
        Self { bands, window, fft: FftPlanner::new().plan_fft_forward(WINDOW) }
    }

    /// How loud each band is: `[bands, MOMENTS]`. What is longer than [`LENGTH`] is cut.
    pub(crate) fn loudness(&self, samples: &[f32]) -> Vec<f32> {
        let samples = &samples[..samples.len().min(LENGTH)];
        let mut loudness = vec![LEAST.log10(); self.bands.len() * MOMENTS];
        let mut scratch = vec![Complex::default(); self.fft.get_inplace_scratch_len()];
        for moment in heard(samples.len()) {
            let power = self.power(samples, moment, &mut scratch);
            for (at, band) in self.bands.iter().enumerate() {
                loudness[at * MOMENTS + moment] = band.of(&power).max(LEAST).log10();
            }
        }
        let loudest = loudness.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        loudness.iter_mut().for_each(|value| *value = (value.max(loudest - DEEPEST) + 4.0) / 4.0);
        loudness
    }

    /// The power of each frequency in the window around a moment.
    fn power(&self, samples: &[f32], moment: usize, scratch: &mut [Complex<f32>]) -> Vec<f32> {
        let from = (moment * HOP) as i64 - (WINDOW / 2) as i64;
        let at = |at: usize| sample(samples, from + at as i64);
        let mut values: Vec<Complex<f32>> =
            self.window.iter().enumerate().map(|(place, weight)| Complex::new(at(place) * weight, 0.0)).collect();
        self.fft.process_with_scratch(&mut values, scratch);
        values[..=WINDOW / 2].iter().map(Complex::norm_sqr).collect()
    }
}

/// The moments whose windows reach into so many samples.
fn heard(length: usize) -> Range<usize> {
    if length == 0 { 0..0 } else { 0..((length + WINDOW / 2).div_ceil(HOP)).min(MOMENTS) }
}

/// A sample of the sound with its silence, mirrored at both ends.
fn sample(samples: &[f32], at: i64) -> f32 {
    let last = LENGTH as i64 - 1;
    let at = if at > last { 2 * last - at } else { at.abs() };
    samples.get(at as usize).map_or(0.0, |sample| tame(*sample))
}

impl Band {
    /// A triangle between edges, hertz, of the same area whatever its width.
    fn new([low, middle, high]: [f64; 3]) -> Self {
        let step = f64::from(RATE) / WINDOW as f64;
        let weight = |at: usize| {
            let hertz = at as f64 * step;
            ((hertz - low) / (middle - low)).min((high - hertz) / (high - middle)).max(0.0) * 2.0 / (high - low)
        };
        let counts = |at: &usize| weight(*at) > 0.0;
        let from = (0..=WINDOW / 2).find(counts).unwrap_or(0);
        let weights = (from..=WINDOW / 2).take_while(counts).map(|at| weight(at) as f32).collect();
        Self { from, weights }
    }

    fn of(&self, power: &[f32]) -> f32 {
        self.weights.iter().zip(&power[self.from..]).map(|(weight, power)| weight * power).sum()
    }
}

/// Slaney's scale (Auditory Toolbox, 1998): even up to 1 kHz, logarithmic above.
const EVEN_HZ: f64 = 200.0 / 3.0;
const BENDS_HZ: f64 = 1_000.0;
/// So many steps make 6.4 times the frequency.
const STEPS: f64 = 27.0;
const RATIO: f64 = 6.4;

fn mel(hertz: f64) -> f64 {
    if hertz < BENDS_HZ { hertz / EVEN_HZ } else { BENDS_HZ / EVEN_HZ + (hertz / BENDS_HZ).ln() * STEPS / RATIO.ln() }
}

fn hertz(mel: f64) -> f64 {
    let bends = BENDS_HZ / EVEN_HZ;
    if mel < bends { mel * EVEN_HZ } else { BENDS_HZ * ((mel - bends) * RATIO.ln() / STEPS).exp() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tones, one rising and one that swells, for 1.25 s.
    fn sound() -> Vec<f32> {
        let at = |at: u32| {
            let at = f64::from(at);
            (0.4 * (at * at * 2e-5).sin() + 0.2 * (at * 0.9).sin() * (at * 0.003).cos()) as f32
        };
        (0..20_000).map(at).collect()
    }

    /// Loudness in some bands at some moments, as `transformers` 4.46.3 computes it (`WhisperFeatureExtractor`).
    fn check(samples: &[f32], bands: usize, expected: &[(usize, usize, f32)]) {
        let found = Mel::new(bands).loudness(samples);
        assert_eq!(found.len(), bands * MOMENTS);
        for (band, moment, expected) in expected {
            let found = found[band * MOMENTS + moment];
            assert!((found - expected).abs() < 1e-3, "{found} for {expected} in band {band} at {moment}");
        }
    }

    #[test]
    fn loudness_is_what_the_reference_computes() {
        let expected = [
            (0, 0, 0.24790),
            (20, 0, 0.43618),
            (5, 10, 1.17609),
            (20, 60, 0.16352),
            (39, 47, -0.59048),
            (79, 124, -0.16733),
            (30, 125, 0.50786),
            (30, 126, -0.01661),
            (30, 127, -0.59048),
            (10, 2999, -0.59048),
        ];
        check(&sound(), 80, &expected);
        let expected = [
            (0, 0, 0.17214),
            (32, 0, 0.41876),
            (5, 10, 1.27307),
            (20, 60, -0.51007),
            (39, 47, 0.12957),
            (127, 124, -0.16765),
            (30, 126, -0.10139),
            (10, 2999, -0.54640),
        ];
        check(&sound(), 128, &expected);
    }

    #[test]
    fn a_sound_of_all_its_length_is_mirrored_at_its_end() {
        let tone: Vec<f32> = (0..LENGTH).map(|at| 0.5 * (at as f64 * 0.3).sin() as f32).collect();
        let expected = [(32, 1_500, -0.59080), (31, 2_999, -0.25344), (33, 2_999, -0.28330), (32, 2_999, -0.26908)];
        check(&tone, 80, &expected);
        assert_eq!(Mel::new(80).loudness(&[tone.clone(), tone.clone()].concat()), Mel::new(80).loudness(&tone));
    }

    #[test]
    fn silence_and_what_is_no_sound_are_alike() {
        let silence = Mel::new(80).loudness(&[]);
        assert!(silence.iter().all(|value| (value - -1.5).abs() < 1e-6));
        assert_eq!(Mel::new(80).loudness(&[f32::NAN; 400]), silence);
    }
}

//! Sounds: files, how loud they are, and the noise of a kitchen.

use std::{f32::consts::PI, fs, path::Path};

use cohabit_speech::{RATE, from_pcm, resample};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Samples of a 16-bit WAV file, its first channel, at [`RATE`].
pub fn read_wav(path: &Path) -> Option<Vec<f32>> {
    let bytes = fs::read(path).ok()?;
    let number = |at: usize, length: usize| {
        bytes
            .get(at..at + length)
            .map(|bytes| bytes.iter().rev().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte)))
    };
    let (mut at, mut channels, mut rate) = (12, 1, 0);
    loop {
        let (name, length) = (bytes.get(at..at + 4)?, number(at + 4, 4)?);
        match name {
            b"fmt " => (channels, rate) = (number(at + 10, 2)?, number(at + 12, 4)?),
            b"data" => {
                let data = &bytes[at + 8..bytes.len().min(at + 8 + length)];
                let frames = data.chunks_exact(2 * channels.max(1));
                let pcm: Vec<i16> = frames.map(|frame| i16::from_le_bytes([frame[0], frame[1]])).collect();
                return resample(&from_pcm(&pcm), rate as u32, RATE).ok();
            }
            _ => {}
        }
        at += 8 + length + length % 2;
    }
}

/// Writes samples at [`RATE`].
pub fn write_wav(path: &Path, pcm: &[i16]) {
    let length = 2 * pcm.len() as u32;
    let mut bytes = Vec::new();
    bytes.extend(b"RIFF");
    bytes.extend((36 + length).to_le_bytes());
    bytes.extend(b"WAVEfmt ");
    bytes.extend(16u32.to_le_bytes());
    bytes.extend([1, 0, 1, 0]);
    bytes.extend(RATE.to_le_bytes());
    bytes.extend((2 * RATE).to_le_bytes());
    bytes.extend([2, 0, 16, 0]);
    bytes.extend(b"data");
    bytes.extend(length.to_le_bytes());
    bytes.extend(pcm.iter().flat_map(|sample| sample.to_le_bytes()));
    fs::write(path, bytes).unwrap();
}

/// Root mean square of what is not silence.
pub fn loudness(samples: &[f32]) -> f32 {
    let loud: Vec<f32> = samples.iter().copied().filter(|sample| sample.abs() > 0.01).collect();
    (loud.iter().map(|sample| sample * sample).sum::<f32>() / loud.len().max(1) as f32).sqrt()
}

/// Where speech ends.
pub fn last_loud(samples: &[f32]) -> usize {
    let peak = samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    samples.iter().rposition(|sample| sample.abs() > peak * 0.03).unwrap_or(0)
}

/// A kitchen: a fridge that hums, a fan that blows, water that runs, dishes that clatter. The same each time.
pub struct Noise {
    random: ChaCha8Rng,
    at: usize,
    fan: f32,
    water: [f32; 2],
    /// Dishes that ring: their pitch in Hz, how loud they still are, and where they began.
    ringing: Vec<(f32, f32, usize)>,
}

impl Noise {
    pub fn new() -> Self {
        Self { random: ChaCha8Rng::seed_from_u64(10), at: 0, fan: 0.0, water: [0.0; 2], ringing: Vec::new() }
    }

    /// Adds so much noise that what has this loudness is so much louder.
    pub fn add(&mut self, samples: &mut [f32], loudness: f32, decibels: f32) {
        let noise: Vec<f32> = samples.iter().map(|_| self.next()).collect();
        let power = (noise.iter().map(|sample| sample * sample).sum::<f32>() / noise.len().max(1) as f32).sqrt();
        let scale = loudness / 10f32.powf(decibels / 20.0) / power.max(1e-9);
        for (sample, noise) in samples.iter_mut().zip(noise) {
            *sample = (*sample + scale * noise).clamp(-1.0, 1.0);
        }
    }

    fn next(&mut self) -> f32 {
        let time_s = self.at as f32 / RATE as f32;
        let wave = |hz: f32| (2.0 * PI * hz * (time_s % 100.0)).sin();
        let hum = 0.5 * wave(50.0) + 0.35 * wave(100.0) + 0.15 * wave(150.0) + 0.1 * wave(300.0);
        let white = self.uniform();
        self.fan += 0.05 * (white - self.fan);
        // Water: what is high, coming and going.
        let high = white - self.water[0];
        (self.water[0], self.water[1]) = (white, 0.7 * self.water[1] + 0.3 * high);
        let running = self.water[1] * (0.6 + 0.4 * (2.0 * PI * 0.2 * time_s).sin());
        if self.uniform() > 1.0 - 1.0 / RATE as f32 {
            let (pitch, loud) = (2_000.0 + 1_500.0 * self.uniform(), 1.0 + 0.7 * self.uniform());
            self.ringing.push((pitch, loud, self.at));
        }
        let age_s = |began: usize| (self.at - began) as f32 / RATE as f32;
        let ring = |(pitch, loud, began): &(f32, f32, usize)| {
            let age_s = age_s(*began);
            loud * (-age_s / 0.06).exp()
                * ((2.0 * PI * pitch * age_s).sin() + 0.5 * (2.0 * PI * pitch * 2.7 * age_s).sin())
        };
        let clatter: f32 = self.ringing.iter().map(ring).sum();
        self.ringing.retain(|(.., began)| (self.at - began) < RATE as usize / 2);
        self.at += 1;
        0.35 * hum + 1.6 * self.fan + 0.12 * running + 0.5 * clatter
    }

    /// From -1 to 1.
    fn uniform(&mut self) -> f32 {
        (self.random.next_u32() >> 8) as f32 / (1u32 << 23) as f32 - 1.0
    }
}

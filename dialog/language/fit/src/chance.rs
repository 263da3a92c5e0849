//! Draws that a seed repeats.

use std::ops::Range;

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng as _, SeedableRng as _},
};

/// A source of chance.
pub struct Chance(ChaCha8Rng);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// From 0 up to 1.
    pub fn share(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1_u32 << 24) as f32
    }

    pub fn happens(&mut self, probability: f32) -> bool {
        self.share() < probability
    }

    pub fn within(&mut self, range: Range<usize>) -> usize {
        range.start + (self.share() * range.len() as f32) as usize
    }

    /// One of `all`, which are some.
    pub fn pick<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.within(0..all.len())]
    }

    /// The index of one of these, as probable as its weight.
    pub fn weighted(&mut self, weights: &[f32]) -> usize {
        let mut left = self.share() * weights.iter().sum::<f32>();
        weights
            .iter()
            .position(|weight| {
                left -= weight;
                left < 0.0
            })
            .unwrap_or(weights.len() - 1)
    }
}

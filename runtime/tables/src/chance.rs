//! Draws that follow from a seed and the number of a stream alone, whatever was drawn from other streams before.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng as _, SeedableRng as _},
};

/// A source of draws.
#[derive(Clone, Debug)]
pub struct Chance {
    random: ChaCha8Rng,
    /// The second of two normal draws, until it is asked for.
    spare: Option<f64>,
}

impl Chance {
    /// The draws of a stream of a seed.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        Self { random, spare: None }
    }

    /// A number of any size, such as the seed of other draws.
    pub fn seed(&mut self) -> u64 {
        self.random.next_u64()
    }

    /// A number below `count`; 0 where that is 0.
    pub fn below(&mut self, count: usize) -> usize {
        // Of 2^64 draws the remainder favours none by more than one in 2^50.
        if count == 0 { 0 } else { (self.random.next_u64() % count as u64) as usize }
    }

    /// Uniform from 0 to below 1.
    pub fn share(&mut self) -> f64 {
        (self.random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// True in that share of all draws.
    pub fn is(&mut self, share: f64) -> bool {
        self.share() < share
    }

    /// One of them, if there is any.
    pub fn pick<'a, T>(&mut self, from: &'a [T]) -> Option<&'a T> {
        from.get(self.below(from.len()))
    }

    /// A random order of what is given (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for at in (1..items.len()).rev() {
            let other = self.below(at + 1);
            items.swap(at, other);
        }
    }

    /// The numbers below `count` in a random order.
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        self.shuffle(&mut order);
        order
    }

    /// From the standard normal distribution, by Marsaglia's polar method (Marsaglia and Bray 1964).
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let (a, b) = (2.0 * self.share() - 1.0, 2.0 * self.share() - 1.0);
            let square = a * a + b * b;
            if square > 0.0 && square < 1.0 {
                let factor = (-2.0 * square.ln() / square).sqrt();
                self.spare = Some(b * factor);
                return a * factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_follow_from_seed_and_stream() {
        let drawn = |seed, stream| {
            let mut chance = Chance::new(seed, stream);
            (chance.order(9), chance.below(1000), chance.normal().to_bits())
        };
        assert_eq!(drawn(1, 2), drawn(1, 2));
        assert!(drawn(1, 2) != drawn(1, 3) && drawn(1, 2) != drawn(2, 2));
    }

    #[test]
    fn draws_are_spread_as_they_say() {
        const DRAWS: usize = 20_000;
        let mut chance = Chance::new(7, 0);
        let hits = (0..DRAWS).filter(|_| chance.is(0.3)).count();
        assert!((5_700..6_300).contains(&hits), "{hits}");
        let drawn: Vec<f64> = (0..DRAWS).map(|_| chance.normal()).collect();
        let mean = drawn.iter().sum::<f64>() / DRAWS as f64;
        let variance = drawn.iter().map(|value| value * value).sum::<f64>() / DRAWS as f64;
        // Four standard errors of each.
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.04, "{mean} {variance}");
        assert!(!chance.is(0.0) && chance.is(1.0) && chance.below(0) == 0 && chance.pick::<u8>(&[]).is_none());
    }
}

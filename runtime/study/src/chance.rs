//! Draws that follow from a seed, a purpose and a number alone, whatever was drawn before.

use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng as _, SeedableRng as _},
};

/// What is drawn. Each purpose has streams of its own, so that one draw more of one changes nothing of another.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    /// Which between-participants condition.
    Between = 1,
    /// The order of within-participant conditions.
    Conditions = 2,
    /// The order of missions.
    Missions = 3,
}

/// A source of draws.
pub(crate) struct Chance(ChaCha8Rng);

impl Chance {
    /// The draws of a seed for the `number`-th of a purpose.
    pub(crate) fn new(seed: u64, purpose: Purpose, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream((purpose as u64) << 56 ^ number);
        Self(rng)
    }

    /// A random order of what is given (Fisher and Yates).
    pub(crate) fn shuffle<T>(&mut self, items: &mut [T]) {
        for at in (1..items.len()).rev() {
            // Of 2^64 draws the remainder favours none by more than one in 2^50.
            let other = (self.0.next_u64() % (at as u64 + 1)) as usize;
            items.swap(at, other);
        }
    }

    /// The numbers below `count` in a random order.
    pub(crate) fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        self.shuffle(&mut order);
        order
    }
}

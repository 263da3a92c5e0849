//! How long a plan is searched for.

use std::time::Duration;

/// When a search gives up.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// States that are looked at.
    pub states: usize,
    /// Time that it takes.
    pub time: Duration,
}

impl Limits {
    /// No limit of time: what comes of a search then depends on no machine.
    #[must_use]
    pub const fn of_states(states: usize) -> Self {
        Self { states, time: Duration::MAX }
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self { states: 20_000, time: Duration::from_secs(10) }
    }
}

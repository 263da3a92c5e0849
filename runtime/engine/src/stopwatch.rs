//! How long the stages of a tick take.

use std::time::Instant;

use cohabit_bus::message::Stage;
use cohabit_world::Phase;

/// Times one stage after the other.
pub(crate) struct Stopwatch {
    lap: Instant,
    /// What each stage took when it last was, ns.
    pub nanos: [u32; 10],
}

impl Stopwatch {
    pub fn new() -> Self {
        Self { lap: Instant::now(), nanos: [0; 10] }
    }

    /// What is timed next begins now.
    pub fn restart(&mut self) {
        self.lap = Instant::now();
    }

    /// A stage is over, and the next begins.
    pub fn over(&mut self, stage: Stage) {
        let now = Instant::now();
        let took = now.duration_since(self.lap).as_nanos();
        self.nanos[stage as usize] = u32::try_from(took).unwrap_or(u32::MAX);
        self.lap = now;
    }
}

/// The stage that a phase of the world's step is.
pub(crate) const fn stage_of(phase: Phase) -> Stage {
    match phase {
        Phase::Rule => Stage::Rule,
        Phase::Move => Stage::Move,
        Phase::Work => Stage::Work,
        Phase::Physics => Stage::Physics,
        Phase::Judge => Stage::Judge,
    }
}

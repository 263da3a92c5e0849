//! How the world's time goes by: settings of a session.

use std::{ffi::OsString, fmt};

use cohabit_bus::message::Control;
use cohabit_engine::SessionPlan;

/// How the world's time goes by.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Timing {
    /// How many times as fast as real time the world begins, 0.05 to 20
    #[arg(long, default_value_t = 1.0, value_parser = speed)]
    pub(super) speed: f32,
    /// Begin with the world standing still: `cohabit time resume` has it go on
    #[arg(long)]
    pub(super) paused: bool,
    /// In lock-step instead of real time: the world waits for each agent that attends, tick by tick, and goes as fast as
    /// they do
    #[arg(long, conflicts_with = "speed")]
    lock_step: bool,
    /// In lock-step, the world begins when so many agents attend; if absent, one, or as many as `play` starts
    #[arg(long, requires = "lock_step")]
    agents: Option<usize>,
}

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lock_step {
            true => write!(f, "lock-step with {} agents", self.agents()),
            false => write!(f, "real time, {} times", self.speed),
        }
    }
}

/// A speed that the clock takes.
pub fn speed(text: &str) -> Result<f32, String> {
    let speeds = Control::SPEEDS;
    let speed = text.parse().ok().filter(|speed| speeds.contains(speed));
    speed.ok_or_else(|| format!("from {} to {} times real time", speeds.start(), speeds.end()))
}

impl Timing {
    /// How many times as fast as real time the world begins.
    pub const fn speed(self) -> f32 {
        self.speed
    }

    /// The same choice as arguments of another process.
    pub fn arguments(self) -> Vec<OsString> {
        let mut arguments = Vec::new();
        if self.lock_step {
            arguments.extend(["--lock-step".into(), "--agents".into(), self.agents().to_string().into()]);
        } else {
            arguments.extend(["--speed".into(), self.speed.to_string().into()]);
        }
        arguments.extend(self.paused.then(|| "--paused".into()));
        arguments
    }

    /// The same; it begins with so many agents, if it was not said how many.
    pub fn with_agents(self, agents: usize) -> Self {
        Self { agents: self.agents.or(Some(agents)), ..self }
    }

    fn agents(self) -> usize {
        self.agents.unwrap_or(1)
    }

    /// A session as it is planned, in this time.
    pub fn of(self, plan: SessionPlan) -> SessionPlan {
        if self.lock_step { plan.in_lock_step(self.agents()) } else { plan }
    }
}

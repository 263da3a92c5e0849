//! `cohabit time`: how the world's time goes by.

use std::time::{Duration, Instant};

use clap::Subcommand;
use cohabit_bus::{
    Inbox, Shm, Topic, Transport, Wake,
    message::{self, Control, ControlMessage, EventKind, EventMessage},
    monotonic_nanos,
};

use crate::{failure::joining, peers, sessions, terminal::shown};

/// How long the simulator may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);

/// Has the world of a running session stand still, go on, step, or go faster; the session's log says when.
#[derive(clap::Args)]
pub struct Time {
    /// The session's name; the one that runs, if absent
    #[arg(long, global = true)]
    session: Option<String>,
    #[command(subcommand)]
    change: Change,
}

#[derive(Clone, Copy, Subcommand)]
enum Change {
    /// The world stands still; it can still be looked at
    Pause,
    /// The world goes on
    Resume,
    /// The world goes on for so many ticks of a 60th of a second, and stands still again
    Step {
        /// How many ticks
        #[arg(default_value_t = 1)]
        ticks: u32,
    },
    /// The world goes so many times as fast as real time, 0.05 to 20; in lock-step no speed counts
    Speed {
        /// How many times
        #[arg(value_parser = peers::speed)]
        factor: f32,
    },
}

impl From<Change> for Control {
    fn from(change: Change) -> Self {
        match change {
            Change::Pause => Self::Pause,
            Change::Resume => Self::Resume,
            Change::Step { ticks } => Self::Step(ticks),
            Change::Speed { factor } => Self::Speed(factor),
        }
    }
}

impl Time {
    /// Asks for the change, and waits until the simulator tells of it.
    pub fn run(&self) -> anyhow::Result<()> {
        let session = sessions::running(self.session.as_deref())?;
        let bus = Shm::join(&session).map_err(joining)?;
        let mut bell = bus.listener(Wake::Talk)?;
        let mut events = Inbox::new(&bus, Topic::Events)?;
        let asked_nanos = monotonic_nanos();
        // Kept until the answer: what is sent is lost with its publisher, if the simulator has not noticed that one yet.
        let mut controls = bus.publisher(Topic::Control)?;
        controls.send_record(0, &ControlMessage::from(Control::from(self.change)))?;
        let deadline = Instant::now() + PATIENCE;
        while Instant::now() < deadline {
            while let Some((sample, event)) = events.next(|sample| message::read::<EventMessage>(sample.payload()))? {
                if event.kind() == Some(EventKind::Clock) && sample.envelope().sent_nanos >= asked_nanos {
                    println!("{}: {}, at tick {}", session.name(), shown(event.text.as_str()), sample.envelope().tick);
                    return Ok(());
                }
            }
            bell.wait(Duration::from_millis(50))?;
        }
        anyhow::bail!("the simulator of {} does not answer: `cohabit top` shows how it is", session.name())
    }
}

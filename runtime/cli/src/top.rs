//! `cohabit top`: a running session, live in the terminal.

mod process;
mod sheet;
mod window;

use std::{
    io::{self, IsTerminal as _},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::Duration,
};

use cohabit_bus::{
    Heart, Inbox, Sample, Shm, Topic, Transport,
    message::{self, NONE, PulseMessage, StateView, TickView},
    monotonic_nanos,
};

use crate::{failure::joining, sessions, stop, terminal::print};
use sheet::Sheet;
use window::Window;

/// Shows a running session live: ticks a second, how long their stages take and how late they begin, and each peer.
#[derive(clap::Args)]
pub struct Top {
    /// The session's name; the one that runs, if absent
    #[arg(long)]
    session: Option<String>,
    /// Print one JSON document about the last ten seconds, and end
    #[arg(long)]
    json: bool,
    /// Print once, after so many seconds, and end
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    once: Option<f32>,
}

/// The longest that is waited for one look, s.
const LONGEST_S: f32 = 3600.0;

fn seconds(text: &str) -> Result<f32, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=LONGEST_S).contains(seconds));
    seconds.ok_or_else(|| format!("seconds, from 0 to {LONGEST_S}, such as 2"))
}

/// How often the screen is drawn anew.
const EVERY: Duration = Duration::from_millis(500);
/// Clears the screen; goes to its top; clears what is left of a line, and of the screen.
const CLEAR: &str = "\x1b[2J";
const HOME: &str = "\x1b[H";
const REST_OF_LINE: &str = "\x1b[K";
const REST_OF_SCREEN: &str = "\x1b[J";

impl Top {
    /// Shows until the user ends it.
    pub fn run(&self) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let session = sessions::running(self.session.as_deref())?;
        let bus = Shm::join(&session).map_err(joining)?;
        let mut watch = Watch::new(&bus)?;
        let live = io::stdout().is_terminal() && !self.json && self.once.is_none();
        if let Some(seconds) = self.once.or((!live).then_some(1.0)) {
            watch.look_for(Duration::from_secs_f32(seconds), &stop)?;
            let sheet = watch.sheet(session.name());
            return print(&if self.json { format!("{}\n", sheet.json()) } else { sheet.to_string() });
        }
        print(CLEAR)?;
        while !stop.load(Ordering::Relaxed) {
            watch.look_for(EVERY, &stop)?;
            let text = watch.sheet(session.name()).to_string().replace('\n', &format!("{REST_OF_LINE}\n"));
            print(&format!("{HOME}{text}{REST_OF_SCREEN}"))?;
        }
        Ok(())
    }
}

/// What is watched of a session.
struct Watch {
    ticks: Inbox,
    pulses: Inbox,
    states: Inbox,
    heart: Heart,
    window: Window,
    paused: bool,
}

impl Watch {
    fn new(bus: &dyn Transport) -> anyhow::Result<Self> {
        Ok(Self {
            ticks: Inbox::new(bus, Topic::Ticks)?,
            pulses: Inbox::new(bus, Topic::Pulses)?,
            states: Inbox::new(bus, Topic::State)?,
            heart: Heart::new(bus, "top", NONE)?,
            window: Window::default(),
            paused: false,
        })
    }

    fn look_for(&mut self, time: Duration, stop: &AtomicBool) -> anyhow::Result<()> {
        self.take_in()?;
        self.window.forget();
        let until = monotonic_nanos() + u64::try_from(time.as_nanos())?;
        while monotonic_nanos() < until && !stop.load(Ordering::Relaxed) {
            // Ticks wait in shared memory: there is no need to be woken by each.
            thread::sleep(Duration::from_millis(50));
            self.take_in()?;
        }
        Ok(())
    }

    fn take_in(&mut self) -> anyhow::Result<()> {
        while let Some((sample, header)) = self.ticks.next(|sample| Ok(*TickView::new(sample.payload())?.header))? {
            self.window.note_tick(sample.envelope(), &header);
        }
        while let Some((sample, pulse)) = self.pulses.next(|sample| message::read::<PulseMessage>(sample.payload()))? {
            self.window.note_pulse(sample.envelope(), pulse);
        }
        let is_paused = |sample: &Sample| Ok(StateView::new(sample.payload())?.header.paused == 1);
        if let Some((_, paused)) = self.states.latest(is_paused)? {
            self.paused = paused;
        }
        self.heart.beat(self.window.newest_tick(), self.ticks.lost())?;
        Ok(())
    }

    fn sheet(&mut self, session: &str) -> Sheet {
        self.window.forget();
        Sheet::new(session, self.paused, &self.window)
    }
}

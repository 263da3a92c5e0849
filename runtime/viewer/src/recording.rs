//! Where all that is shown goes: rerun's stream, under one root, on the three timelines.

use anyhow::Context as _;
use re_sdk::{AsComponents, RecordingStream, TimeCell};
use re_sdk_types::archetypes::{Clear, SeriesLines};

/// The timeline of ticks.
pub const TICK: &str = "tick";
/// The timeline of simulated time.
pub const SIMULATED: &str = "sim_time";
/// The timeline of wall time.
pub const WALL: &str = "wall_time";

/// A moment of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct When {
    /// The tick.
    pub tick: u64,
    /// Wall time of its start, ns since 1970; 0 where it is not known.
    pub wall_nanos: u64,
}

impl When {
    /// Simulated time, ns.
    pub fn simulated_nanos(self) -> i64 {
        i64::try_from(self.tick.saturating_mul(cohabit_world::DT_NANOS)).unwrap_or(i64::MAX)
    }
}

/// Which of a recording's sessions one is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Side {
    /// There is no other.
    Only,
    /// The first of two.
    A,
    /// The second.
    B,
}

impl Side {
    /// What the paths of its entities begin with.
    pub const fn root(self) -> &'static str {
        match self {
            Self::Only => "",
            Self::A => "a/",
            Self::B => "b/",
        }
    }

    /// `name` as people are to read it.
    pub fn name(self, name: &str) -> String {
        match self {
            Self::Only => name.to_owned(),
            Self::A => format!("A: {name}"),
            Self::B => format!("B: {name}"),
        }
    }

    /// The colour of what is `color` where there is no other: beside the first, the second is dim.
    pub fn color(self, color: [u8; 3]) -> [u8; 3] {
        if self == Self::B { color.map(|channel| channel / 2) } else { color }
    }
}

/// One session's part of a recording.
#[derive(Clone, Debug)]
pub struct Recording {
    stream: RecordingStream,
    /// Which session's.
    pub side: Side,
}

impl Recording {
    /// All that is logged goes into `stream`, below the root of its side.
    pub fn new(stream: RecordingStream, side: Side) -> Self {
        // What is logged belongs to moments of the session, not to those of logging.
        stream.set_log_tick_enabled(false);
        stream.set_log_time_enabled(false);
        Self { stream, side }
    }

    /// What is logged next belongs to this moment.
    pub fn at(&self, when: When) {
        let tick = i64::try_from(when.tick).unwrap_or(i64::MAX);
        self.stream.set_time_sequence(TICK, tick);
        self.stream.set_time(SIMULATED, TimeCell::from_duration_nanos(when.simulated_nanos()));
        if when.wall_nanos == 0 {
            self.stream.disable_timeline(WALL);
        } else {
            let nanos = i64::try_from(when.wall_nanos).unwrap_or(i64::MAX);
            self.stream.set_timestamp_nanos_since_epoch(WALL, nanos);
        }
    }

    /// Logs at the present moment.
    pub fn log(&self, path: &str, what: &impl AsComponents) -> anyhow::Result<()> {
        self.stream.log(self.path(path), what).with_context(|| format!("log `{path}`"))
    }

    /// Logs what holds always.
    pub fn log_always(&self, path: &str, what: &impl AsComponents) -> anyhow::Result<()> {
        self.stream.log_static(self.path(path), what).with_context(|| format!("log `{path}`"))
    }

    /// Logs how a line of a plot looks.
    pub fn log_line(&self, path: &str, name: &str, color: [u8; 3], line: SeriesLines) -> anyhow::Result<()> {
        self.log_always(path, &line.with_names([self.side.name(name)]).with_colors([self.side.color(color)]))
    }

    /// From now on nothing is there, nor below.
    pub fn clear(&self, path: &str) -> anyhow::Result<()> {
        self.log(path, &Clear::recursive())
    }

    fn path(&self, path: &str) -> String {
        format!("{}{path}", self.side.root())
    }
}

/// A part of a path: what rerun would read as more than a name becomes an underscore.
pub fn part(name: &str) -> String {
    name.chars().map(|letter| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '_' }).collect()
}

//! Going on live from a point of a recorded session.

use std::{ffi::OsString, fmt, path::PathBuf, str::FromStr, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_engine::{Appearance, Replayer, SessionPlan};
use cohabit_record::{Branch, Log};
use cohabit_world::World;

use crate::{failure::bad_input, session_time::SessionTime};

/// A point of a recorded session, such as `session.mcap@1:23.5`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct BranchPoint {
    /// Its log.
    pub log: PathBuf,
    /// When.
    pub at: SessionTime,
}

impl FromStr for BranchPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (log, at) = text.rsplit_once('@').ok_or("LOG@TIME, such as session.mcap@1:23.5")?;
        Ok(Self { log: log.into(), at: at.parse().map_err(|error| format!("{error}"))? })
    }
}

impl fmt::Display for BranchPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}@tick:{}", self.log.display(), self.at.tick)
    }
}

/// What was played up to there, and the world as it was.
pub struct Branched {
    /// What was played: mission, floor plan, bodies, cameras.
    pub plan: SessionPlan,
    /// The world after that tick.
    pub world: World,
    /// What was seen of it besides.
    pub appearance: Appearance,
    /// Where that was.
    pub from: Branch,
    /// Its log.
    pub log: Log,
}

impl BranchPoint {
    /// Goes there, in a world with this catalogue; fails if the session does not come out as it was recorded.
    pub fn open(&self, catalog: &Arc<Catalog>) -> anyhow::Result<Branched> {
        let log = Log::open(&self.log).map_err(bad_input)?;
        let (name, tick) = (self.log.display(), self.at.tick);
        let mut replayer = Replayer::new(&log, Arc::clone(catalog)).map_err(bad_input)?;
        let [first, last] = replayer.span();
        if !(first..=last).contains(&tick) {
            let [first, last] = [first, last].map(|tick| SessionTime { tick });
            return Err(bad_input(format!("{name}: it goes from {first} to {last}, not to {}", self.at)));
        }
        replayer.go_to(tick).map_err(bad_input)?;
        if replayer.world().tick() != tick {
            return Err(bad_input(format!("{name}: tick {tick} cannot be reached: the log has a gap before it")));
        }
        if let Some(difference) = replayer.difference_here() {
            return Err(bad_input(format!("{name}: it comes out otherwise than it was recorded: {difference}")));
        }
        let plan = replayer.plan().clone();
        let (world, appearance) = replayer.into_parts();
        let from = Branch { session: log.session.session.clone(), run: log.session.run, tick };
        Ok(Branched { plan, world, appearance, from, log })
    }

    /// The same choice as an argument of another process.
    pub fn argument(&self) -> OsString {
        let mut argument = OsString::from("--branch=");
        argument.push(&self.log);
        argument.push(format!("@tick:{}", self.at.tick));
        argument
    }
}

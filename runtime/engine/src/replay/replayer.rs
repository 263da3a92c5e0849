//! A recorded session that is gone through again, tick by tick.

use std::sync::Arc;

use cohabit_bus::message::StateParts;
use cohabit_cdf::{BodyId, Catalog, PackId};
use cohabit_record::{InputEntry, Log, SessionEntry, Snapshot, TickEntry, entry::hex};
use cohabit_world::{Input, Report, World};

use super::Difference;
use crate::{
    appearance::{Appearance, Visible},
    build::{BuildError, SessionPlan},
    camera_plan::{CameraPlan, CameraPlanError},
    report, snapshot,
    snapshot::RestoreError,
};

/// Why a session cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// Its mission cannot be built by this program.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// It was played with a world pack that is not there.
    #[error(
        "the session was played with the world pack {pack}, which is not given{given}: name its folder by `--world`, packs \
         in the order in which they were played with"
    )]
    NoPack {
        /// The pack.
        pack: PackId,
        /// What is given in its place, in words.
        given: String,
    },
    /// It was played without a world pack that is there.
    #[error("the session was played without the world pack {pack}: leave its `--world` out")]
    OtherPack {
        /// The pack.
        pack: PackId,
    },
    /// One of its cameras cannot.
    #[error("a camera of the session: {0}")]
    Camera(#[from] CameraPlanError),
    /// Its ticks are not one after the other.
    #[error(
        "the log's ticks are not in their order: tick {second} follows tick {first}; nothing of it can be compared"
    )]
    Disorder {
        /// A tick.
        first: u64,
        /// The one that follows it in the log.
        second: u64,
    },
    /// It does not begin at the beginning, and has no state to go on from.
    #[error("the log begins after tick {tick} without a snapshot of it: nothing of it can be replayed")]
    NoBeginning {
        /// The tick before its first.
        tick: u64,
    },
    /// It does not begin at the beginning, and the state that it begins with cannot be taken up.
    #[error("the log begins after tick {tick}, and its snapshot of that tick is of no use: {source}")]
    Beginning {
        /// The tick before its first.
        tick: u64,
        /// Why.
        source: RestoreError,
    },
}

/// A recorded session that is gone through again, tick by tick: the same world, fed from its log.
pub struct Replayer<'a> {
    log: &'a Log,
    plan: SessionPlan,
    world: World,
    appearance: Appearance,
    /// The place in the log of the tick that comes next.
    next: usize,
}

/// A recorded tick that was simulated again.
pub struct Replayed<'a> {
    /// The tick as it was recorded.
    pub entry: &'a TickEntry,
    /// What it took in.
    pub inputs: Vec<Input>,
    /// What came of it now.
    pub report: Report,
    /// How that differs from what was recorded, if it does.
    pub difference: Option<Difference>,
}

impl<'a> Replayer<'a> {
    /// The session of `log`, before its first tick.
    ///
    /// # Errors
    /// [`ReplayError`], when the log's session cannot be played by this program.
    pub fn new(log: &'a Log, catalog: Arc<Catalog>) -> Result<Self, ReplayError> {
        if let Some([first, second]) = log.disorder() {
            return Err(ReplayError::Disorder { first, second });
        }
        compare_packs(&log.session.packs, catalog.packs())?;
        let plan = plan(&log.session, catalog)?;
        let world = plan.build()?;
        let mut replayer = Self { log, plan, world, appearance: Appearance::default(), next: 0 };
        let tick = replayer.before_first();
        if tick > 0 {
            let snapshot = log.snapshots.iter().find(|snapshot| snapshot.tick >= tick);
            let snapshot = snapshot.ok_or(ReplayError::NoBeginning { tick })?;
            replayer.restore(snapshot).map_err(|source| ReplayError::Beginning { tick, source })?;
        }
        Ok(replayer)
    }

    /// Simulates the next tick of the log; `None` at its end, or where it has a gap.
    pub fn step(&mut self) -> Option<Replayed<'a>> {
        let (entry, inputs, report) = self.advance()?;
        let difference = Difference::between(entry.tick, &entry.digest, &self.digest());
        Some(Replayed { entry, inputs, report, difference })
    }

    /// The same, without comparing.
    pub(crate) fn advance(&mut self) -> Option<(&'a TickEntry, Vec<Input>, Report)> {
        if self.gap().is_some() {
            return None;
        }
        let entry = self.log.ticks.get(self.next)?;
        self.next += 1;
        let inputs: Vec<Input> = entry.inputs.iter().map(input).collect();
        let report = self.world.step(&inputs);
        self.appearance.note(&self.world, &inputs, &report);
        Some((entry, inputs, report))
    }

    /// The state's digest as this log has it.
    fn digest(&self) -> String {
        let is_old = self.log.session.format == 1;
        hex(&if is_old { self.world.digest_as_one() } else { self.world.digest() })
    }

    /// How the state here differs from what was recorded, if it does, and this tick was.
    #[must_use]
    pub fn difference_here(&self) -> Option<Difference> {
        let entry = self.log.ticks[..self.next].last().filter(|entry| entry.tick == self.world.tick())?;
        Difference::between(entry.tick, &entry.digest, &self.digest())
    }

    /// What is missing where [`Self::step`] cannot go on, if it is not the end.
    #[must_use]
    pub fn gap(&self) -> Option<Difference> {
        let (expected, found) = (self.world.tick() + 1, self.log.ticks.get(self.next)?.tick);
        (found != expected).then_some(Difference::Missing { tick: expected, found })
    }

    /// Goes on from the next snapshot; whether there is one that can be taken up.
    pub fn skip_gap(&mut self) -> bool {
        let from = self.log.snapshots.partition_point(|snapshot| snapshot.tick <= self.world.tick());
        let log = self.log;
        log.snapshots[from..].iter().any(|snapshot| self.restore(snapshot).is_ok())
    }

    /// Goes to the state after `tick`, or as near before it as the log's gaps let it: on from here or from the nearest
    /// snapshot, whichever is nearer. Nothing is compared on the way.
    ///
    /// # Errors
    /// [`ReplayError`], where it has to begin anew and cannot.
    pub fn go_to(&mut self, tick: u64) -> Result<(), ReplayError> {
        let (log, here) = (self.log, self.world.tick());
        let is_back = tick < here;
        let nearer = log.snapshots.iter().rev().filter(|snapshot| snapshot.tick <= tick);
        let nearer = nearer.take_while(|snapshot| is_back || snapshot.tick > here);
        let found = nearer.into_iter().any(|snapshot| self.restore(snapshot).is_ok());
        if is_back && !found {
            *self = Self::new(log, Arc::clone(&self.plan.catalog))?;
        }
        while self.world.tick() < tick && self.advance().is_some() {}
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<(), RestoreError> {
        let state = snapshot.unpack().map_err(|_| RestoreError::Damaged)?;
        self.appearance = snapshot::restore(&mut self.world, &state)?;
        self.next = self.log.ticks.partition_point(|entry| entry.tick <= self.world.tick());
        Ok(())
    }

    /// Goes on to the next snapshot: its tick, and what of it differs from the state here.
    pub(super) fn differences(&mut self) -> Option<(u64, Vec<String>)> {
        let snapshot = self.log.snapshots.iter().find(|snapshot| snapshot.tick >= self.world.tick())?;
        while self.world.tick() < snapshot.tick && self.advance().is_some() {}
        let mut recorded = self.plan.build().ok()?;
        snapshot::restore(&mut recorded, &snapshot.unpack().ok()?).ok()?;
        (self.world.tick() == snapshot.tick).then(|| (snapshot.tick, recorded.differences(&self.world)))
    }

    /// The tick before the log's first; that of its newest snapshot, if it has no tick.
    fn before_first(&self) -> u64 {
        let branched = || self.log.session.branched.as_ref().map_or(0, |branch| branch.tick);
        self.log.ticks.first().map_or_else(branched, |entry| entry.tick.saturating_sub(1))
    }

    /// The first tick after which there is a state, and the last.
    #[must_use]
    pub fn span(&self) -> [u64; 2] {
        let first = self.before_first();
        [first, self.log.ticks.last().map_or(first, |entry| entry.tick)]
    }

    /// The log that it goes through.
    #[must_use]
    pub const fn log(&self) -> &'a Log {
        self.log
    }

    /// What was played: mission, floor plan, catalogue, bodies, cameras.
    #[must_use]
    pub const fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// The world after the latest tick.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The world after the latest tick, to go on from otherwise; and what is seen of it besides.
    #[must_use]
    pub fn into_parts(self) -> (World, Appearance) {
        (self.world, self.appearance)
    }

    /// The same as peers of a session are told.
    #[must_use]
    pub fn state(&self) -> StateParts {
        report::state(&self.world)
    }

    /// The same as cameras see it: for [`Stills`](crate::Stills).
    #[must_use]
    pub const fn visible(&self) -> Visible<'_> {
        Visible { world: &self.world, appearance: &self.appearance }
    }
}

/// What a session played.
/// A session comes out the same in the world that it was played in alone.
fn compare_packs(played: &[PackId], given: &[PackId]) -> Result<(), ReplayError> {
    for (index, pack) in played.iter().enumerate() {
        if given.get(index) != Some(pack) {
            let other = given.iter().find(|other| other.name == pack.name).or_else(|| given.get(index));
            let given = other.map_or_else(String::new, |other| format!(", but {other}"));
            return Err(ReplayError::NoPack { pack: pack.clone(), given });
        }
    }
    given.get(played.len()).map_or(Ok(()), |pack| Err(ReplayError::OtherPack { pack: pack.clone() }))
}

fn plan(session: &SessionEntry, catalog: Arc<Catalog>) -> Result<SessionPlan, ReplayError> {
    let plan = SessionPlan::new(&session.mission_file, &session.mission_text, catalog, session.seed)?;
    let cameras = session.cameras.iter().map(|camera| camera.parse()).collect::<Result<Vec<CameraPlan>, _>>()?;
    Ok(plan.with_bodies(session.bodies.clone()).with_cameras(cameras)?)
}

fn input(entry: &InputEntry) -> Input {
    Input { command: entry.command, body: BodyId(entry.body), action: entry.action }
}

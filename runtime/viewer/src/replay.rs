//! A recorded session, simulated again and shown.

use std::{path::Path, sync::Arc};

use anyhow::Context as _;
use cohabit_bus::{
    CameraId, Local, Subscriber, Topic, Transport as _,
    message::{FrameView, Plane},
};
use cohabit_cdf::Catalog;
use cohabit_engine::{CameraPlan, Replayer, Stills};
use cohabit_record::{Log, SessionEntry, TickEntry};
use cohabit_render::{CpuRenderer, MeshLibrary};
use re_sdk::RecordingStream;

use crate::{
    panes::Contents,
    recording::{Recording, Side, When},
    showing::Showing,
};

/// The scene is told so often.
const SCENE_EVERY_TICKS: u64 = 3;
/// Simulated ticks a second.
const TICKS_PER_S: f32 = 1e9 / cohabit_world::DT_NANOS as f32;

/// What of a session is shown besides its scene and its dialog.
#[derive(Clone, Debug, clap::Args)]
pub struct Seen {
    /// Pictures of the robot's camera a simulated second; 0 for none
    #[arg(long, default_value_t = 10.0, value_parser = rate)]
    pub rate: f32,
    /// What they show: color, depth, normals, ids, with plus signs between; or none
    #[arg(long, value_name = "PLANE[+PLANE]", default_value = "color+depth+normals+ids", value_parser = planes)]
    pub planes: Planes,
}

/// Planes that are wanted.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Planes(pub Vec<Plane>);

fn rate(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|rate| (0.0..=60.0).contains(rate)).ok_or_else(|| "from 0 to 60 a second".to_owned())
}

fn planes(text: &str) -> Result<Planes, String> {
    let known = || Plane::ALL.map(Plane::name).join(", ");
    let plane = |name: &str| {
        let found = Plane::ALL.into_iter().find(|plane| plane.name() == name);
        found.ok_or_else(|| format!("there is no `{name}`: {}, or none", known()))
    };
    if text == "none" {
        return Ok(Planes(Vec::new()));
    }
    let mut planes = text.split('+').map(plane).collect::<Result<Vec<_>, _>>()?;
    planes.sort_by_key(|plane| *plane as u8);
    planes.dedup();
    Ok(Planes(planes))
}

/// The camera of the body that is spoken to.
pub const CAMERA: CameraId = CameraId::Egocentric(0);

/// A log, and what a replay of it needs.
pub struct Session {
    log: Log,
    catalog: Arc<Catalog>,
    meshes: Arc<MeshLibrary>,
}

impl Session {
    /// Reads a log.
    pub fn open(path: &Path, catalog: &Arc<Catalog>, meshes: &Arc<MeshLibrary>) -> anyhow::Result<Self> {
        Ok(Self { log: Log::open(path)?, catalog: Arc::clone(catalog), meshes: Arc::clone(meshes) })
    }

    /// What a recording of it is called.
    pub fn name(&self) -> String {
        format!("{} ({})", self.log.session.session, self.log.session.mission_file)
    }

    /// The layout that shows it.
    pub fn contents<'a>(&self, side: Side, seen: &'a Seen) -> anyhow::Result<Contents<'a>> {
        let replayer = Replayer::new(&self.log, Arc::clone(&self.catalog))?;
        let planes: &[Plane] = if seen.rate > 0.0 { &seen.planes.0 } else { &[] };
        Ok(Contents { side, bounds_m: replayer.plan().layout.bounds_m(), camera: CAMERA, planes })
    }

    /// Shows all of it in `stream`; gives how many ticks that were.
    pub fn show(&self, stream: &RecordingStream, side: Side, seen: &Seen) -> anyhow::Result<u64> {
        let replayer = Replayer::new(&self.log, Arc::clone(&self.catalog))?;
        let plan = replayer.plan().clone();
        let (recording, meshes) = (Recording::new(stream.clone(), side), Arc::clone(&self.meshes));
        let eyes = Eyes::new(&plan, &self.meshes, seen)?;
        let showing = Showing::new(recording, plan, meshes, &about(&self.log.session))?;
        Show { log: &self.log, replayer, showing, eyes, events: 0, dialog: 0, answers: 0 }.run()
    }
}

/// Who played a session, and how.
fn about(session: &SessionEntry) -> Vec<(String, String)> {
    let participant = session.participant.iter().map(|label| ("participant".to_owned(), label.clone()));
    let program = [("program".to_owned(), session.program.clone())];
    let settings = session.settings.iter().map(|(name, value)| (name.clone(), value.clone()));
    program.into_iter().chain(participant).chain(settings).collect()
}

/// A replay under way.
struct Show<'a> {
    log: &'a Log,
    replayer: Replayer<'a>,
    showing: Showing,
    eyes: Option<Eyes>,
    /// Events, dialog messages and answers to questionnaires that were told.
    events: usize,
    dialog: usize,
    answers: usize,
}

impl Show<'_> {
    fn run(mut self) -> anyhow::Result<u64> {
        let [first, _] = self.replayer.span();
        self.showing.at(When { tick: first, wall_nanos: self.log.ticks.first().map_or(0, |tick| tick.wall_nanos) });
        self.showing.state(self.replayer.state())?;
        self.log.problems().iter().try_for_each(|problem| self.showing.problem(problem))?;
        let mut ticks = 0;
        loop {
            ticks += self.stretch()?;
            let Some(gap) = self.replayer.gap() else {
                // After the last tick nothing happens any more, but questionnaires may be answered.
                self.answers(u64::MAX)?;
                return Ok(ticks);
            };
            anyhow::ensure!(self.replayer.skip_gap(), "{gap}, and no snapshot to go on from");
        }
    }

    /// Goes on to the end, or to a gap; gives how many ticks that were.
    fn stretch(&mut self) -> anyhow::Result<u64> {
        let mut ticks = 0;
        while let Some(replayed) = self.replayer.step() {
            if let Some(difference) = &replayed.difference {
                anyhow::bail!("{difference}: what follows would not be what was seen");
            }
            ticks += 1;
            self.tick(replayed.entry)?;
        }
        Ok(ticks)
    }

    fn tick(&mut self, entry: &TickEntry) -> anyhow::Result<()> {
        self.showing.at(When { tick: entry.tick, wall_nanos: entry.wall_nanos });
        let log = self.log;
        let events = due(&log.events, &mut self.events, |event| event.tick <= entry.tick);
        let dialog = due(&log.dialog, &mut self.dialog, |said| said.tick <= entry.tick);
        if !events.is_empty() || !entry.inputs.is_empty() || entry.tick.is_multiple_of(SCENE_EVERY_TICKS) {
            self.showing.state(self.replayer.state())?;
        }
        entry.inputs.iter().try_for_each(|input| self.showing.input(input))?;
        events.iter().try_for_each(|event| self.showing.event(event))?;
        dialog.iter().try_for_each(|said| self.showing.dialog(said))?;
        self.answers(entry.tick)?;
        match &mut self.eyes {
            Some(eyes) if entry.tick.is_multiple_of(eyes.every_ticks) => eyes.look(&self.replayer, &mut self.showing),
            _ => Ok(()),
        }
    }

    /// Tells what was answered until a tick.
    fn answers(&mut self, tick: u64) -> anyhow::Result<()> {
        let answers = due(&self.log.answers, &mut self.answers, |answer| answer.tick <= tick);
        answers.iter().try_for_each(|answer| self.showing.answer(answer))
    }
}

/// Those of `entries` behind the first `told` that are due, which count as told from now on.
fn due<'a, E>(entries: &'a [E], told: &mut usize, is_due: impl Fn(&E) -> bool) -> &'a [E] {
    let left = &entries[*told..];
    let count = left.iter().take_while(|entry| is_due(entry)).count();
    *told += count;
    &left[..count]
}

/// The robot's camera, which looks again at what it saw.
struct Eyes {
    stills: Stills,
    frames: Box<dyn Subscriber>,
    every_ticks: u64,
}

impl Eyes {
    fn new(plan: &cohabit_engine::SessionPlan, meshes: &Arc<MeshLibrary>, seen: &Seen) -> anyhow::Result<Option<Self>> {
        if seen.rate <= 0.0 || seen.planes.0.is_empty() {
            return Ok(None);
        }
        let camera = CameraPlan::of_bodies(1).find(|camera| camera.id == CAMERA).context("a body has no eyes")?;
        let cameras = [CameraPlan { planes: seen.planes.0.clone(), ..camera }];
        let (bus, renderer) = (Local::new(1), Box::new(CpuRenderer::new(1)));
        let frames = bus.subscriber(Topic::Frames(CAMERA))?;
        let stills = Stills::new(plan, Arc::clone(meshes), renderer, &cameras, &bus)?;
        let every_ticks = ((TICKS_PER_S / seen.rate).round() as u64).max(1);
        Ok(Some(Self { stills, frames, every_ticks }))
    }

    fn look(&mut self, replayer: &Replayer<'_>, showing: &mut Showing) -> anyhow::Result<()> {
        self.stills.shoot_all(replayer.visible(), &[CAMERA])?;
        while let Some(sample) = self.frames.receive()? {
            showing.frame(CAMERA, &FrameView::new(sample.payload())?)?;
        }
        Ok(())
    }
}

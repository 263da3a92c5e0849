//! What a self-test tries: a mission, the replay of its log, a frame, and its way through shared memory.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    process, slice,
    sync::Arc,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail, ensure};
use cohabit_bus::{
    CameraId, Local, Session, Shm, Topic, Transport as _,
    message::{FrameView, Plane, Thing},
};
use cohabit_cdf::{Catalog, mission};
use cohabit_dialog::Effort;
use cohabit_engine::{Appearance, CameraPlan, Mount, SessionPlan, Stills, Visible, replay};
use cohabit_eval::{Line, Played, Settings, Task};
use cohabit_record::Log;
use cohabit_render::{CpuRenderer, MeshLibrary};
use cohabit_world::World;

use crate::{doctor, scratch::Scratch};

/// The built-in mission that is played, and what is said in it.
const MISSION: &str = "cold_soda";
const SCRIPT: &str = include_str!("../../../../cdf/missions/cold_soda.script");
const SEED: u64 = 1;
/// The camera whose frame is rendered: what the robot's mind sees.
const CAMERA: CameraId = CameraId::Egocentric(0);
/// As many threads as `play` renders with.
const RENDER_THREADS: usize = 2;

/// A trial that went well.
pub struct Passed<T> {
    /// What it shows, in a few words.
    pub found: String,
    /// What it leaves to other trials.
    pub left: T,
}

/// A session log, and the folder that it is in.
pub struct Recorded {
    log: PathBuf,
    _folder: Scratch,
}

/// Plays a mission in lock-step, by the robot that does what is said, and records it.
pub fn play_mission(catalog: &Arc<Catalog>) -> anyhow::Result<Passed<Recorded>> {
    let folder = Scratch::new("self-test")?;
    let script = SCRIPT.lines().map(Line::utterance).collect();
    let task = Task { id: MISSION.to_owned(), family: None, cdf: text()?.to_owned(), preparation: Vec::new(), script };
    let settings = Settings { seed: SEED, record: Some(folder.path().to_owned()), ..Settings::default() };
    let language = cohabit_dialog::language(Arc::clone(catalog), Effort::Full);
    let played = cohabit_eval::play(&task, &settings, &language)?;
    ensure!(played.success, "`{MISSION}` was not solved: {}", why(&played));
    let found = format!(
        "`{MISSION}` solved by what is said: {} actions, {:.0} s simulated in {:.1} s",
        played.actions,
        played.ticks as f64 * replay::TICK_S,
        played.wall_s
    );
    let log = played.log.context("the session was not recorded")?;
    Ok(Passed { found, left: Recorded { log, _folder: folder } })
}

fn text() -> anyhow::Result<&'static str> {
    let found = mission::builtin().iter().find(|(file, _)| file.trim_end_matches(".json") == MISSION);
    found.map(|(_, text)| *text).with_context(|| format!("there is no built-in mission `{MISSION}`"))
}

/// Why a mission was not solved: the first line that was not done, an early end, or the goals that stayed open.
fn why(played: &Played) -> String {
    let trouble = played.first_trouble.as_ref().map(|trouble| format!("\"{}\": {}", trouble.line, trouble.why));
    trouble.or_else(|| played.ended_early.clone()).unwrap_or_else(|| played.open_goals.join("; "))
}

/// Replays the log, and compares the digests of all its ticks.
pub fn replay_log(recorded: &Recorded, catalog: &Arc<Catalog>) -> anyhow::Result<Passed<()>> {
    let log = Log::open(&recorded.log)?;
    let began = Instant::now();
    let replayed = replay::replay(&log, Arc::clone(catalog))?;
    if let Some(difference) = &replayed.difference {
        bail!("{difference}");
    }
    ensure!(replayed.ticks > 0 && replayed.ticks == log.ticks.len() as u64, "{} of its ticks replayed", replayed.ticks);
    let seconds = began.elapsed().as_secs_f64();
    Ok(Passed { found: format!("none of {} digests differs, in {seconds:.1} s", replayed.ticks), left: () })
}

/// Renders what the robot sees at first, in all planes, on the CPU; gives the frame as it is sent.
pub fn render_frame(catalog: &Arc<Catalog>) -> anyhow::Result<Passed<Vec<u8>>> {
    let plan = SessionPlan::new(MISSION, text()?, Arc::clone(catalog), SEED)?;
    let world = plan.build()?;
    let camera = CameraPlan::usual(CAMERA, Mount::Head { body: 0 });
    let bus = Local::new(1);
    let mut frames = bus.subscriber(Topic::Frames(CAMERA))?;
    let meshes = Arc::new(MeshLibrary::build(catalog).context("build the models")?);
    let renderer = Box::new(CpuRenderer::new(RENDER_THREADS));
    let mut stills = Stills::new(&plan, meshes, renderer, slice::from_ref(&camera), &bus)?;
    let appearance = Appearance::default();
    let began = Instant::now();
    stills.shoot(Visible { world: &world, appearance: &appearance }, CAMERA, None)?;
    let taken_ms = began.elapsed().as_secs_f64() * 1e3;
    let sample = frames.receive()?.context("the camera sent no frame")?;
    let frame = FrameView::new(sample.payload())?;
    let things = things_seen(&frame, &world)?;
    let [width, height] = [frame.header.width, frame.header.height];
    let planes = Plane::ALL.map(Plane::name).join(", ");
    let found = format!("{width}x{height}, {planes}, {things} things seen, the first in {taken_ms:.0} ms, on the CPU");
    Ok(Passed { found, left: sample.payload().to_vec() })
}

/// How many things a frame shows. Each has to be in the world, somewhere ahead, and as large as the frame's table says.
fn things_seen(frame: &FrameView<'_>, world: &World) -> anyhow::Result<usize> {
    for plane in Plane::ALL {
        ensure!(frame.plane(plane).is_some(), "the frame has no {}", plane.name());
    }
    let ids = frame.ids().unwrap_or_default();
    let depths_m = frame.depth_m().unwrap_or_default();
    let mut pixels: BTreeMap<u32, u32> = BTreeMap::new();
    for (id, depth_m) in ids.iter().zip(depths_m).filter(|(id, _)| **id != 0) {
        ensure!(depth_m.is_finite() && *depth_m > 0.0, "thing {id} is {depth_m} m away");
        *pixels.entry(*id).or_default() += 1;
    }
    ensure!(!pixels.is_empty(), "the frame shows nothing");
    if let Some(id) = pixels.keys().find(|id| !is_in(world, **id)) {
        bail!("the frame shows {:?}, which is not in the world", Thing::of_id(*id));
    }
    let told: BTreeMap<u32, u32> = frame.seen().iter().map(|seen| (seen.id, seen.pixels)).collect();
    ensure!(told == pixels, "the frame's table of things is not that of its ids");
    Ok(pixels.len())
}

/// Whether an id of the id plane is of something in the world.
fn is_in(world: &World, id: u32) -> bool {
    match Thing::of_id(id) {
        Thing::Object(object) => world.exists(object),
        Thing::Body(body) => world.body(body).is_some(),
        Thing::Surface(room) => {
            let room = world.catalog().room_at(room);
            room.is_some_and(|room| world.layout().room(room).is_some())
        }
        Thing::Nothing => false,
    }
}

/// Opens a session of its own, and sends the frame to a subscriber through its shared memory.
pub fn send_frame(frame: &[u8]) -> anyhow::Result<Passed<()>> {
    doctor::ensure_room()?;
    let session = Session::new(&format!("self-test-{}", process::id()))?;
    let lock = session.supervise()?;
    let sent = send_through(&session, frame);
    session.end(lock);
    let taken_us = sent?.as_secs_f64() * 1e6;
    Ok(Passed { found: format!("{} bytes through shared memory in {taken_us:.0} µs", frame.len()), left: () })
}

/// Sends the frame to a subscriber of the session; gives how long that took, copy and all.
fn send_through(session: &Session, frame: &[u8]) -> anyhow::Result<Duration> {
    let bus = Shm::join(session)?;
    let mut reader = bus.subscriber(Topic::Frames(CAMERA))?;
    let mut writer = bus.publisher(Topic::Frames(CAMERA))?;
    let began = Instant::now();
    writer.send(0, frame.len(), &mut |bytes| bytes.copy_from_slice(frame))?;
    let sample = reader.receive()?.context("the subscriber received nothing")?;
    let taken = began.elapsed();
    ensure!(sample.payload() == frame, "the subscriber received something else");
    Ok(taken)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_cdf::BodyId;
    use cohabit_engine::{body_instance_id, object_instance_id};

    use super::*;

    #[test]
    fn ids_of_things_that_are_not_there_are_found() {
        let catalog = Arc::new(Catalog::builtin());
        let world = SessionPlan::new(MISSION, text().unwrap(), catalog, SEED).unwrap().build().unwrap();
        let there = [object_instance_id(world.objects().next().unwrap().id), body_instance_id(BodyId(0))];
        let absent = [0, Thing::FIRST_BODY - 1, Thing::FIRST_BODY + 1, u32::MAX];
        assert!(there.iter().all(|id| is_in(&world, *id)), "{there:?}");
        assert!(!absent.iter().any(|id| is_in(&world, *id)), "{absent:?}");
    }

    #[test]
    fn what_went_wrong_is_told_by_its_first_cause() {
        let open = Played { open_goals: vec!["1: a".to_owned()], ..Played::default() };
        assert_eq!(why(&open), "1: a");
        let early = Played { ended_early: Some("a line took too long".to_owned()), ..open };
        assert_eq!(why(&early), "a line took too long");
    }
}

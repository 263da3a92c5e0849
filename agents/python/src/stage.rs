//! A world in this process that goes on only when it is told to: what environments are made of.

use std::sync::{Arc, Mutex, PoisonError};

use cohabit_bus::{
    CameraId, Local, Publisher, Subscriber, Topic, Transport,
    message::{self, CommandMessage, EventKind, EventMessage},
};
use cohabit_cdf::{Action, BodyRequest, ObjectId};
use cohabit_engine::{CameraPlan, Engine, SessionPlan, Stills, report};
use cohabit_render::CpuRenderer;
use cohabit_world::{DT_NANOS, Ending, World};
use pyo3::prelude::*;

use crate::{
    action::PyAction,
    choice::Choice,
    error::{bad_argument, failed},
    frame::Frame,
    library,
    mission_file::MissionFile,
    outcome::Outcome,
    senses::{Filling, Sensed, Senses, Surroundings},
    state::State,
};

/// The longest that one command may take: four simulated minutes are twice the way through all rooms.
const PATIENCE_TICKS: u64 = 60 * 240;
/// How long it is that a body which waits lets pass: a simulated second.
const WAIT_TICKS: u64 = 60;

/// A world that is stepped, its cameras, and what its bodies were shown last.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Stage {
    theatre: Mutex<Theatre>,
}

struct Theatre {
    plan: SessionPlan,
    bus: Local,
    /// Only absent while it is replaced.
    engine: Option<Engine>,
    cameras: Vec<CameraPlan>,
    stills: Option<Stills>,
    commands: Box<dyn Publisher>,
    events: Box<dyn Subscriber>,
    /// The world at its first tick.
    first: Vec<u8>,
    commanded: u64,
    /// Commands without an outcome yet.
    pending: Vec<Pending>,
    /// The objects in each body's slots.
    slots: Vec<Vec<ObjectId>>,
}

/// A command without an outcome yet.
struct Pending {
    command: u64,
    body: u32,
    /// Why there is no object of the name that was given.
    unknown: Option<String>,
}

/// Something that a body is to do.
struct Request {
    body: u32,
    action: Action,
    /// Why there is no object of the name that was given.
    unknown: Option<String>,
}

/// Tick, score, ending, and goals by their numbers, with whether they are met.
type Progress = (u64, u32, &'static str, Vec<(i64, bool)>);

fn read_all<T: std::str::FromStr<Err: std::fmt::Display>>(texts: &[String]) -> PyResult<Vec<T>> {
    texts.iter().map(|text| text.parse().map_err(bad_argument)).collect()
}

impl Theatre {
    fn new(plan: SessionPlan, threads: usize) -> PyResult<Self> {
        let world = plan.build().map_err(bad_argument)?;
        let bus = Local::new(1);
        let cameras = plan.cameras.clone();
        let stills = if cameras.is_empty() {
            None
        } else {
            let meshes = library::meshes().map_err(failed)?;
            let renderer = Box::new(CpuRenderer::new(threads));
            Some(Stills::new(&plan, meshes, renderer, &cameras, &bus).map_err(failed)?)
        };
        let commands = bus.publisher(Topic::Commands).map_err(failed)?;
        let events = bus.subscriber(Topic::Events).map_err(failed)?;
        let slots = vec![Vec::new(); world.bodies().len()];
        let first = world.snapshot();
        let engine = Some(Engine::new(&plan, world, &cameras, &bus).map_err(failed)?.without_recorder());
        let mut theatre = Self {
            plan,
            bus,
            engine,
            cameras,
            stills,
            commands,
            events,
            first,
            commanded: 0,
            pending: Vec::new(),
            slots,
        };
        theatre.claim_all()?;
        Ok(theatre)
    }

    fn engine(&self) -> &Engine {
        self.engine.as_ref().expect("invariant: replaced, never taken away")
    }

    fn world(&self) -> &World {
        self.engine().world()
    }

    /// Begins anew; with another world, if the mission leaves something to chance.
    fn reset(&mut self, seed: u64) -> PyResult<()> {
        let seed = self.plan.mission.seed.unwrap_or(seed);
        let world = if seed == self.plan.seed {
            let mut world = self.engine.take().expect("invariant: replaced, never taken away").into_world();
            world.restore(&self.first).map_err(failed)?;
            world
        } else {
            let plan = SessionPlan { seed, ..self.plan.clone() };
            let world = plan.build().map_err(failed)?;
            (self.plan, self.first) = (plan, world.snapshot());
            world
        };
        self.engine = None;
        self.engine =
            Some(Engine::new(&self.plan, world, &self.cameras, &self.bus).map_err(failed)?.without_recorder());
        // What the world before still had to tell.
        while self.events.receive().map_err(failed)?.is_some() {}
        self.pending.clear();
        self.commanded = 0;
        self.slots.iter_mut().for_each(Vec::clear);
        self.claim_all()
    }

    fn command(&mut self, request: Request) -> PyResult<()> {
        self.commanded += 1;
        let (command, Request { body, action, unknown }) = (self.commanded, request);
        self.send(&CommandMessage::act(command, 0, body, action))?;
        self.pending.push(Pending { command, body, unknown });
        Ok(())
    }

    /// Makes this the commander of all bodies.
    fn claim_all(&mut self) -> PyResult<()> {
        let bodies = u32::try_from(self.slots.len()).unwrap_or(u32::MAX);
        (0..bodies).try_for_each(|body| self.send(&CommandMessage::claim(0, body, "environment", true)))
    }

    fn send(&mut self, message: &CommandMessage) -> PyResult<()> {
        let tick = self.world().tick();
        self.commands.send_record(tick, message).map(drop).map_err(failed)
    }

    fn tick(&mut self, ends: &mut Vec<Outcome>) -> PyResult<()> {
        let engine = self.engine.as_mut().expect("invariant: replaced, never taken away");
        // A stamp and never a key: simulated time, so that nothing here depends on when it runs.
        engine.tick(engine.world().tick() * DT_NANOS).map_err(failed)?;
        while let Some(sample) = self.events.receive().map_err(failed)? {
            let event: EventMessage = message::read(sample.payload()).map_err(failed)?;
            let (Some(EventKind::Outcome), Some(status)) = (event.kind(), event.status()) else { continue };
            let Some(place) = self.pending.iter().position(|one| one.command == event.command) else { continue };
            let Pending { command, body, unknown } = self.pending.swap_remove(place);
            ends.push(Outcome::new(command, body, status, event.text.as_str()).or_unknown(unknown.as_deref()));
        }
        Ok(())
    }

    /// Has bodies do something, each one thing, until all have ended, or for so many ticks.
    fn carry_out(&mut self, requests: Vec<Request>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        let waits = requests.is_empty() && self.pending.is_empty();
        requests.into_iter().try_for_each(|request| self.command(request))?;
        let mut ends = Vec::new();
        let most = ticks.unwrap_or(if waits { WAIT_TICKS } else { PATIENCE_TICKS });
        for _ in 0..most {
            self.tick(&mut ends)?;
            let done = ticks.is_none() && !waits && self.pending.is_empty();
            if done || self.world().finished().is_some() {
                break;
            }
        }
        if ticks.is_none() && !self.pending.is_empty() && self.world().finished().is_none() {
            self.give_up(&mut ends)?;
        }
        ends.sort_by_key(|end| end.command);
        Ok(ends)
    }

    /// Stops all that takes too long.
    fn give_up(&mut self, ends: &mut Vec<Outcome>) -> PyResult<()> {
        let bodies: Vec<u32> = self.pending.iter().map(|pending| pending.body).collect();
        for body in bodies {
            self.command(Request { body, action: Action::Stop, unknown: None })?;
            // Nobody asks what came of stopping.
            self.pending.pop();
        }
        self.tick(ends)
    }

    fn look(&mut self, names: &[CameraId]) -> PyResult<Vec<Frame>> {
        let (Some(stills), Some(engine)) = (&mut self.stills, &self.engine) else {
            return Err(bad_argument("there are no cameras here"));
        };
        stills.shoot_all(engine.visible(), names).map_err(failed)?;
        let frame = |camera: &CameraId| {
            // A new subscriber is handed the latest frame; one that stayed could only hold so many of them.
            let mut frames = self.bus.subscriber(Topic::Frames(*camera)).map_err(failed)?;
            let sample = frames.latest().map_err(failed)?;
            let sample = sample.ok_or_else(|| bad_argument(format!("there is no camera `{camera}` here")))?;
            Frame::new(sample).map_err(failed)
        };
        names.iter().map(frame).collect()
    }
}

impl Stage {
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Theatre) -> PyResult<T> + Send) -> PyResult<T> {
        py.detach(|| work(&mut self.theatre.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

#[pymethods]
impl Stage {
    /// A world. `mission` is a path or the name of a built-in mission, unless its `text` is given; `bodies` and `cameras`
    /// are written as on the command line.
    #[new]
    #[pyo3(signature = (mission=None, text=None, bodies=Vec::new(), cameras=Vec::new(), seed=0, threads=1))]
    fn new(
        py: Python<'_>,
        mission: Option<String>,
        text: Option<String>,
        bodies: Vec<String>,
        cameras: Vec<String>,
        seed: u64,
        threads: usize,
    ) -> PyResult<Self> {
        let file = match text {
            Some(text) => MissionFile { name: mission.unwrap_or_else(|| "mission".to_owned()), text },
            None => MissionFile::find(mission.as_deref()).map_err(bad_argument)?,
        };
        let bodies = read_all::<BodyRequest>(&bodies)?;
        let cameras = read_all::<CameraPlan>(&cameras)?;
        py.detach(|| {
            let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(library::catalog()), seed);
            let plan = plan.map_err(bad_argument)?.with_bodies(bodies).with_cameras(cameras).map_err(bad_argument)?;
            Ok(Self { theatre: Mutex::new(Theatre::new(plan, threads)?) })
        })
    }

    /// Begins anew, with that seed where the mission leaves something to chance.
    fn reset(&self, py: Python<'_>, seed: u64) -> PyResult<()> {
        self.with(py, |theatre| theatre.reset(seed))
    }

    /// Has bodies carry out actions, `(body, action)` each, until all have ended, or for `ticks` ticks.
    #[pyo3(signature = (actions, ticks=None))]
    fn act(&self, py: Python<'_>, actions: Vec<(u32, Py<PyAction>)>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        let request = |(body, action): &(u32, Py<PyAction>)| {
            let PyAction { action, unknown } = action.get();
            Request { body: *body, action: *action, unknown: unknown.clone() }
        };
        let requests = actions.iter().map(request).collect();
        self.with(py, |theatre| theatre.carry_out(requests, ticks))
    }

    /// The same with choices, `(body, choice, slot)` each; what is in the slots is what `sense` said last.
    #[pyo3(signature = (choices, ticks=None))]
    fn choose(&self, py: Python<'_>, choices: Vec<(u32, usize, usize)>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        self.with(py, |theatre| {
            let mut requests = Vec::new();
            for (body, choice, slot) in choices {
                let chosen = Choice::numbered(choice)?;
                // An empty slot is for the world to refuse.
                let nothing = ObjectId(u32::MAX);
                let object = theatre.slots.get(body as usize).and_then(|slots| slots.get(slot)).copied();
                let action = chosen.action(object.unwrap_or(nothing));
                requests.extend(action.map(|action| Request { body, action, unknown: None }));
            }
            theatre.carry_out(requests, ticks)
        })
    }

    /// What these cameras see now.
    fn look(&self, py: Python<'_>, cameras: Vec<String>) -> PyResult<Vec<Frame>> {
        let cameras = read_all::<CameraId>(&cameras)?;
        self.with(py, |theatre| theatre.look(&cameras))
    }

    /// What bodies sense besides pictures, once their slots are filled anew: with what is `seen` in each one's frame, `near`,
    /// or `all`.
    fn sense(
        &self,
        py: Python<'_>,
        bodies: Vec<u32>,
        slots: usize,
        filling: &str,
        frames: Vec<Bound<'_, Frame>>,
    ) -> PyResult<Vec<Senses>> {
        let filling = Filling::named(filling)?;
        let frames: Vec<&Frame> = frames.iter().map(Bound::get).collect();
        let sensed = self.with(py, |theatre| {
            let parts = report::state(theatre.world());
            let around = Surroundings { bodies: &parts.bodies, objects: &parts.objects };
            let mut all = Vec::new();
            for (place, body) in bodies.into_iter().enumerate() {
                let sensed = Sensed::of(around, body, slots, filling, frames.get(place).copied());
                let sensed = sensed.ok_or_else(|| bad_argument(format!("there is no body {body} here")))?;
                theatre.slots[body as usize] = sensed.objects();
                all.push(sensed);
            }
            Ok(all)
        })?;
        sensed.into_iter().map(|sensed| sensed.into_python(py)).collect()
    }

    /// `(tick, score, ending, goals)`: the ending is `running`, `complete` or `failed`, and a goal `(number, met)`.
    fn progress(&self, py: Python<'_>) -> PyResult<Progress> {
        self.with(py, |theatre| {
            let world = theatre.world();
            let ending = match world.finished() {
                None => "running",
                Some(Ending::AllGoalsMet) => "complete",
                Some(Ending::KilledByHazard) => "failed",
            };
            let goals = world.goals().iter().map(|goal| (goal.id, goal.met)).collect();
            Ok((world.tick(), world.score(), ending, goals))
        })
    }

    /// The state of the world.
    fn state(&self, py: Python<'_>) -> PyResult<State> {
        self.with(py, |theatre| Ok(State::of(&report::state(theatre.world()), theatre.world().tick())))
    }

    /// What the whole simulated state comes down to: equal digests are equal worlds.
    fn digest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyBytes>> {
        let digest = self.with(py, |theatre| Ok(theatre.world().digest()))?;
        Ok(pyo3::types::PyBytes::new(py, &digest))
    }

    /// The kinds of all bodies, by their numbers.
    fn kinds(&self, py: Python<'_>) -> PyResult<Vec<&'static str>> {
        self.with(py, |theatre| Ok(theatre.world().bodies().map(|body| body.kind.name()).collect()))
    }

    /// The mission's name and its seed.
    fn mission(&self, py: Python<'_>) -> PyResult<(String, u64)> {
        self.with(py, |theatre| Ok((theatre.plan.file.clone(), theatre.plan.seed)))
    }
}

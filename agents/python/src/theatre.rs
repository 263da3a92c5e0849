//! A mission played in this process: its world, its cameras, and who commands its bodies.

use std::sync::Arc;

use cohabit_bus::{
    CameraId, Local, Publisher, Subscriber, Topic, Transport,
    message::{self, CommandMessage, EventKind, EventMessage},
};
use cohabit_cdf::{Action, BodyRequest, Mission, ObjectId};
use cohabit_engine::{CameraPlan, Engine, SessionPlan, Stills};
use cohabit_render::CpuRenderer;
use cohabit_world::{DT_NANOS, Ending, World};
use pyo3::prelude::*;

use crate::{
    choice::Choice,
    error::{bad_argument, failed},
    frame::Frame,
    library,
    mission_file::MissionFile,
    outcome::Outcome,
    senses::{Filling, Sensed},
};

/// The longest that one command may take: four simulated minutes are twice the way through all rooms.
const PATIENCE_TICKS: u64 = 60 * 240;
/// How long it is that a body which waits lets pass: a simulated second.
const WAIT_TICKS: u64 = 60;

/// What is played, and by whom.
#[derive(Clone, Debug, Default)]
pub struct Cast {
    /// Bodies beside those of the mission.
    pub bodies: Vec<BodyRequest>,
    /// The cameras.
    pub cameras: Vec<CameraPlan>,
    /// Whether a mission's own seed gives way to that of each beginning.
    pub randomize: bool,
}

impl Cast {
    /// The plan of a mission; `seed` is taken where it leaves something to chance.
    ///
    /// # Errors
    /// A `ValueError` that says what is wrong with the mission.
    fn plan(&self, file: &MissionFile, seed: u64) -> PyResult<SessionPlan> {
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(library::catalog()), seed);
        let plan = plan.map_err(bad_argument)?.with_bodies(self.bodies.clone());
        let plan = plan.with_cameras(self.cameras.clone()).map_err(bad_argument)?;
        if !self.randomize || plan.mission.seed.is_none() {
            return Ok(plan);
        }
        let mission = Arc::new(Mission { seed: None, ..(*plan.mission).clone() });
        Ok(SessionPlan { mission, seed, ..plan })
    }
}

/// A world that is stepped, its cameras, and what its bodies were shown last.
pub struct Theatre {
    plan: SessionPlan,
    bus: Local,
    /// Only absent while it is replaced.
    engine: Option<Engine>,
    cast: Cast,
    stills: Option<Stills>,
    /// Threads that draw.
    threads: usize,
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
pub struct Pending {
    pub command: u64,
    pub body: u32,
    /// Why there is no object of the name that was given.
    pub unknown: Option<String>,
}

/// Something that a body is to do.
pub struct Request {
    pub body: u32,
    pub action: Action,
    /// Why there is no object of the name that was given.
    pub unknown: Option<String>,
}

/// A moment of a theatre, as plain data.
#[derive(Clone, Debug)]
pub struct Moment {
    /// The world, and what is seen of it besides.
    pub state: Vec<u8>,
    /// Commands that were given.
    pub commanded: u64,
    /// Those without an outcome yet: command, body, and why there is no object of the name that was given.
    pub pending: Vec<(u64, u32, Option<String>)>,
    /// The objects in each body's slots.
    pub slots: Vec<Vec<u32>>,
}

/// How a mission ended.
pub const fn ending_name(ending: Option<Ending>) -> &'static str {
    match ending {
        None => "running",
        Some(Ending::AllGoalsMet) => "complete",
        Some(Ending::KilledByHazard) => "failed",
    }
}

/// The cameras of a plan, if there are any.
fn stills(plan: &SessionPlan, cameras: &[CameraPlan], threads: usize, bus: &Local) -> PyResult<Option<Stills>> {
    if cameras.is_empty() {
        return Ok(None);
    }
    let meshes = library::meshes().map_err(failed)?;
    let renderer = Box::new(CpuRenderer::new(threads));
    Stills::new(plan, meshes, renderer, cameras, bus).map(Some).map_err(failed)
}

impl Theatre {
    /// A mission at its first tick, with so many threads that draw.
    ///
    /// # Errors
    /// A `ValueError` if it cannot be played.
    pub fn new(file: &MissionFile, cast: Cast, seed: u64, threads: usize) -> PyResult<Self> {
        let plan = cast.plan(file, seed)?;
        let world = plan.build().map_err(bad_argument)?;
        let bus = Local::new(1);
        let stills = stills(&plan, &cast.cameras, threads, &bus)?;
        let commands = bus.publisher(Topic::Commands).map_err(failed)?;
        let events = bus.subscriber(Topic::Events).map_err(failed)?;
        let slots = vec![Vec::new(); world.bodies().len()];
        let first = world.snapshot();
        let engine = Some(Engine::new(&plan, world, &cast.cameras, &bus).map_err(failed)?.without_recorder());
        let mut theatre = Self {
            plan,
            bus,
            engine,
            cast,
            stills,
            threads,
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

    /// What is played.
    pub const fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    fn engine(&self) -> &Engine {
        self.engine.as_ref().expect("invariant: replaced, never taken away")
    }

    /// The world as it is.
    pub fn world(&self) -> &World {
        self.engine().world()
    }

    /// Begins anew: with another mission, if one is given, and with another world, if the mission leaves something to chance.
    ///
    /// # Errors
    /// A `ValueError` if the mission cannot be played; all is then as it was.
    pub fn reset(&mut self, seed: u64, file: Option<&MissionFile>) -> PyResult<()> {
        let file = file.filter(|file| file.name != self.plan.file || file.text != self.plan.text);
        let plan = match file {
            Some(file) => self.cast.plan(file, seed)?,
            None => SessionPlan { seed: self.plan.mission.seed.unwrap_or(seed), ..self.plan.clone() },
        };
        let world = if file.is_none() && plan.seed == self.plan.seed {
            let mut world = self.engine.take().expect("invariant: replaced, never taken away").into_world();
            world.restore(&self.first).map_err(failed)?;
            world
        } else {
            let world = plan.build().map_err(bad_argument)?;
            if plan.mission.layout != self.plan.mission.layout {
                self.stills = None;
                self.stills = stills(&plan, &self.cast.cameras, self.threads, &self.bus)?;
            }
            (self.plan, self.first) = (plan, world.snapshot());
            world
        };
        self.engine = None;
        self.connect(world)?;
        self.pending.clear();
        self.commanded = 0;
        let bodies = self.world().bodies().len();
        self.slots = vec![Vec::new(); bodies];
        self.claim_all()
    }

    /// Has the engine go on with `world`.
    fn connect(&mut self, world: World) -> PyResult<()> {
        let engine = Engine::new(&self.plan, world, &self.cast.cameras, &self.bus).map_err(failed)?;
        self.engine = Some(engine.without_recorder());
        // What the world before still had to tell.
        while self.events.receive().map_err(failed)?.is_some() {}
        Ok(())
    }

    /// All that is needed to go on from here: see [`Self::load`].
    pub fn save(&self) -> Moment {
        let pending = self.pending.iter().map(|one| (one.command, one.body, one.unknown.clone())).collect();
        let slots = self.slots.iter().map(|slots| slots.iter().map(|object| object.0).collect()).collect();
        Moment { state: self.engine().snapshot(), commanded: self.commanded, pending, slots }
    }

    /// Goes on from where a theatre of the same mission was.
    ///
    /// # Errors
    /// A `ValueError` if it was one of another mission, or of another version.
    pub fn load(&mut self, moment: Moment) -> PyResult<()> {
        let Moment { state, commanded, pending, slots } = moment;
        let engine = self.engine.as_mut().expect("invariant: replaced, never taken away");
        engine.restore(&state).map_err(bad_argument)?;
        self.commanded = commanded;
        let pending = pending.into_iter().map(|(command, body, unknown)| Pending { command, body, unknown });
        self.pending = pending.collect();
        self.slots.iter_mut().for_each(Vec::clear);
        for (own, slots) in self.slots.iter_mut().zip(slots) {
            own.extend(slots.into_iter().map(ObjectId));
        }
        Ok(())
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
    ///
    /// # Errors
    /// When the bus fails.
    pub fn carry_out(&mut self, requests: Vec<Request>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
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

    /// Has bodies do what they chose, `(body, choice, slot)` each; what is in the slots is what was sensed last.
    ///
    /// # Errors
    /// A `ValueError` if there is no such choice.
    pub fn choose(&mut self, choices: &[(u32, usize, usize)], ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        let mut requests = Vec::new();
        for (body, choice, slot) in choices {
            let chosen = Choice::numbered(*choice)?;
            // An empty slot is for the world to refuse.
            let nothing = ObjectId(u32::MAX);
            let object = self.slots.get(*body as usize).and_then(|slots| slots.get(*slot)).copied();
            let action = chosen.action(object.unwrap_or(nothing));
            requests.extend(action.map(|action| Request { body: *body, action, unknown: None }));
        }
        self.carry_out(requests, ticks)
    }

    /// What a body senses besides pictures, once its slots are filled anew.
    ///
    /// # Errors
    /// A `ValueError` if there is no such body.
    pub fn sense(&mut self, body: u32, slots: usize, filling: Filling, frame: Option<&Frame>) -> PyResult<Sensed> {
        let sensed = Sensed::of(self.world(), body, slots, filling, frame);
        let sensed = sensed.ok_or_else(|| bad_argument(format!("there is no body {body} here")))?;
        self.slots[body as usize] = sensed.objects();
        Ok(sensed)
    }

    /// What these cameras see now.
    ///
    /// # Errors
    /// A `ValueError` if there is no such camera.
    pub fn look(&mut self, names: &[CameraId]) -> PyResult<Vec<Frame>> {
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

//! A mission played in this process: its world, its cameras, and what its bodies are told.

use std::sync::Arc;

use cohabit_bus::{CameraId, Local, Topic, Transport};
use cohabit_cdf::{Action, BodyId, BodyRequest, Mission, ObjectId};
use cohabit_engine::{Appearance, CameraPlan, SessionPlan, Stills, Visible, report, snapshot};
use cohabit_render::CpuRenderer;
use cohabit_world::{Ending, Input, World};
use pyo3::prelude::*;

use crate::{
    around::Simulated,
    choice::Choice,
    error::{bad_argument, failed},
    frame::Frame,
    library::Library,
    mission_file::MissionFile,
    outcome::Outcome,
    senses::{Filling, Sensed},
    state::State,
};

/// The longest that one command may take: four simulated minutes are twice the way through all rooms.
const PATIENCE_TICKS: u64 = 60 * 240;
/// How long it is that a body which waits lets pass: a simulated second.
const WAIT_TICKS: u64 = 60;

/// What is played, and by whom.
#[derive(Clone)]
pub struct Cast {
    /// What there is to play with.
    pub library: Arc<Library>,
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
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(self.library.catalog()), seed);
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
///
/// What bodies are told goes to the world itself; only frames go over a bus, so that a view of one is a view of where it was
/// rendered.
pub struct Theatre {
    plan: SessionPlan,
    cast: Cast,
    world: World,
    /// What cameras see besides; nobody keeps it where there are none.
    appearance: Appearance,
    stills: Option<Stills>,
    renderer: CpuRenderer,
    frames: Local,
    /// The world at its first tick.
    first: Vec<u8>,
    commanded: u64,
    /// Commands of the next tick.
    inputs: Vec<Input>,
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
fn stills(plan: &SessionPlan, cast: &Cast, renderer: &CpuRenderer, frames: &Local) -> PyResult<Option<Stills>> {
    if cast.cameras.is_empty() {
        return Ok(None);
    }
    let meshes = cast.library.meshes().map_err(failed)?;
    Stills::new(plan, meshes, Box::new(renderer.clone()), &cast.cameras, frames).map(Some).map_err(failed)
}

impl Theatre {
    /// A mission at its first tick, whose cameras are drawn by a clone of `renderer`.
    ///
    /// # Errors
    /// A `ValueError` if it cannot be played.
    pub fn new(file: &MissionFile, cast: Cast, seed: u64, renderer: &CpuRenderer) -> PyResult<Self> {
        let plan = cast.plan(file, seed)?;
        let world = plan.build().map_err(bad_argument)?;
        let frames = Local::new(1);
        let stills = stills(&plan, &cast, renderer, &frames)?;
        let slots = vec![Vec::new(); world.bodies().len()];
        let first = world.snapshot();
        Ok(Self {
            plan,
            cast,
            world,
            appearance: Appearance::default(),
            stills,
            renderer: renderer.clone(),
            frames,
            first,
            commanded: 0,
            inputs: Vec::new(),
            pending: Vec::new(),
            slots,
        })
    }

    /// What is played.
    pub const fn plan(&self) -> &SessionPlan {
        &self.plan
    }

    /// The world as it is.
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// The state that its world would publish.
    pub fn state(&self) -> State {
        State::of(&report::state(&self.world), self.world.tick(), &self.cast.library)
    }

    /// All that can be seen now.
    const fn visible(&self) -> Visible<'_> {
        Visible { world: &self.world, appearance: &self.appearance }
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
        if file.is_none() && plan.seed == self.plan.seed {
            self.world.restore(&self.first).map_err(failed)?;
        } else {
            let world = plan.build().map_err(bad_argument)?;
            if plan.mission.layout != self.plan.mission.layout {
                self.stills = stills(&plan, &self.cast, &self.renderer, &self.frames)?;
            }
            (self.first, self.world, self.plan) = (world.snapshot(), world, plan);
        }
        self.appearance = Appearance::default();
        self.inputs.clear();
        self.pending.clear();
        self.commanded = 0;
        self.slots = vec![Vec::new(); self.world.bodies().len()];
        Ok(())
    }

    /// All that is needed to go on from here: see [`Self::load`].
    pub fn save(&self) -> Moment {
        let pending = self.pending.iter().map(|one| (one.command, one.body, one.unknown.clone())).collect();
        let slots = self.slots.iter().map(|slots| slots.iter().map(|object| object.0).collect()).collect();
        Moment { state: snapshot::write(self.visible()), commanded: self.commanded, pending, slots }
    }

    /// Goes on from where a theatre of the same mission was.
    ///
    /// # Errors
    /// A `ValueError` if it was one of another mission, or of another version.
    pub fn load(&mut self, moment: Moment) -> PyResult<()> {
        let Moment { state, commanded, pending, slots } = moment;
        self.appearance = snapshot::restore(&mut self.world, &state).map_err(bad_argument)?;
        self.commanded = commanded;
        let pending = pending.into_iter().map(|(command, body, unknown)| Pending { command, body, unknown });
        self.pending = pending.collect();
        self.slots.iter_mut().for_each(Vec::clear);
        for (own, slots) in self.slots.iter_mut().zip(slots) {
            own.extend(slots.into_iter().map(ObjectId));
        }
        Ok(())
    }

    /// Tells a body to do something in the next tick.
    fn command(&mut self, request: Request) {
        self.commanded += 1;
        let (command, Request { body, action, unknown }) = (self.commanded, request);
        self.inputs.push(Input { command, body: BodyId(body), action });
        self.pending.push(Pending { command, body, unknown });
    }

    fn tick(&mut self, ends: &mut Vec<Outcome>) {
        // Body by body, each body's commands in the order in which they were given: as in a session.
        self.inputs.sort_by_key(|input| input.body.0);
        let report = self.world.step(&self.inputs);
        if self.stills.is_some() {
            self.appearance.note(&self.world, &self.inputs, &report);
        }
        self.inputs.clear();
        for outcome in report.outcomes {
            let Some(place) = self.pending.iter().position(|one| one.command == outcome.command) else { continue };
            let Pending { command, body, unknown } = self.pending.swap_remove(place);
            let end = Outcome::new(command, body, outcome.status, &outcome.detail);
            ends.push(end.or_unknown(unknown.as_deref()));
        }
    }

    /// Has bodies do something, each one thing, until all have ended, or for so many ticks.
    pub fn carry_out(&mut self, requests: Vec<Request>, ticks: Option<u64>) -> Vec<Outcome> {
        let waits = requests.is_empty() && self.pending.is_empty();
        for request in requests {
            // It takes the place of what the body was doing: nobody asks any more what came of that.
            self.pending.retain(|one| one.body != request.body);
            self.command(request);
        }
        let mut ends = Vec::new();
        let most = ticks.unwrap_or(if waits { WAIT_TICKS } else { PATIENCE_TICKS });
        for _ in 0..most {
            self.tick(&mut ends);
            let done = ticks.is_none() && !waits && self.pending.is_empty();
            if done || self.world.finished().is_some() {
                break;
            }
        }
        if ticks.is_none() && !self.pending.is_empty() && self.world.finished().is_none() {
            self.give_up(&mut ends);
        }
        ends.sort_by_key(|end| end.command);
        ends
    }

    /// Stops all that takes too long.
    fn give_up(&mut self, ends: &mut Vec<Outcome>) {
        let bodies: Vec<u32> = self.pending.iter().map(|pending| pending.body).collect();
        for body in bodies {
            self.command(Request { body, action: Action::Stop, unknown: None });
            // Nobody asks what came of stopping.
            self.pending.pop();
        }
        self.tick(ends);
    }

    /// What a body is to do that chose that, done to what is in that slot: what was sensed last is in them. Nothing for waiting.
    pub fn chosen(&self, body: u32, choice: Choice, slot: usize) -> Option<Request> {
        let object = self.slots.get(body as usize).and_then(|slots| slots.get(slot)).copied();
        // An empty slot is for the world to refuse.
        let action = choice.action(object.unwrap_or(ObjectId(u32::MAX)))?;
        Some(Request { body, action, unknown: None })
    }

    /// What a body senses besides pictures, once its slots are filled anew.
    ///
    /// # Errors
    /// A `ValueError` if there is no such body.
    pub fn sense(&mut self, body: u32, slots: usize, filling: Filling, frame: Option<&Frame>) -> PyResult<Sensed> {
        let around = Simulated { world: &self.world, library: &self.cast.library };
        let sensed = Sensed::of(&around, body, slots, filling, frame);
        let sensed = sensed.ok_or_else(|| bad_argument(format!("there is no body {body} here")))?;
        self.slots[body as usize] = sensed.objects();
        Ok(sensed)
    }

    /// What these cameras see now.
    ///
    /// # Errors
    /// A `ValueError` if there is no such camera.
    pub fn look(&mut self, names: &[CameraId]) -> PyResult<Vec<Frame>> {
        let Some(stills) = &mut self.stills else { return Err(bad_argument("there are no cameras here")) };
        stills.shoot_all(Visible { world: &self.world, appearance: &self.appearance }, names).map_err(failed)?;
        let frame = |camera: &CameraId| {
            // A new subscriber is handed the latest frame; one that stayed could only hold so many of them.
            let mut frames = self.frames.subscriber(Topic::Frames(*camera)).map_err(failed)?;
            let sample = frames.latest().map_err(failed)?;
            let sample = sample.ok_or_else(|| bad_argument(format!("there is no camera `{camera}` here")))?;
            Frame::of(sample, &self.cast.library).map_err(failed)
        };
        names.iter().map(frame).collect()
    }
}

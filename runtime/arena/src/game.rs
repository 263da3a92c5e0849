//! One game: a world that goes on only while a batch of commands is carried out, and its log.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use cohabit_bus::{
    BusError, CameraId, Local, Publisher, Subscriber, Topic, Transport,
    message::{self, CommandMessage, EventKind, EventMessage, FrameView, Malformed, Plane, Thing},
    wall_nanos,
};
use cohabit_cdf::{Action, BodyId, GoToTarget, ObjectId, Status, Verb};
use cohabit_engine::{BuildError, CameraPlan, Engine, EngineError, Mount, SessionPlan, Stills};
use cohabit_record::{RecordError, Recorder, Recording, SessionFacts};
use cohabit_render::{Lens, MeshLibrary, Renderer};
use cohabit_world::{Vec3, World};
use serde_json::Value;

use crate::{
    command::{Command, Destination, Perspective, SIDE_PX},
    object::robot_id,
    pictures::{PictureError, Pictures},
    reply::{End, LastAction, Reply},
};

/// The robot that clients command.
const BODY: BodyId = BodyId(0);
/// The longest that one command may take: four simulated minutes are twice the way through all rooms.
const PATIENCE_TICKS: u64 = 60 * 240;
/// What goes by after each act of the hand: machines that are on for a moment have done their work by then, doors
/// stand as they should, and what was thrown lies still. Clients take for granted that time passes between batches.
const SETTLE_TICKS: u64 = 150;
/// The most commands of a batch.
const MOST_COMMANDS: usize = 1000;

/// A look around's camera; every session has the others.
const AROUND: &str = "look-around";

/// Why a game does not begin, or does not go on.
#[derive(Debug, thiserror::Error)]
pub enum GameError {
    /// Its mission cannot be played.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// It cannot be recorded.
    #[error("{path}: the game cannot be recorded: {source}")]
    Record {
        /// The log.
        path: PathBuf,
        /// Why.
        source: RecordError,
    },
    /// Its world failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The bus inside this process failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// There are no pictures.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// What passed on the bus was malformed.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// A camera delivered nothing.
    #[error("the camera `{0}` delivered no frame")]
    NoFrame(CameraId),
}

/// What came of a batch.
struct Batch {
    /// Of the last command that was carried out.
    end: End,
    /// That command.
    last_action: LastAction,
    /// The lens of the look around that it was, if it was one.
    around: Option<Lens>,
}

/// Why a command does not get to the world.
enum Failure {
    /// It makes no sense in it.
    Refused(Status, String),
    /// The game is over.
    Broken(GameError),
}

impl From<GameError> for Failure {
    fn from(error: GameError) -> Self {
        Self::Broken(error)
    }
}

/// A game under way.
pub struct Game {
    engine: Engine,
    stills: Stills,
    commands: Box<dyn Publisher>,
    events: Box<dyn Subscriber>,
    frames: Vec<(CameraId, Box<dyn Subscriber>)>,
    recording: Option<Recording>,
    log: PathBuf,
    perspective: Perspective,
    commanded: u64,
}

impl Game {
    /// Begins a game; its log is `log`, which must not exist, and has `session` as its name.
    ///
    /// # Errors
    /// [`GameError`].
    pub fn new(
        plan: &SessionPlan,
        meshes: Arc<MeshLibrary>,
        renderer: Box<dyn Renderer>,
        session: &str,
        log: &Path,
    ) -> Result<Self, GameError> {
        let world = plan.build()?;
        let bus = Local::new(1);
        let cameras = cameras();
        let frames = cameras.iter().map(|camera| Ok((camera.id, bus.subscriber(Topic::Frames(camera.id))?)));
        let frames = frames.collect::<Result<_, BusError>>()?;
        let (events, commands) = (bus.subscriber(Topic::Events)?, bus.publisher(Topic::Commands)?);
        let recorder = Recorder::new(&bus)?;
        let stills = Stills::new(plan, meshes, renderer, &cameras, &bus)?;
        let engine = Engine::new(plan, world, &cameras, &bus)?;
        let failed = |source| GameError::Record { path: log.to_owned(), source };
        let recording = Some(recorder.begin(&SessionFacts::named(session), log).map_err(failed)?);
        let (log, perspective) = (log.to_owned(), Perspective::default());
        let mut game = Self { engine, stills, commands, events, frames, recording, log, perspective, commanded: 0 };
        game.send(&CommandMessage::claim(0, BODY.0, "client", false))?;
        Ok(game)
    }

    /// Carries a batch out, in order, up to the first command that fails, or `stop`.
    ///
    /// # Errors
    /// [`GameError`]; the game is over then.
    pub fn play(&mut self, batch: &[Value], stop: &AtomicBool) -> Result<Reply, GameError> {
        let Batch { end, last_action, around } = self.run(batch, stop)?;
        let (status, detail) = &end;
        if !status.is_success() {
            tracing::info!("{status:?}: {detail}");
        }
        self.keep(Recording::flush);
        self.reply(end, last_action, around)
    }

    /// Answers what is no batch, and changes nothing.
    ///
    /// # Errors
    /// [`GameError`]; the game is over then.
    pub fn refuse(&mut self, status: Status, problem: String) -> Result<Reply, GameError> {
        self.reply((status, problem), LastAction::default(), None)
    }

    fn reply(&mut self, end: End, last_action: LastAction, around: Option<Lens>) -> Result<Reply, GameError> {
        let pictures = self.look(around)?;
        Ok(Reply::new(end, last_action, self.world(), BODY, pictures))
    }

    /// Carries out the commands of a batch up to the first that fails, or `stop`.
    fn run(&mut self, commands: &[Value], stop: &AtomicBool) -> Result<Batch, GameError> {
        let mut batch =
            Batch { end: done("there was nothing to do"), last_action: LastAction::default(), around: None };
        if commands.len() > MOST_COMMANDS {
            let problem = format!("{} commands in one batch: at most {MOST_COMMANDS}", commands.len());
            return Ok(Batch { end: (Status::IncorrectActionFormat, problem), ..batch });
        }
        for (index, value) in commands.iter().enumerate() {
            if stop.load(Ordering::Relaxed) {
                batch.end = (Status::ArenaUnavailable, "the arena ends".to_owned());
                break;
            }
            let command = Command::read(index, value, self.world().catalog().rooms());
            batch.end = match &command {
                Ok(command) => self.carry_out(index, command)?,
                Err(error) => (error.status, error.to_string()),
            };
            let is_last = index + 1 == commands.len() || !batch.end.0.is_success();
            if is_last {
                batch.last_action = LastAction::of(index, value);
                batch.around = match command {
                    Ok(Command::LookAround { lens, .. }) if batch.end.0.is_success() => Some(lens),
                    _ => None,
                };
                break;
            }
        }
        Ok(batch)
    }

    /// The world as it is.
    pub const fn world(&self) -> &World {
        self.engine.world()
    }

    /// Ends the game and its log.
    pub fn end(self) {
        match self.recording.map(Recording::finish) {
            None | Some(Ok(0)) => {}
            Some(Ok(missing)) => tracing::error!("{}: {missing} messages are missing", self.log.display()),
            Some(Err(error)) => tracing::error!("{}: {error}", self.log.display()),
        }
    }

    fn carry_out(&mut self, index: usize, command: &Command) -> Result<End, GameError> {
        match self.attempt(command) {
            Ok((status, detail)) if status.is_success() => Ok((status, detail)),
            Ok((status, detail)) | Err(Failure::Refused(status, detail)) => Ok((status, format!("/{index}: {detail}"))),
            Err(Failure::Broken(error)) => Err(error),
        }
    }

    fn attempt(&mut self, command: &Command) -> Result<End, Failure> {
        let action = match command {
            Command::Move { distance_m } => Action::Move { distance_m: *distance_m },
            Command::Rotate { right_deg } => Action::Rotate { yaw_rad: -right_deg.to_radians() },
            Command::Look { up_deg } => Action::Look { pitch_rad: up_deg.to_radians() },
            Command::LookAround { turns: true, .. } => Action::LookAround,
            Command::LookAround { turns: false, .. } => return Ok(done("I looked around")),
            Command::CameraChange(perspective) => {
                self.perspective = *perspective;
                return Ok(done("the camera was changed"));
            }
            Command::Highlight { object, turns, turns_back } => {
                let object = self.find(object)?;
                return Ok(self.highlight(object, *turns, *turns_back)?);
            }
            Command::GoTo(destination) => Action::GoTo { target: self.target(destination)? },
            Command::PickUp { object } => Action::PickUp { object: self.find(object)? },
            Command::Place { receptacle } => Action::Place { receptacle: self.find(receptacle)? },
            Command::Interact { verb, source, destination } => {
                Action::Interact { verb: *verb, object: self.interaction(*verb, source, destination)? }
            }
        };
        let end = self.act(action)?;
        if matches!(action, Action::PickUp { .. } | Action::Place { .. } | Action::Interact { .. }) {
            self.wait(SETTLE_TICKS)?;
        }
        Ok(end)
    }

    /// The object that a client means.
    fn find(&self, instance: &str) -> Result<ObjectId, Failure> {
        self.world().find(instance).ok_or_else(|| {
            let problem = format!("there is no object `{instance}` in this game: `objects` has those there are");
            Failure::Refused(Status::InvalidObjectClass, problem)
        })
    }

    fn target(&mut self, destination: &Destination) -> Result<GoToTarget, Failure> {
        Ok(match destination {
            Destination::Object(instance) => GoToTarget::Object(self.find(instance)?),
            Destination::Room(room) => GoToTarget::Room(*room),
            Destination::Viewpoint(room, number) => GoToTarget::Viewpoint(*room, *number),
            Destination::Place(place) => GoToTarget::Point(place.on_floor()),
            Destination::Pixel(pixel) => {
                let nothing =
                    || Failure::Refused(Status::InvalidObjectClass, "there is nothing at that pixel".to_owned());
                self.target_at(*pixel)?.ok_or_else(nothing)?
            }
        })
    }

    /// What an interaction is done to. Clients name two things, of which the world finds one by itself: what is in
    /// the robot's hand.
    fn interaction(&self, verb: Verb, source: &str, destination: &str) -> Result<ObjectId, Failure> {
        let held = self.world().body(BODY).and_then(|body| body.held);
        let destination = self.find(destination)?;
        if source.is_empty() || source == robot_id(BODY) {
            return Ok(destination);
        }
        let (name, source, at_sink) = (source, self.find(source)?, matches!(verb, Verb::Fill | Verb::Clean));
        if at_sink && held == Some(destination) {
            return Ok(source);
        }
        if at_sink || held == Some(source) {
            return Ok(destination);
        }
        let problem = format!("`{name}` is not in the robot's hand: it has to be picked up first");
        Err(Failure::Refused(Status::ObjectNotPickedUp, problem))
    }

    /// Points an object out, perhaps turning to it and back.
    fn highlight(&mut self, object: ObjectId, turns: bool, turns_back: bool) -> Result<End, GameError> {
        let turn = if turns { self.turn_to(object) } else { None };
        if let Some((yaw_rad, pitch_rad)) = turn {
            self.act(Action::Rotate { yaw_rad })?;
            self.act(Action::Look { pitch_rad })?;
        }
        let end = self.act(Action::Highlight { object })?;
        if let Some((yaw_rad, pitch_rad)) = turn.filter(|_| turns_back) {
            self.act(Action::Look { pitch_rad: -pitch_rad })?;
            self.act(Action::Rotate { yaw_rad: -yaw_rad })?;
        }
        Ok(end)
    }

    /// How far the robot has to turn and to look up to face an object, rad.
    fn turn_to(&self, object: ObjectId) -> Option<(f32, f32)> {
        const MOST_RAD: f32 = std::f32::consts::FRAC_PI_3;
        let (body, object) = (self.world().body(BODY)?, self.world().object(object)?);
        let to = object.position_m - body.eye;
        let up_rad = libm::atan2f(to.z, Vec3::new(to.x, to.y, 0.0).length()).clamp(-MOST_RAD, MOST_RAD);
        Some((wrap(libm::atan2f(to.y, to.x) - body.yaw_rad), up_rad - body.head_pitch_rad))
    }

    /// Has the robot do something, and waits for what comes of it.
    fn act(&mut self, action: Action) -> Result<End, GameError> {
        let command = self.command(action)?;
        for _ in 0..PATIENCE_TICKS {
            self.tick()?;
            if let Some(end) = self.outcome(command)? {
                return Ok(end);
            }
        }
        self.command(Action::Stop)?;
        self.tick()?;
        Ok((Status::ActionExecutionError, "it took too long, and was stopped".to_owned()))
    }

    fn command(&mut self, action: Action) -> Result<u64, GameError> {
        self.commanded += 1;
        let command = self.commanded;
        self.send(&CommandMessage::act(command, 0, BODY.0, action))?;
        Ok(command)
    }

    fn send(&mut self, message: &CommandMessage) -> Result<(), GameError> {
        self.commands.send_record(self.engine.world().tick(), message)?;
        Ok(())
    }

    fn tick(&mut self) -> Result<(), GameError> {
        self.engine.tick(wall_nanos())?;
        self.keep(Recording::take_down);
        Ok(())
    }

    /// The outcome of a command, if it has come.
    fn outcome(&mut self, command: u64) -> Result<Option<End>, GameError> {
        let mut end = None;
        while let Some(sample) = self.events.receive()? {
            let event: EventMessage = message::read(sample.payload())?;
            if let (Some(EventKind::Outcome), Some(status), true) =
                (event.kind(), event.status(), event.command == command)
            {
                end = Some((status, event.text.as_str().to_owned()));
            }
        }
        Ok(end)
    }

    fn wait(&mut self, ticks: u64) -> Result<(), GameError> {
        for _ in 0..ticks {
            self.tick()?;
        }
        Ok(())
    }

    /// Goes on with the log; a game does not end because its disk is full.
    fn keep(&mut self, write: fn(&mut Recording) -> Result<(), RecordError>) {
        if let Some(Err(error)) = self.recording.as_mut().map(write) {
            tracing::error!("{}: {error}; the game goes on, and is not recorded any more", self.log.display());
            self.recording = None;
        }
    }

    /// The pictures that a reply shows: four around, if a lens for them is given.
    fn look(&mut self, around: Option<Lens>) -> Result<Pictures, GameError> {
        let camera = match (around, self.perspective) {
            (Some(_), _) => around_camera(),
            (None, Perspective::First) => CameraId::Egocentric(0),
            (None, Perspective::Third) => CameraId::Spectator(0),
        };
        self.with_frame(camera, around, |frame| Ok(Pictures::of(&frame)?))
    }

    /// What the robot's eyes show at a pixel, as somewhere to go.
    fn target_at(&mut self, [x, y]: [f32; 2]) -> Result<Option<GoToTarget>, GameError> {
        self.with_frame(CameraId::Egocentric(0), None, |frame| {
            let header = frame.header;
            let pixel = y as usize * header.width as usize + x as usize;
            let (Some(ids), Some(depths)) = (frame.ids(), frame.depth_m()) else {
                return Err(PictureError::Plane(Plane::Ids).into());
            };
            let (Some(id), Some(depth_m)) = (ids.get(pixel), depths.get(pixel)) else { return Ok(None) };
            Ok(match Thing::of_id(*id) {
                Thing::Object(object) => Some(GoToTarget::Object(object)),
                Thing::Body(_) | Thing::Surface(_) => {
                    let focal = header.height as f32 / 2.0 / libm::tanf(header.fov_y_rad / 2.0);
                    let right = (x + 0.5 - header.width as f32 / 2.0) / focal;
                    let down = (y + 0.5 - header.height as f32 / 2.0) / focal;
                    let (sin_yaw, cos_yaw) = libm::sincosf(header.yaw_rad);
                    let (sin_pitch, cos_pitch) = libm::sincosf(header.pitch_rad);
                    let ahead = cos_pitch + down * sin_pitch;
                    let [from_x, from_y, _] = header.position_m;
                    let at_x = from_x + depth_m * (ahead * cos_yaw + right * sin_yaw);
                    let at_y = from_y + depth_m * (ahead * sin_yaw - right * cos_yaw);
                    Some(GoToTarget::Point([at_x, at_y]))
                }
                Thing::Nothing => None,
            })
        })
    }

    fn with_frame<T>(
        &mut self,
        camera: CameraId,
        lens: Option<Lens>,
        read: impl FnOnce(FrameView<'_>) -> Result<T, GameError>,
    ) -> Result<T, GameError> {
        self.stills.shoot(self.engine.visible(), camera, lens)?;
        let frames = self.frames.iter_mut().find(|(id, _)| *id == camera).map(|(_, frames)| frames);
        let sample = frames.map_or(Ok(None), |frames| frames.latest())?.ok_or(GameError::NoFrame(camera))?;
        read(FrameView::new(sample.payload())?)
    }
}

fn done(detail: &str) -> End {
    (Status::ActionSuccessful, detail.to_owned())
}

fn around_camera() -> CameraId {
    CameraId::Named(AROUND.parse().expect("invariant: lower-case letters and a hyphen"))
}

/// The robot's eyes, its look around, and who stands behind it: all of one size, with all planes.
fn cameras() -> [CameraPlan; 3] {
    let body = 0;
    let behind = CameraPlan::usual(CameraId::Spectator(body), Mount::Behind { body });
    let lens = Lens::new(SIDE_PX, SIDE_PX, behind.lens.fov_y_deg()).expect("invariant: sizes are within bounds");
    [
        CameraPlan::usual(CameraId::Egocentric(body), Mount::Head { body }),
        CameraPlan::usual(around_camera(), Mount::Panorama { body }),
        CameraPlan { lens, planes: Plane::ALL.to_vec(), ..behind },
    ]
}

fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let turned = (angle_rad + PI) % TAU;
    if turned < 0.0 { turned + PI } else { turned - PI }
}

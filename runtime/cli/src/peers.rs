//! The processes of a session, each of which can also be started by hand.

use std::{
    ffi::OsString,
    io::Write as _,
    net::{IpAddr, SocketAddr},
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
    thread,
};

use anyhow::Context as _;
use cohabit_bus::{Session, Shm, message::Control};
use cohabit_cdf::BodyRequest;
use cohabit_dialog::{Asking, DialogConfig, Drivable, Knows};
use cohabit_engine::{CameraPlan, SessionPlan, Simulator};
use cohabit_record::{LogError, RecordError, Recorder};
use cohabit_render::MeshLibrary;

use crate::{
    arena::{ArenaOptions, Games},
    failure::bad_input,
    minds::MindKind,
    mission_file::MissionFile,
    rendering::Rendering,
    stop,
};

/// What all peers of a session are told.
#[derive(clap::Args)]
pub struct Joining {
    /// The session's name
    #[arg(long)]
    session: String,
    /// The process that supervises this one
    #[arg(long, hide = true)]
    supervisor: Option<i32>,
}

impl Joining {
    fn join(&self) -> anyhow::Result<(Shm, Arc<AtomicBool>)> {
        let stop = stop::on_request()?;
        stop::with_supervisor(self.supervisor)?;
        let session = Session::new(&self.session).map_err(bad_input)?;
        Ok((Shm::join(&session).map_err(bad_input)?, stop))
    }
}

/// Builds the world and steps it in real time; or, with --arena-port, as existing clients command.
#[derive(clap::Args)]
pub struct Sim {
    /// A mission file (CDF), or the name of a built-in mission
    mission: Option<String>,
    /// The session's name
    #[arg(long, required_unless_present = "arena_port")]
    session: Option<String>,
    /// The process that supervises this one
    #[arg(long, hide = true)]
    supervisor: Option<i32>,
    #[command(flatten)]
    arena: ArenaOptions,
    /// The seed of all that is random, where the mission does not fix it
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// A body beside the mission's own robot: `robot` or `person`, with a room if wanted; as often as needed
    #[arg(long = "body", value_name = "KIND[@ROOM]")]
    bodies: Vec<BodyRequest>,
    /// A camera beside those of the bodies, on the topic `frames/NAME`: KIND is `egocentric`, `panorama`,
    /// `third-person`, `fixed` (x=, y=, z= in metres, yaw=, pitch= in degrees) or `top-down` (span= in metres); all have
    /// size=WxH, rate=, planes=color+depth+normals+ids, and most body= and fov=; as often as needed
    #[arg(long = "camera", value_name = "NAME=KIND[,OPTION=VALUE]")]
    cameras: Vec<CameraPlan>,
    #[command(flatten)]
    rendering: Rendering,
    #[command(flatten)]
    timing: Timing,
}

/// How the world's time goes by.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Timing {
    /// How many times as fast as real time the world begins, 0.05 to 20
    #[arg(long, default_value_t = 1.0, value_parser = speed)]
    speed: f32,
    /// Begin with the world standing still: `cohabit time resume` has it go on
    #[arg(long)]
    paused: bool,
    /// In lock-step instead of real time: the world waits for each agent that attends, tick by tick, and goes as fast as
    /// they do
    #[arg(long, conflicts_with = "speed")]
    lock_step: bool,
    /// In lock-step, the world begins when so many agents attend; if absent, one, or as many as `play` starts
    #[arg(long, requires = "lock_step")]
    agents: Option<usize>,
}

/// A speed that the clock takes.
pub fn speed(text: &str) -> Result<f32, String> {
    let speeds = Control::SPEEDS;
    let speed = text.parse().ok().filter(|speed| speeds.contains(speed));
    speed.ok_or_else(|| format!("from {} to {} times real time", speeds.start(), speeds.end()))
}

impl Timing {
    /// The same choice as arguments of another process.
    pub fn arguments(self) -> Vec<OsString> {
        let mut arguments = Vec::new();
        if self.lock_step {
            arguments.extend(["--lock-step".into(), "--agents".into(), self.agents().to_string().into()]);
        } else {
            arguments.extend(["--speed".into(), self.speed.to_string().into()]);
        }
        arguments.extend(self.paused.then(|| "--paused".into()));
        arguments
    }

    /// The same; it begins with so many agents, if it was not said how many.
    pub fn with_agents(self, agents: usize) -> Self {
        Self { agents: self.agents.or(Some(agents)), ..self }
    }

    fn agents(self) -> usize {
        self.agents.unwrap_or(1)
    }

    fn of(self, plan: SessionPlan) -> SessionPlan {
        if self.lock_step { plan.in_lock_step(self.agents()) } else { plan }
    }
}

impl Sim {
    /// Runs the simulator.
    pub fn run(&self) -> anyhow::Result<()> {
        if let Some(port) = self.arena.port() {
            let (mission, rendering) = (self.mission.as_deref(), self.rendering);
            return self.arena.serve(port, &Games { mission, seed: self.seed, bodies: &self.bodies, rendering });
        }
        let plan = MissionFile::find(self.mission.as_deref())?.plan(self.seed, &self.bodies)?;
        let plan = self.timing.of(plan.with_cameras(self.cameras.clone()).map_err(bad_input)?);
        let session = self.session.clone().unwrap_or_default();
        let (bus, stop) = Joining { session, supervisor: self.supervisor }.join()?;
        let (world, meshes) = thread::scope(|scope| {
            let meshes = scope.spawn(|| MeshLibrary::build(&plan.catalog));
            let world = plan.build();
            (world, meshes.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        });
        let meshes = Arc::new(meshes.context("build the models")?);
        let renderer = self.rendering.start()?;
        let simulator = Simulator::new(&plan, world.map_err(bad_input)?, meshes, renderer, &bus)?;
        simulator.starting(self.timing.speed, self.timing.paused).run(&stop)?;
        Ok(())
    }
}

/// Runs a mind for one body.
#[derive(clap::Args)]
pub struct Agent {
    /// What kind of mind
    #[arg(value_enum, default_value = "dialog")]
    kind: MindKind,
    #[command(flatten)]
    joining: Joining,
    /// The body it commands
    #[arg(long, default_value_t = 0)]
    body: u32,
    /// The seed of all that is random in it
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What a scripted one does: a file with an action a line
    #[arg(long, value_name = "FILE", required_if_eq("kind", "scripted"))]
    script: Option<PathBuf>,
}

impl Agent {
    /// Runs the agent.
    pub fn run(&self) -> anyhow::Result<()> {
        let mut mind = self.kind.mind(self.body, self.seed, self.script.as_deref())?;
        let (bus, stop) = self.joining.join()?;
        cohabit_agent::run(&mut *mind, self.body, &bus, &stop)?;
        Ok(())
    }
}

/// Serves the page, and turns what people say into plans.
#[derive(clap::Args)]
pub struct Dialog {
    #[command(flatten)]
    joining: Joining,
    #[command(flatten)]
    listening: Listening,
}

/// Where the page is served.
#[derive(clap::Args, Clone)]
pub struct Listening {
    /// The port of the page; 0 takes any that is free
    #[arg(long, default_value_t = 8765)]
    pub port: u16,
    /// The address the page listens on; beyond this machine it asks for the session's token
    #[arg(long, default_value = "127.0.0.1")]
    pub listen: IpAddr,
    /// Whom people may drive from the page: the avatars of `people`, `all` bodies, which robots' minds then hand over for
    /// so long, or `none`
    #[arg(long, default_value_t)]
    pub drive: Drivable,
    /// What the robot may know: `everything` there is, or what it has `seen` so far, beside the floor plan
    #[arg(long, default_value_t)]
    pub knows: Knows,
    /// When the robot asks: `never`, when it is `unsure`, or `always`, and before it does anything
    #[arg(long, value_name = "WHEN", default_value_t)]
    pub ask: Asking,
}

impl Dialog {
    /// Runs the dialog service. Prints its address, and later the time of the first frame shown, for its supervisor.
    pub fn run(&self) -> anyhow::Result<()> {
        let (bus, stop) = self.joining.join()?;
        let Some(message) = cohabit_agent::wait_for_mission(&bus, &stop)? else { return Ok(()) };
        let file = MissionFile { name: message.header.file.as_str().to_owned(), text: message.text };
        let SessionPlan { catalog, layout, mission, .. } = file.plan(message.header.seed, &message.bodies)?;
        let config = DialogConfig {
            session: self.joining.session.clone(),
            journal: Some(Session::new(&self.joining.session).map_err(bad_input)?.folder().join("dialog.journal")),
            cameras: message.cameras,
            listen: SocketAddr::new(self.listening.listen, self.listening.port),
            knows: self.listening.knows,
            asking: self.listening.ask,
            drivable: self.listening.drive,
            on_first_frame: Box::new(|| tell_supervisor("shown")),
        };
        let ready = |address: &str| tell_supervisor(&format!("page {address}"));
        cohabit_dialog::serve(Arc::new(bus), mission, layout, catalog, config, &stop, ready).map_err(bad_input)
    }
}

fn tell_supervisor(line: &str) {
    let mut out = std::io::stdout().lock();
    // Nobody listening is no reason to stop serving.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}

/// Writes the session log.
#[derive(clap::Args)]
pub struct Record {
    #[command(flatten)]
    joining: Joining,
    /// The log file to write; one of the same session is carried on with
    #[arg(long)]
    log: PathBuf,
}

impl Record {
    /// Runs the recorder.
    pub fn run(&self) -> anyhow::Result<()> {
        let (bus, stop) = self.joining.join()?;
        let caught_up = || tell_supervisor(&format!("recording {}", self.log.display()));
        Recorder::new(&bus)?.run(&self.joining.session, &self.log, &stop, caught_up).map_err(|error| match error {
            RecordError::Log(LogError::Write { .. }) | RecordError::Bus(_) | RecordError::Malformed(_) => error.into(),
            RecordError::Log(_) | RecordError::NoMission => bad_input(error),
        })
    }
}

//! The processes of a session, each of which can also be started by hand.

use std::{
    ffi::OsString,
    fmt,
    io::Write as _,
    net::{IpAddr, SocketAddr},
    path::PathBuf,
    str::FromStr,
    sync::{Arc, atomic::AtomicBool},
    thread,
};

use anyhow::Context as _;
use cohabit_bus::{CameraId, Session, Shm, message::Control};
use cohabit_cdf::BodyRequest;
use cohabit_dialog::{
    Addresses, Asking, Consulting, DialogConfig, DialogError, Drivable, Effort, Endpoint, Hidden, HostName, Knows,
    Questionnaire,
};
use cohabit_engine::{Appearance, BuildError, CameraPlan, SessionPlan, Simulator};
use cohabit_record::{Branch, LogError, RecordError, Recorder, SessionFacts};
use cohabit_render::MeshLibrary;
use cohabit_world::World;

use crate::{
    arena::{ArenaOptions, Games},
    branch::{BranchPoint, Branched},
    build,
    failure::{IncompleteLog, bad_input, environment, joining},
    minds::{MindKind, expert},
    mission_file::MissionFile,
    rendering::Rendering,
    rerun, stop,
    tls::Tls,
    voice::VoiceOptions,
    wizard::WizardOptions,
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
        Ok((Shm::join(&session).map_err(joining)?, stop))
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
    /// Go on from a point of a recorded session instead, LOG@TIME
    #[arg(long, value_name = "LOG@TIME", conflicts_with_all = ["mission", "seed", "bodies", "arena_port"])]
    branch: Option<BranchPoint>,
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

impl fmt::Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.lock_step {
            true => write!(f, "lock-step with {} agents", self.agents()),
            false => write!(f, "real time, {} times", self.speed),
        }
    }
}

/// A speed that the clock takes.
pub fn speed(text: &str) -> Result<f32, String> {
    let speeds = Control::SPEEDS;
    let speed = text.parse().ok().filter(|speed| speeds.contains(speed));
    speed.ok_or_else(|| format!("from {} to {} times real time", speeds.start(), speeds.end()))
}

impl Timing {
    /// How many times as fast as real time the world begins.
    pub const fn speed(self) -> f32 {
        self.speed
    }

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
        let (plan, before) = self.plan()?;
        let cameras = [plan.cameras.as_slice(), &self.cameras].concat();
        let plan = self.timing.of(plan.with_cameras(cameras).map_err(bad_input)?);
        let session = self.session.clone().unwrap_or_default();
        let (bus, stop) = Joining { session, supervisor: self.supervisor }.join()?;
        let (before, meshes) = thread::scope(|scope| {
            let meshes = scope.spawn(|| MeshLibrary::build(&plan.catalog));
            let before = before.map_or_else(|| Ok((plan.build()?, Appearance::default())), Ok::<_, BuildError>);
            (before, meshes.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        });
        let meshes = Arc::new(meshes.context("build the models")?);
        let renderer = self.rendering.start()?;
        let (world, appearance) = before.map_err(bad_input)?;
        let simulator = Simulator::new(&plan, world, meshes, renderer, &bus)?.appearing(appearance);
        simulator.starting(self.timing.speed, self.timing.paused).run(&stop)?;
        Ok(())
    }
}

impl Sim {
    /// What is simulated, and the world that it goes on from if that is not the mission's.
    fn plan(&self) -> anyhow::Result<(SessionPlan, Option<(World, Appearance)>)> {
        match &self.branch {
            Some(point) => {
                let Branched { plan, world, appearance, .. } = point.open()?;
                Ok((plan, Some((world, appearance))))
            }
            None => Ok((
                MissionFile::find(self.mission.as_deref())?.plan(self.seed, &self.bodies).map_err(bad_input)?,
                None,
            )),
        }
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
        let mind = self.kind.mind(self.body, self.seed, self.script.as_deref())?;
        let (bus, stop) = self.joining.join()?;
        let mind = mind.map_or_else(|| expert(self.body, &bus, &stop), |mind| Ok(Some(mind)))?;
        if let Some(mut mind) = mind {
            cohabit_agent::run(&mut *mind, self.body, &bus, &stop)?;
        }
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
    /// A body whose robot people speak to; as often as there are
    #[arg(long = "robot", value_name = "BODY", default_value = "0")]
    robots: Vec<u32>,
}

/// Where the page is served.
#[derive(clap::Args, Clone)]
pub struct Listening {
    /// The port of the page; 0 takes any that is free
    #[arg(long, default_value_t = 8765)]
    pub port: u16,
    /// The address the page listens on, such as 0.0.0.0 for other machines
    #[arg(long, default_value = "127.0.0.1")]
    pub listen: IpAddr,
    /// A name by which browsers may ask for the page besides those of this machine, such as that of a proxy, with its port
    /// if it is another one; as often as needed
    #[arg(long = "host", value_name = "NAME[:PORT]")]
    pub hosts: Vec<HostName>,
    /// The port of the server of the same host whose pages may show the page within them, such as that of a study
    #[arg(long, value_name = "PORT")]
    pub framed_by: Option<u16>,
    #[command(flatten)]
    pub tls: Tls,
    /// What the page leaves out: `figures` for developers, the `microphone`, or the `score`; as often as needed
    #[arg(long, value_name = "PART")]
    pub hide: Vec<Hidden>,
    /// Whom people may drive from the page: the avatars of `people`, `all` bodies, which robots' minds then hand over for
    /// so long, or `none`
    #[arg(long, default_value_t)]
    pub drive: Drivable,
    /// What the robot may know: `everything` there is, or what it has `seen` so far, beside the floor plan
    #[arg(long, default_value_t)]
    pub knows: Knows,
    /// What a body is called, such as `0=Rosie`, by those who speak to it and on the page; as often as needed
    #[arg(long = "name", value_name = "BODY=NAME")]
    pub names: Vec<BodyName>,
    /// When the robot asks: `never`, when it is `unsure`, or `always`, and before it does anything
    #[arg(long, value_name = "WHEN", default_value_t)]
    pub ask: Asking,
    /// How much work goes into what people say: `full`, with a small language model that rewrites it in plain requests, some
    /// tenths of a second each time, or `fast`, without
    #[arg(long, value_name = "EFFORT", default_value_t)]
    pub understanding: Effort,
    /// When the language model that COHABIT_MODEL_URL and COHABIT_MODEL name is asked what people mean: `never`, where the
    /// robot is `unsure`, or `always`
    #[arg(long, value_name = "WHEN", default_value_t)]
    pub model: Consulting,
    /// What people are asked on the page, before they play or after: `sus` (System Usability Scale), `tlx` (NASA Task Load
    /// Index), or a file (TOML); as often as needed
    #[arg(long = "questionnaire", value_name = "NAME|FILE")]
    pub questionnaires: Vec<String>,
    #[command(flatten)]
    pub wizard: WizardOptions,
    #[command(flatten)]
    pub voice: VoiceOptions,
}

/// The longest name of a body, in characters.
const LONGEST_NAME: usize = 24;

/// What a body is called.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct BodyName {
    /// Which.
    pub body: u32,
    /// Its name.
    pub name: String,
}

impl FromStr for BodyName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (body, name) =
            text.split_once('=').ok_or_else(|| "write a body and its name, such as `0=Rosie`".to_owned())?;
        let body = body.parse().map_err(|_| format!("`{body}` is no body: bodies count from 0, such as `0={name}`"))?;
        let is_name =
            |name: &str| name.chars().all(|c| c.is_alphanumeric() || c == ' ') && name.contains(char::is_alphabetic);
        let name = name.trim();
        if !is_name(name) || name.chars().count() > LONGEST_NAME {
            return Err(format!(
                "`{name}` is no name: up to {LONGEST_NAME} letters, digits and spaces, such as `Rosie`"
            ));
        }
        Ok(Self { body, name: name.to_owned() })
    }
}

impl fmt::Display for BodyName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.body, self.name)
    }
}

impl Listening {
    /// What people are asked.
    pub fn questionnaires(&self) -> anyhow::Result<Vec<Questionnaire>> {
        let found: Vec<_> = self
            .questionnaires
            .iter()
            .map(|name| Questionnaire::find(name))
            .collect::<Result<_, _>>()
            .map_err(bad_input)?;
        let twice = found.iter().enumerate().find(|(at, one)| found[..*at].iter().any(|other| other.name == one.name));
        match twice {
            Some((_, one)) => Err(bad_input(format!(
                "`--questionnaire`: two are called `{}` (a file's name, without its ending, is that of its questionnaire)",
                one.name
            ))),
            None => Ok(found),
        }
    }
}

impl Dialog {
    /// Runs the dialog service. Prints its address, and later the time of the first frame shown, for its supervisor.
    pub fn run(&self) -> anyhow::Result<()> {
        let (bus, stop) = self.joining.join()?;
        let Some(message) = cohabit_agent::wait_for_mission(&bus, &stop)? else { return Ok(()) };
        let file = MissionFile { name: message.header.file.as_str().to_owned(), text: message.text };
        let SessionPlan { catalog, layout, mission, .. } =
            file.plan(message.header.seed, &message.bodies).context("the mission that the simulator published")?;
        let config = DialogConfig {
            session: self.joining.session.clone(),
            journal: Some(journal(&Session::new(&self.joining.session).map_err(bad_input)?)),
            cameras: message.cameras,
            identity: self.listening.tls.identity(self.listening.listen)?,
            framed_by: self.listening.framed_by,
            listen: SocketAddr::new(self.listening.listen, self.listening.port),
            hosts: self.listening.hosts.clone(),
            knows: self.listening.knows,
            asking: self.listening.ask,
            effort: self.listening.understanding,
            consulting: self.listening.model,
            interpreter: Endpoint::from_environment().map_err(bad_input)?.map(|model| Box::new(model) as _),
            robots: self.robots.clone(),
            names: self.listening.names.iter().map(|one| (one.body, one.name.clone())).collect(),
            drivable: self.listening.drive,
            questionnaires: self.listening.questionnaires()?,
            voice: self.listening.voice.config(message.header.seed),
            hidden: self.listening.hide.clone(),
            holding: self.listening.wizard.holding(),
            on_first_frame: Box::new(|| tell_supervisor("shown")),
        };
        let ready = |addresses: &Addresses| {
            // Whoever reads what the supervisor says knows the seat when they know the page.
            if let Some(address) = &addresses.wizard {
                tell_supervisor(&format!("wizard {address}"));
            }
            tell_supervisor(&format!("page {}", addresses.page));
        };
        cohabit_dialog::serve(Arc::new(bus), mission, layout, catalog, config, &stop, ready).map_err(
            |error| match error {
                DialogError::Listen { .. } => environment(error),
                other => other.into(),
            },
        )
    }
}

/// Where the dialog service of a session writes down what was said.
pub fn journal(session: &Session) -> PathBuf {
    session.folder().join("dialog.journal")
}

fn tell_supervisor(line: &str) {
    let mut out = std::io::stdout().lock();
    // Nobody listening is no reason to stop serving.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}

/// Writes the session log. Exit code 3 says that some of the session is not in it.
#[derive(clap::Args)]
pub struct Record {
    #[command(flatten)]
    joining: Joining,
    /// The log file to write; one of the same session is carried on with
    #[arg(long)]
    log: PathBuf,
    #[command(flatten)]
    noted: Noted,
    #[command(flatten)]
    watching: Watching,
}

/// Who watches a session besides its pages.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
pub struct Watching {
    /// Show the session live in rerun's viewer at an address; where none listens, one is started
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = "127.0.0.1:9876")]
    rerun: Option<SocketAddr>,
}

impl Watching {
    /// Says what is missing for it, before anything is started.
    pub fn check(self) -> anyhow::Result<()> {
        if self.rerun.is_some() { rerun::check() } else { Ok(()) }
    }

    /// The same as arguments of another process.
    pub fn arguments(self) -> Option<OsString> {
        self.rerun.map(|viewer| format!("--rerun={viewer}").into())
    }

    fn start(self, session: &str) -> anyhow::Result<Option<rerun::Live>> {
        self.rerun.map(|viewer| rerun::Live::start(session, viewer)).transpose()
    }
}

/// What a log notes of its session besides what is told on the bus.
#[derive(clap::Args, Clone, Default)]
pub struct Noted {
    /// What the participant is called in the study, for the log: a label, not a name
    #[arg(long, value_name = "LABEL", value_parser = label)]
    pub participant: Option<String>,
    /// How the session is played, for the log; as often as needed
    #[arg(long = "setting", hide = true, value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<(String, String)>,
    /// A camera of the session, for the log; as often as needed
    #[arg(long = "camera", hide = true)]
    pub cameras: Vec<CameraPlan>,
    /// A camera whose frames are recorded, too; as often as needed
    #[arg(long = "record-frames", value_name = "CAMERA")]
    pub frames: Vec<CameraId>,
    /// Record what people and robots say aloud
    #[arg(long = "record-audio", hide = true)]
    pub audio: bool,
    /// The session that it goes on from, for the log
    #[arg(long, hide = true, value_parser = branch)]
    pub branched: Option<Branch>,
}

/// How the settings of a log that hold the names of bodies begin; the body's number follows.
pub const NAME_OF: &str = "name.";

/// What a participant may be called.
pub fn label(text: &str) -> Result<String, String> {
    const LONGEST: usize = 64;
    let fits = !text.trim().is_empty() && text.len() <= LONGEST && !text.chars().any(char::is_control);
    if fits { Ok(text.to_owned()) } else { Err(format!("one to {LONGEST} bytes of text on one line")) }
}

fn setting(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').ok_or("NAME=VALUE")?;
    Ok((parts.0.to_owned(), parts.1.to_owned()))
}

/// The end of [`Noted::arguments`]' last argument, read back.
fn branch(text: &str) -> Result<Branch, String> {
    let read = || {
        let (tick, rest) = text.split_once(',')?;
        let (run, session) = rest.split_once(',')?;
        let run = u64::from_str_radix(run, 16).ok()?;
        Some(Branch { session: session.to_owned(), run, tick: tick.parse().ok()? })
    };
    read().ok_or_else(|| "TICK,RUN,SESSION".to_owned())
}

impl Noted {
    /// The same as arguments of another process.
    pub fn arguments(&self) -> Vec<OsString> {
        let participant = self.participant.iter().map(|label| format!("--participant={label}"));
        let settings = self.settings.iter().map(|(name, value)| format!("--setting={name}={value}"));
        let cameras = self.cameras.iter().map(|camera| format!("--camera={camera}"));
        let frames = self.frames.iter().map(|camera| format!("--record-frames={camera}"));
        let branched = self.branched.iter();
        let branched = branched.map(|branch| format!("--branched={},{:x},{}", branch.tick, branch.run, branch.session));
        let audio = self.audio.then(|| "--record-audio".to_owned());
        participant
            .chain(settings)
            .chain(cameras)
            .chain(frames)
            .chain(audio)
            .chain(branched)
            .map(OsString::from)
            .collect()
    }

    fn facts(&self, session: &str) -> SessionFacts {
        SessionFacts {
            session: session.to_owned(),
            build: build::id().unwrap_or_default(),
            participant: self.participant.clone(),
            settings: self.settings.iter().cloned().collect(),
            cameras: self.cameras.iter().map(ToString::to_string).collect(),
            frames: self.frames.clone(),
            audio: self.audio,
            branched: self.branched.clone(),
        }
    }
}

impl Record {
    /// Runs the recorder.
    pub fn run(&self) -> anyhow::Result<()> {
        let (bus, stop) = self.joining.join()?;
        let _live = self.watching.start(&self.joining.session)?;
        let caught_up = || tell_supervisor(&format!("recording {}", self.log.display()));
        let facts = self.noted.facts(&self.joining.session);
        let recorder = Recorder::new(&bus)?.filming(&bus, &facts.frames)?;
        let recorder = if facts.audio { recorder.taping(&bus)? } else { recorder };
        recorder.run(&facts, &self.log, &stop, caught_up).map_err(|error| match error {
            RecordError::Incomplete { .. } | RecordError::Log(LogError::Disk { .. }) => {
                IncompleteLog(error.to_string()).into()
            }
            RecordError::Log(
                LogError::File { .. }
                | LogError::Busy { .. }
                | LogError::OtherSession { .. }
                | LogError::NotALog { .. }
                | LogError::TooNew { .. },
            ) => bad_input(error),
            other => other.into(),
        })
    }
}

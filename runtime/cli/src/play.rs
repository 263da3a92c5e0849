//! `cohabit play`: one session from start to end.

use std::{
    ffi::OsString,
    net::SocketAddr,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::Context as _;
use cohabit_bus::{CameraId, Session, SessionError, Shm, Topic, message::Plane};
use cohabit_cdf::{BodyRequest, WorldData};
use cohabit_dialog::{Endpoint, Questionnaire, begin_after};
use cohabit_engine::{CameraPlan, SessionPlan};
use cohabit_record::{Branch, Log};

use crate::{
    branch::{BranchPoint, Branched},
    doctor::ensure_room,
    failure::{IncompleteLog, bad_input, check_folder_of, environment, joining},
    minds::MindRequest,
    mission_file::MissionFile,
    peers::{self, Listening, NAME_OF, Noted, Timing, Watching},
    rendering::Rendering,
    sessions, site, stop,
    supervisor::{Role, Supervisor},
    terminal::shown,
    world::WorldPacks,
};

/// Starts a simulator, an agent, the dialog service and a recorder, and supervises them.
#[derive(clap::Args)]
pub struct Play {
    /// A mission file (CDF), or the name of a built-in mission; making a bowl of cereal, if absent
    mission: Option<String>,
    /// The session's name; one of its own is made up if absent
    #[arg(long)]
    session: Option<String>,
    /// The process that this session ends with
    #[arg(long, hide = true)]
    supervisor: Option<i32>,
    #[command(flatten)]
    listening: Listening,
    /// The seed of all that is random, where the mission does not fix it; the clock's if absent
    #[arg(long)]
    seed: Option<u64>,
    /// A body beside the mission's own robot: `robot` or `person`, with a room if wanted; as often as needed
    #[arg(long = "body", value_name = "KIND[@ROOM]")]
    bodies: Vec<BodyRequest>,
    /// A mind for a body: `dialog`, `random`, `scripted`, `helper`, `expert` (which plays the mission to its goals and knows
    /// what the simulator knows) or `pedestrian` (people who walk about by a schedule), with the number of its body if it is not
    /// 0, and a script if it is scripted; as often as there are bodies. Beside others `dialog` has to be named, too: without it
    /// nobody does what people ask for, and the robot tells them so
    #[arg(long = "agent", value_name = "KIND[@BODY][=FILE]", default_value = "dialog")]
    minds: Vec<MindRequest>,
    /// A camera beside those of the bodies, on the topic `frames/NAME`: KIND is `egocentric`, `panorama`,
    /// `third-person`, `fixed` (x=, y=, z= in metres, yaw=, pitch= in degrees) or `top-down` (span= in metres); all have
    /// size=WxH, rate=, planes=color+depth+normals+ids, smooth=yes or no (smooth edges and outlines, for people; in lock-step
    /// only those with smooth=no belong to the turns of agents), and most body= and fov=; as often as needed
    #[arg(long = "camera", value_name = "NAME=KIND[,OPTION=VALUE]")]
    cameras: Vec<CameraPlan>,
    /// Go on from a point of a recorded session instead, LOG@TIME: its mission, its bodies, its world
    #[arg(long, value_name = "LOG@TIME", conflicts_with_all = ["mission", "seed", "bodies"])]
    branch: Option<BranchPoint>,
    /// The session log to write; one in the user's data folder if absent
    #[arg(long)]
    log: Option<PathBuf>,
    /// What the participant is called in the study, for the log: a label, not a name
    #[arg(long, value_name = "LABEL", value_parser = peers::label)]
    participant: Option<String>,
    /// Record the frames of this camera, too, as the log else holds only what is needed to render them anew: `spectator/0`,
    /// `eyes/1`, or the name of one given by `--camera`; as often as needed
    #[arg(long = "record-frames", value_name = "CAMERA")]
    frames: Vec<CameraId>,
    #[command(flatten)]
    packs: WorldPacks,
    #[command(flatten)]
    rendering: Rendering,
    #[command(flatten)]
    timing: Timing,
    #[command(flatten)]
    watching: Watching,
}

/// How logs note how many people have a page of their own.
pub const SEATS: &str = "seats";

/// A session that this one goes on from.
struct Before {
    from: Branch,
    log: Log,
}

impl Play {
    /// Plays until the user ends it.
    pub fn run(&self) -> anyhow::Result<()> {
        let began = Instant::now();
        let stop = stop::on_request()?;
        stop::with_supervisor(self.supervisor)?;
        let seed = self.seed.unwrap_or_else(sessions::clock_seed);
        let world = self.packs.read()?;
        let (plan, before) = self.plan(seed, &world)?;
        MindRequest::check(&self.minds, &plan)?;
        self.check_names(&plan)?;
        let robots: Vec<u32> = self.minds.iter().filter_map(MindRequest::spoken_to).collect();
        let on_their_own: Vec<u32> = self.minds.iter().filter_map(MindRequest::on_its_own).collect();
        self.check_frames(&plan)?;
        self.rendering.check()?;
        self.watching.check(&self.packs)?;
        let questionnaires = self.listening.questionnaires()?;
        let page_texts = self.listening.language.texts()?;
        let Listening { tls, listen, port, .. } = &self.listening;
        // Where the port is another session's, that is said before anything is started, and no log is left.
        drop(site::listen("the page", SocketAddr::new(*listen, *port))?);
        if let Some(notice) = tls.notice(*listen, tls.identity(*listen)?.as_ref()) {
            println!("{notice}");
        }
        for name in Session::wipe_dead() {
            println!("cleaned up after session {name}, which was not ended");
        }
        ensure_room()?;
        let name = self.session.clone().unwrap_or_else(|| format!("play-{}", std::process::id()));
        let session = Session::new(&name).map_err(bad_input)?;
        let log = self.log_path(&name)?;
        let lock = session.supervise().map_err(|error| match error {
            SessionError::Name(_) | SessionError::Busy(_) => bad_input(error),
            SessionError::Access(_) | SessionError::NoSharedMemory(_) => environment(error),
        })?;
        // What all peers share is made before there are any: one that is killed while it makes it would keep the others out.
        let bus = Shm::join(&session).map_err(joining)?;
        let frames = cameras(&plan).into_iter().map(|camera| Topic::Frames(camera.id));
        let topics = bus.hold(Topic::OF_ALL_SESSIONS.into_iter().chain(frames))?;
        if let Some(Before { from, log }) = &before {
            let journal = peers::journal(&session);
            begin_after(&journal, log, from.tick, robots.len() > 1).with_context(|| journal.display().to_string())?;
        }
        println!("Playing \"{}\" ({})", shown(&plan.mission.goal_text), shown(&plan.file));
        let timing = self.timing.with_agents(self.minds.len());
        let sim = Role::sim(self.world_arguments(seed), self.rendering, timing);
        let minds = self.minds.iter().map(|agent| Role::agent(agent, seed));
        let mut noted = self.noted(&plan, &robots, &questionnaires, before.map(|before| before.from));
        noted.settings.push(("page_language".to_owned(), page_texts.language().to_owned()));
        let peers = [Role::record(&log, &noted, self.watching), Role::dialog(&self.listening, &robots, &on_their_own)];
        let packs = self.packs.arguments(&world);
        let roles = std::iter::once(sim).chain(peers).chain(minds).map(|role| role.with(&packs));
        let played = Supervisor::start(&name, roles, began).and_then(|supervisor| supervisor.run(&stop));
        // All of it is wiped now. What iceoryx2 would take back before, it would look up in memory that any program of this
        // user may have overwritten.
        std::mem::forget((topics, bus));
        session.end(lock);
        // What the killed one before was still starting may have come late.
        Session::wipe_dead();
        let whole = played.as_ref().is_ok_and(|ended| ended.log_is_whole);
        if log.is_file() {
            let how = if whole { "Recorded" } else { "Recorded in part" };
            println!("{how} in {0}\nReplay it with: cohabit replay {0}", shown(log.display()));
        }
        match played {
            Ok(_) if !whole => {
                Err(IncompleteLog("the log is incomplete: see what the recorder said".to_owned()).into())
            }
            played => played.map(drop),
        }
    }

    /// Says what is wrong with these settings for a mission, before anything is started; files of agents lie in `folder`.
    pub fn check_for(&self, plan: SessionPlan, folder: &Path) -> anyhow::Result<()> {
        let plan = plan.with_bodies(self.bodies.clone());
        let cameras = [plan.cameras.as_slice(), &self.cameras].concat();
        let plan = plan.with_cameras(cameras).map_err(bad_input)?;
        if !plan.bodies.is_empty() {
            plan.build().map_err(bad_input)?;
        }
        let minds: Vec<MindRequest> = self.minds.iter().map(|mind| mind.in_folder(folder)).collect();
        MindRequest::check(&minds, &plan)?;
        self.check_names(&plan)?;
        self.check_frames(&plan)
    }

    /// What is played, and the session that it goes on from.
    fn plan(&self, seed: u64, world: &WorldData) -> anyhow::Result<(SessionPlan, Option<Before>)> {
        let (plan, before) = match &self.branch {
            Some(point) => {
                let Branched { plan, from, log, .. } = point.open(world.catalog())?;
                println!("Going on from {} (tick {}) of session {}", point.at, from.tick, shown(&from.session));
                (plan, Some(Before { from, log }))
            }
            None => {
                let file = MissionFile::find_in(self.mission.as_deref(), world)?;
                (file.plan(world.catalog(), seed, &self.bodies).map_err(bad_input)?, None)
            }
        };
        let cameras = [plan.cameras.as_slice(), &self.cameras].concat();
        Ok((plan.with_cameras(cameras).map_err(bad_input)?, before))
    }

    /// Says which of the names are those of bodies that there are not.
    fn check_names(&self, plan: &SessionPlan) -> anyhow::Result<()> {
        let bodies = bodies(plan);
        match self.listening.names.iter().find(|name| name.body as usize >= bodies) {
            None => Ok(()),
            Some(name) => Err(bad_input(format!(
                "`--name {name}`: there is no body {}: the session has bodies 0 to {}; `--body robot` adds one",
                name.body,
                bodies - 1
            ))),
        }
    }

    /// Says which of the cameras to be recorded are none.
    fn check_frames(&self, plan: &SessionPlan) -> anyhow::Result<()> {
        let known = cameras(plan);
        let has_colors = |camera: &&CameraPlan| camera.planes.contains(&Plane::Color);
        let known: Vec<_> = known.iter().filter(has_colors).map(|camera| camera.id).collect();
        match self.frames.iter().find(|camera| !known.contains(camera)) {
            None => Ok(()),
            Some(camera) => {
                let known: Vec<_> = known.iter().map(ToString::to_string).collect();
                Err(bad_input(format!("`--record-frames {camera}`: the cameras with colours are {}", known.join(", "))))
            }
        }
    }

    /// The same as arguments of the simulator.
    fn world_arguments(&self, seed: u64) -> Vec<OsString> {
        let cameras = self.cameras.iter().map(|camera| format!("--camera={camera}").into());
        let world: Vec<OsString> = match &self.branch {
            Some(point) => vec![point.argument()],
            None => {
                let bodies = self.bodies.iter().map(|body| format!("--body={body}").into());
                let seed = ["--seed".into(), seed.to_string().into()];
                seed.into_iter().chain(bodies).chain(self.mission.iter().map(OsString::from)).collect()
            }
        };
        cameras.chain(world).collect()
    }

    /// What the log notes of the session.
    fn noted(
        &self,
        plan: &SessionPlan,
        robots: &[u32],
        questionnaires: &[Questionnaire],
        branched: Option<Branch>,
    ) -> Noted {
        let minds = self.minds.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
        let Listening {
            drive,
            knows,
            ask,
            politeness,
            verbosity,
            understanding,
            model: model_asked,
            names,
            voice,
            hide,
            wizard,
            seats,
            ..
        } = &self.listening;
        let robots = robots.iter().map(u32::to_string).collect::<Vec<_>>().join(",");
        let settings = [
            ("agents", minds),
            ("ask", ask.name().to_owned()),
            ("drive", drive.to_string()),
            ("knows", knows.to_string()),
            ("politeness", politeness.to_string()),
            ("renderer", self.rendering.to_string()),
            ("robots", robots),
            ("timing", self.timing.with_agents(self.minds.len()).to_string()),
            ("understanding", understanding.to_string()),
            ("verbosity", verbosity.to_string()),
        ];
        let asked = questionnaires.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(" ");
        let asked = (!asked.is_empty()).then_some(("questionnaires", asked));
        let hidden = hide.iter().map(|part| (part.name(), "hidden".to_owned()));
        let model = Endpoint::from_environment().ok().flatten();
        let model = model.map(|endpoint| {
            [
                ("model", endpoint.model().to_owned()),
                ("model_address", endpoint.public_address()),
                ("model_asked", model_asked.to_string()),
            ]
        });
        let settings =
            settings.into_iter().chain(asked).chain(hidden).chain(model.into_iter().flatten()).chain(voice.settings());
        let seats = (*seats > 0).then(|| (SEATS, seats.to_string()));
        let settings = settings.chain(wizard.settings()).chain(seats);
        let settings = settings.map(|(name, value)| (name.to_owned(), value));
        let names = names.iter().map(|one| (format!("{NAME_OF}{}", one.body), one.name.clone()));
        let settings = settings.chain(names).collect();
        Noted {
            participant: self.participant.clone(),
            settings,
            cameras: plan.cameras.clone(),
            frames: self.frames.clone(),
            audio: self.listening.voice.record_audio,
            branched,
        }
    }

    fn log_path(&self, session: &str) -> anyhow::Result<PathBuf> {
        if let Some(path) = &self.log {
            if path.exists() {
                return Err(bad_input(format!("{}: exists already; choose another `--log`", path.display())));
            }
            check_folder_of(path)?;
            return Ok(path.clone());
        }
        Ok(sessions::folder(None)?.join(format!("{}_{session}.mcap", sessions::time())))
    }
}

/// How many bodies a session has.
fn bodies(plan: &SessionPlan) -> usize {
    plan.mission.robots.len().max(1) + plan.bodies.len()
}

/// All cameras of a session.
fn cameras(plan: &SessionPlan) -> Vec<CameraPlan> {
    plan.all_cameras(bodies(plan))
}

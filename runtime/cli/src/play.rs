//! `cohabit play`: one session from start to end.

use std::{
    path::PathBuf,
    time::{Instant, SystemTime, UNIX_EPOCH},
};

use cohabit_bus::{Session, SessionError};
use cohabit_cdf::BodyRequest;
use cohabit_engine::CameraPlan;

use crate::{
    doctor::ensure_room,
    failure::bad_input,
    minds::MindRequest,
    mission_file::MissionFile,
    peers::{Listening, Timing},
    rendering::Rendering,
    sessions, stop,
    supervisor::{Role, Supervisor},
};

/// Starts a simulator, an agent, the dialog service and a recorder, and supervises them.
#[derive(clap::Args)]
pub struct Play {
    /// A mission file (CDF), or the name of a built-in mission; making a bowl of cereal, if absent
    mission: Option<String>,
    /// The session's name; one of its own is made up if absent
    #[arg(long)]
    session: Option<String>,
    #[command(flatten)]
    listening: Listening,
    /// The seed of all that is random, where the mission does not fix it; the clock's if absent
    #[arg(long)]
    seed: Option<u64>,
    /// A body beside the mission's own robot: `robot` or `person`, with a room if wanted; as often as needed
    #[arg(long = "body", value_name = "KIND[@ROOM]")]
    bodies: Vec<BodyRequest>,
    /// A mind for a body: `dialog`, `random`, `scripted` or `helper`, with the number of its body if it is not 0, and a
    /// script if it is scripted; as often as there are bodies
    #[arg(long = "agent", value_name = "KIND[@BODY][=FILE]", default_value = "dialog")]
    minds: Vec<MindRequest>,
    /// A camera beside those of the bodies, on the topic `frames/NAME`: KIND is `egocentric`, `panorama`,
    /// `third-person`, `fixed` (x=, y=, z= in metres, yaw=, pitch= in degrees) or `top-down` (span= in metres); all have
    /// size=WxH, rate=, planes=color+depth+normals+ids, and most body= and fov=; as often as needed
    #[arg(long = "camera", value_name = "NAME=KIND[,OPTION=VALUE]")]
    cameras: Vec<CameraPlan>,
    /// The session log to write; one in the user's data folder if absent
    #[arg(long)]
    log: Option<PathBuf>,
    #[command(flatten)]
    rendering: Rendering,
    #[command(flatten)]
    timing: Timing,
}

impl Play {
    /// Plays until the user ends it.
    pub fn run(&self) -> anyhow::Result<()> {
        let began = Instant::now();
        let stop = stop::on_request()?;
        let seed = self.seed.unwrap_or_else(clock_seed);
        let mission = MissionFile::find(self.mission.as_deref())?;
        let plan = mission.plan(seed, &self.bodies)?.with_cameras(self.cameras.clone()).map_err(bad_input)?;
        MindRequest::check(&self.minds, &plan)?;
        self.rendering.check()?;
        for name in Session::wipe_dead() {
            println!("cleaned up after session {name}, which was not ended");
        }
        ensure_room()?;
        let name = self.session.clone().unwrap_or_else(|| format!("play-{}", std::process::id()));
        let session = Session::new(&name).map_err(bad_input)?;
        let log = self.log_path(&name)?;
        let lock = session.supervise().map_err(|error| match error {
            SessionError::Folder { .. } => anyhow::Error::new(error),
            other => bad_input(other),
        })?;
        println!("Playing \"{}\" ({})", plan.mission.goal_text, mission.name);
        let timing = self.timing.with_agents(self.minds.len());
        let sim = Role::sim(self.mission.as_deref(), seed, &self.bodies, &self.cameras, self.rendering, timing);
        let minds = self.minds.iter().map(|agent| Role::agent(agent, seed));
        let peers = [Role::record(&log), Role::dialog(&self.listening)];
        let roles = std::iter::once(sim).chain(peers).chain(minds);
        let played = Supervisor::start(&name, roles, began).and_then(|supervisor| supervisor.run(&stop));
        session.end(lock);
        if log.is_file() {
            println!("Recorded in {0}\nReplay it with: cohabit replay {0}", log.display());
        }
        played
    }

    fn log_path(&self, session: &str) -> anyhow::Result<PathBuf> {
        if let Some(path) = &self.log {
            if path.exists() {
                return Err(bad_input(format!("{}: exists already; choose another `--log`", path.display())));
            }
            return Ok(path.clone());
        }
        Ok(sessions::folder(None)?.join(format!("{}_{session}.mcap", sessions::time())))
    }
}

fn clock_seed() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // What JSON numbers hold exactly.
    u64::from(since.subsec_nanos()) ^ (since.as_secs() << 20) & ((1 << 53) - 1)
}

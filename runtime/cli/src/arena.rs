//! `cohabit sim --arena-port`: a simulator for existing clients, alone in one process.

use std::{
    net::{IpAddr, SocketAddr, TcpListener},
    path::PathBuf,
    sync::Arc,
    thread,
};

use anyhow::Context as _;
use cohabit_arena::{Arena, Settings};
use cohabit_cdf::{BodyRequest, WorldData};
use cohabit_render::MeshLibrary;

use crate::{
    failure::{bad_input, environment},
    mission_file::MissionFile,
    rendering::Rendering,
    sessions, stop,
    terminal::shown,
};

/// Where existing clients are listened to, if they are.
#[derive(clap::Args)]
pub struct ArenaOptions {
    /// Instead of a session: serve existing clients of Alexa Arena on this TCP port (theirs is 5000; 0 takes any that is
    /// free). They launch missions (CDF) and send batches of commands; simulated time goes by only while a batch is
    /// carried out. With MISSION, that one is launched already
    #[arg(long, value_name = "PORT", conflicts_with_all = ["session", "cameras"])]
    arena_port: Option<u16>,
    /// The address that existing clients are listened to on; beyond this machine anybody can command the robot
    #[arg(long, default_value = "127.0.0.1", requires = "arena_port", conflicts_with = "session")]
    listen: IpAddr,
    /// The folder for the log of each game; the user's data folder if absent
    #[arg(long, value_name = "DIR", requires = "arena_port", conflicts_with = "session")]
    logs: Option<PathBuf>,
}

/// What a game is, wherever it comes from.
pub struct Games<'a> {
    /// What is launched first, if anything is.
    pub mission: Option<&'a str>,
    /// The seed of the first game, where its mission leaves it to chance.
    pub seed: u64,
    /// Bodies beside those of the missions.
    pub bodies: &'a [BodyRequest],
    /// What draws.
    pub rendering: Rendering,
    /// What worlds are made of.
    pub world: &'a WorldData,
}

impl ArenaOptions {
    /// The port, if existing clients are to be served.
    pub const fn port(&self) -> Option<u16> {
        self.arena_port
    }

    /// Serves existing clients until the user ends it; prints the address as soon as they can connect.
    pub fn serve(&self, port: u16, games: &Games<'_>) -> anyhow::Result<()> {
        let stop = stop::on_request()?;
        let mission = games.mission.map(|name| MissionFile::find_in(Some(name), games.world)).transpose()?;
        if let Some(mission) = &mission {
            let plan = mission.plan(games.world.catalog(), games.seed, games.bodies).map_err(bad_input)?;
            plan.build().map_err(bad_input)?;
        }
        let listener = self.listener(port)?;
        let logs = sessions::folder(self.logs.as_deref())?;
        let catalog = Arc::clone(games.world.catalog());
        let meshes = Arc::new(MeshLibrary::build(&catalog).context("build the models")?);
        let settings = Settings {
            catalog,
            meshes: Arc::clone(&meshes),
            seed: games.seed,
            bodies: games.bodies.to_vec(),
            name: format!("{}_arena-{}", sessions::time(), std::process::id()),
            logs: logs.clone(),
        };
        let mut arena = Arena::new(settings, games.rendering.start()?).ending_at(Arc::clone(&stop));
        if let Some(MissionFile { name, text }) = &mission {
            arena.launch(name, text);
        }
        let address = listener.local_addr().context("the port")?;
        println!("Listening for clients of Alexa Arena on {address}; ready (Ctrl-C ends it)");
        println!("Each game is recorded in {}", shown(logs.display()));
        thread::scope(|scope| {
            // What was not seen yet is shaded meanwhile, so that no reply waits for it.
            scope.spawn(|| meshes.bake_all(&stop));
            cohabit_arena::serve(&listener, arena, &stop)
        })?;
        Ok(())
    }

    fn listener(&self, port: u16) -> anyhow::Result<TcpListener> {
        let address = SocketAddr::new(self.listen, port);
        let hint = |error| {
            environment(format!(
                "{address}: {error}; choose another `--arena-port` (0 takes any that is free) or `--listen`"
            ))
        };
        TcpListener::bind(address).map_err(hint)
    }
}

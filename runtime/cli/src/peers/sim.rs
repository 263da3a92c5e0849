//! The simulator's process.

use std::{sync::Arc, thread};

use anyhow::Context as _;
use cohabit_cdf::{BodyRequest, WorldData};
use cohabit_engine::{Appearance, BuildError, CameraPlan, SessionPlan, Simulator};
use cohabit_render::MeshLibrary;
use cohabit_world::World;

use super::{Joining, Timing};
use crate::{
    arena::{ArenaOptions, Games},
    branch::{BranchPoint, Branched},
    failure::bad_input,
    mission_file::MissionFile,
    rendering::Rendering,
    sessions,
    world::WorldPacks,
};

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
    /// The seed of all that is random, where the mission does not fix it; 0 if absent. With --arena-port it is that of the first
    /// game, the clock's if absent, and each next game has the one after it
    #[arg(long)]
    seed: Option<u64>,
    /// A body beside the mission's own robot: `robot` or `person`, with a room if wanted; as often as needed
    #[arg(long = "body", value_name = "KIND[@ROOM]")]
    bodies: Vec<BodyRequest>,
    /// Go on from a point of a recorded session instead, LOG@TIME
    #[arg(long, value_name = "LOG@TIME", conflicts_with_all = ["mission", "seed", "bodies", "arena_port"])]
    branch: Option<BranchPoint>,
    /// A camera beside those of the bodies, on the topic `frames/NAME`: KIND is `egocentric`, `panorama`,
    /// `third-person`, `fixed` (x=, y=, z= in metres, yaw=, pitch= in degrees) or `top-down` (span= in metres); all have
    /// size=WxH, rate=, planes=color+depth+normals+ids, smooth=yes or no (smooth edges and outlines, for people; in lock-step
    /// only those with smooth=no belong to the turns of agents), and most body= and fov=; as often as needed
    #[arg(long = "camera", value_name = "NAME=KIND[,OPTION=VALUE]")]
    cameras: Vec<CameraPlan>,
    #[command(flatten)]
    packs: WorldPacks,
    #[command(flatten)]
    rendering: Rendering,
    #[command(flatten)]
    timing: Timing,
}

impl Sim {
    /// Runs the simulator.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        if let Some(port) = self.arena.port() {
            let (mission, rendering) = (self.mission.as_deref(), self.rendering);
            let seed = self.seed.unwrap_or_else(sessions::clock_seed);
            let games = Games { mission, seed, bodies: &self.bodies, rendering, world: &world };
            return self.arena.serve(port, &games);
        }
        let (plan, before) = self.plan(&world)?;
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

    /// What is simulated, and the world that it goes on from if that is not the mission's.
    fn plan(&self, world: &WorldData) -> anyhow::Result<(SessionPlan, Option<(World, Appearance)>)> {
        match &self.branch {
            Some(point) => {
                let Branched { plan, world, appearance, .. } = point.open(world.catalog())?;
                Ok((plan, Some((world, appearance))))
            }
            None => {
                let file = MissionFile::find_in(self.mission.as_deref(), world)?;
                Ok((file.plan(world.catalog(), self.seed.unwrap_or_default(), &self.bodies).map_err(bad_input)?, None))
            }
        }
    }
}

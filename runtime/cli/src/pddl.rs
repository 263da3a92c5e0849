//! `cohabit pddl`: a mission for other planners, and their plans back into the world.

use std::{
    fs,
    path::{Path, PathBuf},
};

use cohabit_cdf::BodyId;
use cohabit_engine::SessionPlan;
use cohabit_generate::{Accepted, check_plan};
use cohabit_planner::{
    Limits,
    pddl::{self, Pddl},
};
use cohabit_world::World;

use crate::{
    failure::{bad_input, environment},
    mission_file::MissionFile,
    terminal::shown,
    world::WorldPacks,
};

/// The body that plans are for.
const BODY: BodyId = BodyId(0);
/// What the search for a plan of our own may take.
const LIMITS: Limits = Limits::of_states(20_000);

/// Writes a mission as a planning problem (PDDL), or checks a plan for it against the world.
///
/// The domain is that of one mission: its actions are the table's, on the things that matter for its goals. Plans that Fast
/// Downward or another planner finds for it, or that people write, are carried out in the world with `--plan`.
#[derive(clap::Args)]
pub struct PddlFiles {
    /// A mission file (CDF), or the name of a built-in mission
    mission: String,
    /// Write `domain.pddl`, `problem.pddl` and, as `plan`, the plan of the built-in planner into this folder
    #[arg(long, value_name = "DIR", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// Check this plan: one action a line, as planners write them, or such as `(pick_up bowl_01_1)`
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// The seed of all that is random, where the mission does not fix it: a plan is for the world of one seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    packs: WorldPacks,
}

impl PddlFiles {
    /// Writes the files, or checks the plan; both, if both are asked for.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let file = MissionFile::find_in(Some(&self.mission), &world)?;
        let plan = file.plan(world.catalog(), self.seed, &[]).map_err(bad_input)?;
        let mut world = plan.build().map_err(bad_input)?;
        // What is met as the mission begins is met before anybody plans.
        world.step(&[]);
        if let Some(folder) = &self.out {
            write(&plan, &world, folder)?;
        }
        match &self.plan {
            Some(file) => check(&mut world, file),
            None => Ok(()),
        }
    }
}

fn write(plan: &SessionPlan, world: &World, folder: &Path) -> anyhow::Result<()> {
    let met: Vec<bool> = world.goals().iter().map(|goal| goal.met).collect();
    let Pddl { domain, problem, plan: found } =
        pddl::export(&plan.mission.name, &world.symbols(BODY), world.mission(), &met, &LIMITS);
    let failed = |path: &Path, error: std::io::Error| environment(format!("{}: {error}", path.display()));
    fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|error| failed(&path, error))?;
        println!("{}", shown(path.display()));
        Ok::<(), anyhow::Error>(())
    };
    write("domain.pddl", &domain)?;
    write("problem.pddl", &problem)?;
    match found {
        Ok(text) => write("plan", &text),
        Err(error) => {
            println!("no plan: {}", shown(error));
            Ok(())
        }
    }
}

fn check(world: &mut World, file: &Path) -> anyhow::Result<()> {
    let name = file.display();
    let text = fs::read_to_string(file).map_err(|error| bad_input(format!("{name}: {error}")))?;
    let plan = pddl::read_plan(&text).map_err(|error| bad_input(format!("{name}: {error}")))?;
    let accepted = check_plan(world, &plan).map_err(|error| bad_input(format!("{name}: {error}")))?;
    let Accepted { actions, ticks } = accepted;
    println!("the world accepts the plan: {actions} actions, walks among them, met all goals by tick {ticks}");
    Ok(())
}

//! `cohabit generate-world`: floor plans made at random, as a world pack.

use std::{path::PathBuf, time::Instant};

use cohabit_floorplans::{FloorPlan, FloorPlans, Kind, PlanError, pack};
use cohabit_generate::side_by_side;
use indicatif::{ProgressBar, ProgressStyle};

use crate::{failure::bad_input, pack_folder, terminal::shown};

/// Makes floor plans at random, furnished, and writes them as a world pack, which `play`, `check`, `generate`, `eval` and all other
/// commands with `--world` take. Homes have rooms and classes of the world pack `homes`, which comes with the program: they take
/// `--world homes` before it. Each plan is checked as `check` does it.
#[derive(clap::Args)]
pub struct GenerateWorld {
    /// What the plans are of: `office` or `home`
    #[arg(long, value_name = "KIND")]
    kind: Kind,
    /// How many rooms each plan has, from 1 to 12, without the hallway that plans of four rooms or more have
    #[arg(long, value_name = "N", default_value_t = 6)]
    rooms: usize,
    /// How many floor plans to make, at most 990
    #[arg(long, value_name = "N", default_value_t = 10)]
    count: usize,
    /// The seed: the same one makes the same floor plans, however many there are
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The folder of the world pack, which is made
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
    /// The name of the world pack; that of its folder, if not given
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Threads; one for each core if not given. They do not change what is made
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
}

impl GenerateWorld {
    /// Makes all of them, then writes the pack.
    pub fn run(&self) -> anyhow::Result<()> {
        let name = pack_folder::name(&self.out, self.name.as_deref());
        pack::check(&name, self.count).map_err(|error| self.refused(&error))?;
        pack_folder::check_is_new(&self.out)?;
        let plans = FloorPlans::new(self.kind, self.rooms, self.seed).map_err(bad_input)?;
        let began = Instant::now();
        let made = self.make(&plans).map_err(bad_input)?;
        pack_folder::write(&self.out, &pack::files(&name, &plans, &made))?;
        let (seconds, folder) = (began.elapsed().as_secs_f64(), shown(self.out.display()));
        println!("{} floor plans in {seconds:.1} s: {folder}", made.len());
        let needed = self.kind.pack().map_or_else(String::new, |pack| format!("--world {pack} "));
        println!("Check them with: cohabit check {needed}--world {folder}");
        println!("Look around in the first: cohabit play look_around_{name} {needed}--world {folder}");
        Ok(())
    }

    fn refused(&self, error: &PlanError) -> anyhow::Error {
        match (error, &self.name) {
            // The name is that of a folder, which may be called as it is.
            (PlanError::Name { .. } | PlanError::Taken { .. }, None) => {
                bad_input(format!("{error}; or give a name by --name"))
            }
            _ => bad_input(error),
        }
    }

    fn make(&self, plans: &FloorPlans) -> Result<Vec<FloorPlan>, PlanError> {
        let workers = self.workers.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let mut workers = vec![(); workers.clamp(1, self.count)];
        let bar = ProgressBar::new(self.count as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} made, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let made = side_by_side(&mut workers, 0..self.count, |(), number| {
            bar.inc(1);
            plans.plan(number as u64)
        });
        bar.finish_and_clear();
        made
    }
}

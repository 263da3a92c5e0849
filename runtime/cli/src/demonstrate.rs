//! `cohabit demonstrate`: data sets of what the expert does.

use std::{path::PathBuf, str::FromStr, sync::Arc};

use cohabit_bus::message::Plane;
use cohabit_demonstrate::{DemonstrateError, MissionText, Recipe, demonstrate};
use cohabit_eval::read_missions;
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    failure::{bad_input, environment},
    terminal::{shown, shown_lines},
    world::WorldPacks,
};

/// Missions left out that are printed at most; the manifest has all.
const MOST_PRINTED: usize = 30;

/// Has the expert play missions, and writes a data set: of each step the state before it, the action, instructions, questions with
/// answers, what came of it, and what the robot sees. A call that was interrupted goes on when it is made again.
#[derive(clap::Args)]
pub struct Demonstrate {
    /// A .jsonl of missions, a mission (CDF), or a folder of missions
    missions: PathBuf,
    /// The folder of the data set
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Only missions whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Where missions leave it to chance
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Pixels across and down of what the robot sees
    #[arg(long, value_name = "WxH", default_value = "300x300")]
    size: Size,
    /// What is drawn: some of color, depth, normals and ids, with commas between; or `none`
    #[arg(long, value_name = "LIST", default_value = "color,depth,normals,ids")]
    modalities: Modalities,
    /// No questions about instructions, and no answers
    #[arg(long)]
    no_questions: bool,
    /// Missions that are played side by side; one for each core if not given. They do not change what is made
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    #[command(flatten)]
    packs: WorldPacks,
}

/// Pixels across and down: `300x300`.
#[derive(Clone, Copy)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
        sides.map(Self).ok_or_else(|| "two numbers with an x, such as 300x300".to_owned())
    }
}

/// `color,depth`.
#[derive(Clone)]
struct Modalities(Vec<Plane>);

impl FromStr for Modalities {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "none" {
            return Ok(Self(Vec::new()));
        }
        let named = |name: &str| Plane::ALL.into_iter().find(|plane| plane.name() == name.trim());
        let known = || Plane::ALL.map(Plane::name).join(", ");
        let plane = |name: &str| named(name).ok_or_else(|| format!("there is no `{name}`: {}", known()));
        text.split(',').map(plane).collect::<Result<Vec<Plane>, String>>().map(Self)
    }
}

impl Demonstrate {
    /// Makes the data set, or goes on with it.
    pub fn run(&self) -> anyhow::Result<()> {
        let missions = self.missions()?;
        let world = self.packs.read()?;
        let recipe = Recipe::new(self.seed, self.size.0, &self.modalities.0).map_err(bad_input)?;
        let recipe = recipe.in_world(Arc::clone(world.catalog()));
        let recipe = if self.no_questions { recipe.without_questions() } else { recipe };
        let workers = self.workers.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let bar = ProgressBar::new(missions.len() as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} played, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let made = demonstrate(&missions, &self.out, &recipe, workers, &|| bar.inc(1));
        bar.finish_and_clear();
        let summary = made.map_err(|error| match error {
            DemonstrateError::OtherRecipe { .. } => bad_input(error),
            error => environment(error),
        })?;
        for (id, reason) in summary.left_out.iter().take(MOST_PRINTED) {
            println!("left out: {}: {}", shown(id), shown_lines(reason));
        }
        if summary.left_out.len() > MOST_PRINTED {
            println!("... and {} more; the manifest has them all", summary.left_out.len() - MOST_PRINTED);
        }
        println!(
            "{} episodes with {} steps, {} questions and {} frames: {}",
            summary.episodes,
            summary.steps,
            summary.questions,
            summary.frames,
            shown(self.out.display())
        );
        Ok(())
    }

    fn missions(&self) -> anyhow::Result<Vec<MissionText>> {
        let only = self.only.as_deref().unwrap_or_default();
        let tasks = read_missions(&self.missions).map_err(bad_input)?.into_iter();
        let missions: Vec<MissionText> = tasks
            .filter(|task| task.id.contains(only))
            .map(|task| MissionText { id: task.id, cdf: task.cdf })
            .collect();
        if missions.is_empty() {
            return Err(bad_input(format!("{}: no mission's name contains `{only}`", self.missions.display())));
        }
        Ok(missions)
    }
}

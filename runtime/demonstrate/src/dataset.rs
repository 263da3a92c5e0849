//! A data set in a folder: one episode after the other, each whole or not there.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_cdf::Catalog;
use cohabit_engine::SessionPlan;
use cohabit_generate::side_by_side;
use cohabit_render::MeshLibrary;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::{
    card,
    episode::{self, Played, Totals},
    error::{DemonstrateError, at},
    recipe::{FORMAT, MissionText, Recipe},
    summary::Summary,
};

/// One episode, as the manifest has it.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
struct EpisodeEntry {
    id: String,
    /// Its folder.
    folder: String,
    floor_plan: String,
    /// What people read of the mission.
    goal_text: String,
    /// What people read of its goals, by their numbers.
    goals: Vec<(i64, String)>,
    seed: u64,
    steps: usize,
    failed_steps: usize,
    questions: usize,
    frames: usize,
    ticks: u64,
    /// The digest of the world in the end.
    digest: String,
}

/// A mission that is no episode.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct LeftOut {
    id: String,
    reason: String,
}

/// Makes a data set of missions in a folder, or goes on with one that was interrupted; `done` is told whenever a mission was
/// played.
///
/// # Errors
/// [`DemonstrateError`]. Whole episodes stay; the same call goes on from there.
pub fn demonstrate(
    missions: &[MissionText],
    folder: &Path,
    recipe: &Recipe,
    workers: usize,
    done: &(dyn Fn() + Sync),
) -> Result<Summary, DemonstrateError> {
    begin(missions, folder, recipe)?;
    let catalog = Arc::clone(recipe.catalog());
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    let maker = Maker { folder, recipe, catalog, meshes };
    let results = maker.all(missions, workers, done)?;
    let (mut episodes, mut left_out) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(episode) => episodes.push(episode),
            Err(left) => left_out.push(left),
        }
    }
    let mut summary = Summary {
        episodes: episodes.len(),
        steps: episodes.iter().map(|episode| episode.steps).sum(),
        questions: episodes.iter().map(|episode| episode.questions).sum(),
        frames: episodes.iter().map(|episode| episode.frames).sum(),
        left_out: Vec::new(),
    };
    let counts = card::Counts { missions: missions.len(), left_out: left_out.len(), summary: &summary };
    finish(folder, &card::text(recipe, counts), &episodes, &left_out)?;
    summary.left_out = left_out.into_iter().map(|left| (left.id, left.reason)).collect();
    Ok(summary)
}

/// Writes the recipe, or checks that it is the one that the folder was begun with.
fn begin(missions: &[MissionText], folder: &Path, recipe: &Recipe) -> Result<(), DemonstrateError> {
    let (path, text) = (folder.join("recipe.json"), recipe.text(missions));
    fs::create_dir_all(folder.join("episodes")).map_err(at(folder))?;
    if path.exists() {
        let known = fs::read_to_string(&path).map_err(at(&path))?;
        return if known == text { Ok(()) } else { Err(DemonstrateError::OtherRecipe { path }) };
    }
    fs::write(&path, text).map_err(at(&path))
}

/// Writes the card and, last, the manifest. A set that is whole already stays as it is: its card may say more by now, such as what people
/// wrote about it.
fn finish(folder: &Path, text: &str, episodes: &[EpisodeEntry], left_out: &[LeftOut]) -> Result<(), DemonstrateError> {
    let manifest = json!({
        "format": FORMAT,
        "program": env!("CARGO_PKG_VERSION"),
        "episodes": episodes,
        "left_out": left_out,
    });
    let manifest = format!("{manifest:#}\n");
    let is_whole = fs::read_to_string(folder.join("manifest.json")).is_ok_and(|known| known == manifest);
    if is_whole && folder.join("README.md").is_file() {
        return Ok(());
    }
    write_whole(folder, "README.md", text)?;
    write_whole(folder, "manifest.json", &manifest)
}

/// Writes a file that appears once it is whole.
///
/// # Errors
/// [`DemonstrateError::File`].
pub fn write_whole(folder: &Path, name: &str, text: &str) -> Result<(), DemonstrateError> {
    let (part, whole) = (folder.join(format!("{name}.part")), folder.join(name));
    fs::write(&part, text).map_err(at(&part))?;
    fs::rename(&part, &whole).map_err(at(&whole))
}

struct Maker<'a> {
    folder: &'a Path,
    recipe: &'a Recipe,
    catalog: Arc<Catalog>,
    meshes: Arc<MeshLibrary>,
}

/// An episode, or why there is none.
type Made = Result<EpisodeEntry, LeftOut>;

impl Maker<'_> {
    /// All episodes in the order of the missions; workers take one after the other. The first error ends it.
    fn all(
        &self,
        missions: &[MissionText],
        workers: usize,
        done: &(dyn Fn() + Sync),
    ) -> Result<Vec<Made>, DemonstrateError> {
        let mut workers = vec![(); workers.clamp(1, missions.len().max(1))];
        side_by_side(&mut workers, 0..missions.len(), |(), number| {
            let made = self.one(number, &missions[number]);
            done();
            made
        })
    }

    /// The episode of a mission: the one that is there, or a new one.
    fn one(&self, number: usize, mission: &MissionText) -> Result<Made, DemonstrateError> {
        let name = format!("episodes/{number:06}");
        let (whole, part) = (self.folder.join(&name), self.folder.join(format!("{name}.part")));
        if whole.exists() {
            return read(&whole.join("episode.json")).map(Ok);
        }
        let left_out = |reason: String| Ok(Err(LeftOut { id: mission.id.clone(), reason }));
        let built = SessionPlan::new(&mission.id, &mission.cdf, Arc::clone(&self.catalog), self.recipe.seed())
            .and_then(|plan| plan.build().map(|world| (plan, world)));
        let (plan, world) = match built {
            Ok(built) => built,
            Err(error) => return left_out(format!("it cannot be played: {error}")),
        };
        remove(&part)?;
        fs::create_dir(&part).map_err(at(&part))?;
        match episode::play(number as u64, &plan, world, &self.meshes, self.recipe, &part)? {
            Played::Solved(totals) => {
                let entry = entry(mission, name, &plan, &totals);
                write(&part.join("episode.json"), &entry)?;
                let cdf = part.join("mission.json");
                fs::write(&cdf, &mission.cdf).map_err(at(&cdf))?;
                fs::rename(&part, &whole).map_err(at(&whole))?;
                Ok(Ok(entry))
            }
            Played::Unsolved(reason) => {
                remove(&part)?;
                left_out(reason)
            }
        }
    }
}

fn entry(mission: &MissionText, folder: String, plan: &SessionPlan, totals: &Totals) -> EpisodeEntry {
    let goals = plan.mission.goals.iter().map(|goal| (goal.id, goal.description.clone()));
    EpisodeEntry {
        id: mission.id.clone(),
        folder,
        floor_plan: plan.layout.id.clone(),
        goal_text: plan.mission.goal_text.clone(),
        goals: goals.collect(),
        seed: plan.seed,
        steps: totals.steps,
        failed_steps: totals.failed,
        questions: totals.questions,
        frames: totals.frames,
        ticks: totals.ticks,
        digest: totals.digest.iter().map(|byte| format!("{byte:02x}")).collect(),
    }
}

fn read(path: &Path) -> Result<EpisodeEntry, DemonstrateError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|error| DemonstrateError::Damaged {
        path: path.parent().map_or_else(PathBuf::new, Path::to_owned),
        reason: error.to_string(),
    })
}

fn write(path: &Path, entry: &EpisodeEntry) -> Result<(), DemonstrateError> {
    let text = serde_json::to_string_pretty(entry).map_err(|error| at(path)(error.into()))?;
    fs::write(path, format!("{text}\n")).map_err(at(path))
}

/// Removes what an interrupted worker has left.
fn remove(folder: &Path) -> Result<(), DemonstrateError> {
    if folder.exists() { fs::remove_dir_all(folder).map_err(at(folder)) } else { Ok(()) }
}

//! A data set as `cohabit demonstrate` writes it, read. Its card (`README.md`) says what each field is.

use std::{
    collections::BTreeMap,
    fs,
    path::{Component, Path, PathBuf},
};

use cohabit_cdf::{PackId, Status};
use serde::{Deserialize, de::DeserializeOwned};

use crate::error::{ConvertError, at};

/// The format that is read, with its version.
const FORMAT: &str = "cohabit demonstrations 3";

/// A finished data set.
#[derive(Debug)]
pub struct Dataset {
    /// Where it is.
    pub folder: PathBuf,
    /// What it follows from.
    pub recipe: Recipe,
    /// Its episodes, in the order of the manifest.
    pub episodes: Vec<Episode>,
    /// How many missions are no episodes.
    pub left_out: usize,
}

/// What it follows from.
#[derive(Debug, Deserialize)]
pub struct Recipe {
    /// The version of the program that made it.
    pub program: String,
    /// The seed.
    pub seed: u64,
    /// Width and height of pictures, in pixels.
    pub size: [u32; 2],
    /// The names of what its pictures show.
    pub modalities: Vec<String>,
    /// How many missions it was made of.
    pub missions: usize,
    /// The digest of the missions, in hexadecimal.
    pub missions_blake3: String,
    /// The world packs that they are played with, in their order.
    #[serde(default)]
    pub world: Vec<PackId>,
}

#[derive(Debug, Deserialize)]
struct Manifest {
    format: String,
    episodes: Vec<Episode>,
    left_out: Vec<serde_json::Value>,
}

/// An episode, as the manifest has it.
#[derive(Debug, Deserialize)]
pub struct Episode {
    /// The name of its mission.
    pub id: String,
    /// Its folder, in that of the data set.
    pub folder: String,
    /// The name of its floor plan.
    pub floor_plan: String,
    /// How many steps it has.
    pub steps: usize,
}

/// A line of an episode: as it stands there, and what it says.
#[derive(Debug)]
pub struct Line {
    /// As it stands in the file, without the end of the line.
    pub text: String,
    /// What is read of it.
    pub step: Step,
}

/// What is read of a line; the last one of an episode has no action.
#[derive(Debug, Deserialize)]
pub struct Step {
    /// The tick at which it begins, 60 a second.
    pub tick: u64,
    /// What is done; none in the last line.
    pub action: Option<Action>,
    /// What people would say for it, by style.
    #[serde(default)]
    pub instructions: BTreeMap<String, String>,
    /// What somebody who is told so would ask, with the answers.
    #[serde(default)]
    pub questions: Vec<Question>,
    /// What came of it.
    pub outcome: Option<Outcome>,
    /// Where the robot is before it.
    pub pose: Option<Pose>,
    /// Whether each goal is met before it, by the goal's number.
    #[serde(default)]
    pub goals: BTreeMap<String, bool>,
    /// The file of each modality, in the folder of the episode.
    #[serde(default)]
    pub frames: BTreeMap<String, String>,
    /// What is in its pictures.
    #[serde(default)]
    pub seen: Vec<Seen>,
}

/// What is done in a step.
#[derive(Debug, Deserialize)]
pub struct Action {
    /// The name of its kind, such as `pick_up`.
    pub kind: String,
    /// The instance id of its object.
    pub object: String,
    /// The class of its object.
    pub class: String,
    /// The id of the object in pictures.
    pub id: u32,
    /// Whether its object is in the pictures.
    pub is_seen: bool,
}

/// A question about the instructions, and its answer.
#[derive(Debug, Deserialize)]
pub struct Question {
    /// What is asked.
    pub question: String,
    /// What is answered.
    pub answer: String,
}

/// What came of a step.
#[derive(Debug, Deserialize)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
}

/// Where the robot is.
#[derive(Debug, Deserialize)]
pub struct Pose {
    /// Its place in the world, in metres: east, north, up.
    pub position_m: [f32; 3],
    /// Counter-clockwise seen from above, zero to the east.
    pub yaw_rad: f32,
    /// Positive upwards.
    pub head_pitch_rad: f32,
    /// The id of its room.
    pub room: String,
    /// The instance id of what it has in its hand.
    pub held: Option<String>,
}

/// A thing in the pictures of a step.
#[derive(Debug, Deserialize)]
pub struct Seen {
    /// Its id in the pictures.
    pub id: u32,
    /// Its colour in the picture of ids: red, green, blue.
    pub color: [u8; 3],
    /// Its first column and row, and those after its last.
    pub r#box: [u16; 4],
}

impl Step {
    /// Whether it has an action that did what it was to do.
    #[must_use]
    pub fn has_succeeded(&self) -> bool {
        self.outcome.as_ref().is_some_and(|outcome| outcome.status.is_success())
    }

    /// What people would say for it, without more words than needed; empty where there is no action.
    #[must_use]
    pub fn instruction(&self) -> &str {
        self.instructions.get("plain").map_or("", String::as_str)
    }

    /// Its object in its pictures, if it is seen.
    #[must_use]
    pub fn target(&self) -> Option<&Seen> {
        let action = self.action.as_ref().filter(|action| action.is_seen)?;
        self.seen.iter().find(|seen| seen.id == action.id)
    }
}

impl Dataset {
    /// Opens the data set in a folder.
    ///
    /// # Errors
    /// [`ConvertError::NoDataset`], also where it is not finished.
    pub fn open(folder: &Path) -> Result<Self, ConvertError> {
        let unfinished = |reason: String| ConvertError::NoDataset { path: folder.to_owned(), reason };
        if !folder.join("manifest.json").is_file() {
            return Err(unfinished("it has no manifest.json, which is written last; call that again".to_owned()));
        }
        let manifest: Manifest = json(&folder.join("manifest.json")).map_err(|error| unfinished(error.to_string()))?;
        if manifest.format != FORMAT {
            return Err(unfinished(format!(
                "its format is `{}`, this reads `{FORMAT}`; make it anew",
                manifest.format
            )));
        }
        let recipe = json(&folder.join("recipe.json")).map_err(|error| unfinished(error.to_string()))?;
        if let Some(episode) = manifest.episodes.iter().find(|episode| !is_inside(&episode.folder)) {
            return Err(unfinished(format!("`{}` is no folder inside it", episode.folder)));
        }
        let left_out = manifest.left_out.len();
        Ok(Self { folder: folder.to_owned(), recipe, episodes: manifest.episodes, left_out })
    }

    /// A file of an episode.
    #[must_use]
    pub fn path(&self, episode: &Episode, name: &str) -> PathBuf {
        self.folder.join(&episode.folder).join(name)
    }

    /// The text of a file of an episode.
    ///
    /// # Errors
    /// [`ConvertError::File`].
    pub fn text(&self, episode: &Episode, name: &str) -> Result<String, ConvertError> {
        let path = self.path(episode, name);
        fs::read_to_string(&path).map_err(at(&path))
    }

    /// The lines of an episode: one for each step, and the last one.
    ///
    /// # Errors
    /// [`ConvertError`], also where the episode is not whole.
    pub fn lines(&self, episode: &Episode) -> Result<Vec<Line>, ConvertError> {
        let path = self.path(episode, "steps.jsonl");
        let text = fs::read_to_string(&path).map_err(at(&path))?;
        let lines: Vec<Line> = (1..)
            .zip(text.lines())
            .map(|(number, line)| {
                let wrong = |reason| ConvertError::Line { path: path.clone(), line: number, reason };
                let step: Step = serde_json::from_str(line).map_err(|error| wrong(error.to_string()))?;
                if step.action.is_some() != (number <= episode.steps) {
                    return Err(wrong(format!(
                        "all of its {} steps have actions, and the last line has none",
                        episode.steps
                    )));
                }
                Ok(Line { text: line.to_owned(), step })
            })
            .collect::<Result<_, _>>()?;
        if lines.len() == episode.steps + 1 {
            Ok(lines)
        } else {
            let reason = format!("it has {} lines instead of {}", lines.len(), episode.steps + 1);
            Err(ConvertError::Damaged { path, reason })
        }
    }

    /// The bytes of a step's picture (PNG), and its name in the folder of the episode.
    ///
    /// # Errors
    /// [`ConvertError`], also where there is none of that modality.
    pub fn picture<'a>(
        &self,
        episode: &Episode,
        step: &'a Step,
        modality: &str,
    ) -> Result<(&'a str, Vec<u8>), ConvertError> {
        let damaged = |reason: String| ConvertError::Damaged { path: self.path(episode, "steps.jsonl"), reason };
        let name = step.frames.get(modality).ok_or_else(|| damaged(format!("tick {}: no `{modality}`", step.tick)))?;
        if !is_inside(name) {
            return Err(damaged(format!("`{name}` is no file inside the episode")));
        }
        let path = self.path(episode, name);
        Ok((name.as_str(), fs::read(&path).map_err(at(&path))?))
    }
}

/// Whether a path leads nowhere else than into the folder that it starts from.
#[must_use]
pub fn is_inside(path: &str) -> bool {
    !path.is_empty() && Path::new(path).components().all(|part| matches!(part, Component::Normal(_)))
}

fn json<T: DeserializeOwned>(path: &Path) -> Result<T, ConvertError> {
    let text = fs::read_to_string(path).map_err(at(path))?;
    serde_json::from_str(&text).map_err(|error| at(path)(error.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_inside() {
        for (path, expected) in
            [("frames/0000-color.png", true), ("", false), ("../x", false), ("/etc/x", false), ("a/../b", false)]
        {
            assert_eq!(is_inside(path), expected, "{path}");
        }
    }
}

//! What is watched: the pictures of episodes, and where episodes are cut.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use cohabit_convert::native::{Dataset, Step, is_inside};

use crate::{
    error::{AnnotateError, at},
    task::Segment,
};

/// The pictures that are shown.
const MODALITY: &str = "color";

/// What people watch in one go.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Cut {
    /// From one goal that is met to the next.
    #[default]
    Goals,
    /// A whole episode.
    Episodes,
}

/// The episodes of a data set, as they are watched.
#[derive(Debug)]
pub struct Films {
    folder: PathBuf,
    films: Vec<Film>,
}

/// An episode.
#[derive(Debug)]
struct Film {
    /// Its folder, in that of the data set.
    folder: String,
    /// The picture before each step, and that of the end: files in its folder.
    pictures: Vec<String>,
    /// The steps before which a goal was just met, and the end.
    cuts: Vec<usize>,
}

impl Films {
    /// Reads a data set of `cohabit demonstrate`.
    ///
    /// # Errors
    /// [`AnnotateError::Dataset`], also for an episode that is not whole, and [`AnnotateError::Unfit`] for one without pictures.
    pub fn open(folder: &Path) -> Result<Self, AnnotateError> {
        let dataset = Dataset::open(folder)?;
        let unfit = |reason: String| AnnotateError::Unfit { path: folder.to_owned(), reason };
        if !dataset.recipe.modalities.iter().any(|modality| modality == MODALITY) {
            return Err(unfit(format!(
                "people watch pictures in colour, and it has none; make it anew with `--modalities {MODALITY}`"
            )));
        }
        if dataset.episodes.is_empty() {
            return Err(unfit("it has no episodes to watch; its manifest.json says why".to_owned()));
        }
        let mut films = Vec::with_capacity(dataset.episodes.len());
        for episode in &dataset.episodes {
            let lines = dataset.lines(episode)?;
            let steps: Vec<&Step> = lines.iter().map(|line| &line.step).collect();
            let pictures = pictures(&steps).map_err(|step| AnnotateError::Damaged {
                path: dataset.path(episode, "steps.jsonl"),
                reason: format!(
                    "step {step} has no picture in colour; remove the episode's folder, and `cohabit demonstrate` makes it anew"
                ),
            })?;
            films.push(Film { folder: episode.folder.clone(), pictures, cuts: cuts(&steps) });
        }
        Ok(Self { folder: folder.to_owned(), films })
    }

    /// All that is to be watched.
    #[must_use]
    pub fn segments(&self, cut: Cut) -> BTreeSet<Segment> {
        self.films.iter().flat_map(|film| film.segments(cut)).collect()
    }

    /// The number of a segment's episode, if the data set has it with all of the segment's steps.
    #[must_use]
    pub fn number(&self, segment: &Segment) -> Option<usize> {
        let number = self.films.iter().position(|film| film.folder == segment.episode)?;
        (segment.first_step < segment.end_step && segment.end_step < self.films[number].pictures.len())
            .then_some(number)
    }

    /// The picture before a step of the episode of that number, if there is one. The one behind the last step is that of the end.
    #[must_use]
    pub fn picture_path(&self, episode: usize, step: usize) -> Option<PathBuf> {
        let film = self.films.get(episode)?;
        Some(self.folder.join(&film.folder).join(film.pictures.get(step)?))
    }

    /// The bytes of a picture (PNG).
    ///
    /// # Errors
    /// [`AnnotateError::File`].
    pub fn read(path: &Path) -> Result<Vec<u8>, AnnotateError> {
        fs::read(path).map_err(at(path))
    }
}

impl Film {
    fn segments(&self, cut: Cut) -> Vec<Segment> {
        let segment = |first_step, end_step| Segment { episode: self.folder.clone(), first_step, end_step };
        match cut {
            Cut::Goals => {
                let begins = std::iter::once(0).chain(self.cuts.iter().copied());
                begins.zip(&self.cuts).map(|(begin, end)| segment(begin, *end)).collect()
            }
            Cut::Episodes => self.cuts.last().map(|end| segment(0, *end)).into_iter().collect(),
        }
    }
}

/// The picture of each line, or the first step that has none.
fn pictures(steps: &[&Step]) -> Result<Vec<String>, usize> {
    let picture = |(number, step): (usize, &&Step)| {
        step.frames.get(MODALITY).filter(|name| is_inside(name)).cloned().ok_or(number)
    };
    steps.iter().enumerate().map(picture).collect()
}

/// The lines at which a goal is met that was not so before, and the last one; the first line is no cut.
fn cuts(steps: &[&Step]) -> Vec<usize> {
    let last = steps.len().saturating_sub(1);
    let is_cut = |number: usize| {
        let was_met = |goal: &String| steps[number - 1].goals.get(goal).copied().unwrap_or_default();
        steps[number].goals.iter().any(|(goal, is_met)| *is_met && !was_met(goal))
    };
    (1..=last).filter(|number| *number == last || is_cut(*number)).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde_json::json;

    use super::*;

    /// The lines of an episode with two goals: whether each is met before each step.
    fn steps(met: &[[bool; 2]]) -> Vec<Step> {
        let step = |[first, second]: &[bool; 2]| {
            let goals = json!({ "0": first, "1": second });
            serde_json::from_value(json!({ "tick": 0, "action": null, "outcome": null, "pose": null, "goals": goals }))
        };
        met.iter().map(|met| step(met).unwrap()).collect()
    }

    #[test]
    fn an_episode_is_cut_where_a_goal_is_met() {
        let (no, one, both) = ([false, false], [true, false], [true, true]);
        for (met, expected) in [
            (vec![no, no, one, one, both], vec![2, 4]),
            (vec![no, no, both], vec![2]),
            // A goal that is lost is met again; the last line is a cut in any case.
            (vec![one, no, one, both, both], vec![2, 3, 4]),
            (vec![no], vec![]),
        ] {
            let steps = steps(&met);
            assert_eq!(cuts(&steps.iter().collect::<Vec<_>>()), expected, "{met:?}");
        }
    }

    #[test]
    fn segments_lie_one_behind_the_other() {
        let film = Film { folder: "e".to_owned(), pictures: Vec::new(), cuts: vec![2, 5] };
        let ends = |cut| -> Vec<_> { film.segments(cut).iter().map(|one| (one.first_step, one.end_step)).collect() };
        assert_eq!(ends(Cut::Goals), [(0, 2), (2, 5)]);
        assert_eq!(ends(Cut::Episodes), [(0, 5)]);
    }
}

//! The frames of an episode as columns: a frame for each step, and one for the end, whose action is to stop.

use std::collections::BTreeMap;

use cohabit_parquet::{Column, Picture, Values};

use super::{features, stats::Stats, vectors};
use crate::{
    error::ConvertError,
    native::{Dataset, Episode, Line},
    picture,
};

/// Frames a second: steps take as long as they take, and LeRobot counts them evenly.
pub(crate) const FRAMES_PER_SECOND: u32 = 1;
/// Of so many frames one is decoded for the statistics of pictures, besides the first of each episode.
pub(crate) const PICTURES_SAMPLED: usize = 10;

/// Where an episode stands among all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub episode: i64,
    /// The index of its first frame.
    pub first: i64,
    pub task: i64,
}

/// The columns of an episode's frames.
pub(crate) struct Frames<'a> {
    pub dataset: &'a Dataset,
    /// The index of each class of objects.
    pub classes: &'a BTreeMap<String, i64>,
    /// The rooms that robots may be in.
    pub rooms: &'a [String],
}

impl Frames<'_> {
    /// The columns, in the order of the features; their numbers are taken into `stats`.
    pub fn columns(
        &self,
        episode: &Episode,
        lines: &[Line],
        position: Position,
        stats: &mut Stats,
    ) -> Result<Vec<Column<'static>>, ConvertError> {
        let mut columns = vec![
            Column { name: "observation.state", values: Values::Vector(self.states(episode, lines)?) },
            Column { name: "action", values: Values::Vector(self.actions(episode, lines)?) },
        ];
        for (modality, name, _) in features::pictures(&self.dataset.recipe) {
            let pictures = self.pictures(episode, lines, modality, name, stats)?;
            columns.push(Column { name, values: Values::Picture(pictures) });
        }
        columns.extend(self.steps(lines));
        columns.extend(indices(lines.len(), position));
        stats.add_columns(&columns);
        Ok(columns)
    }

    fn states(&self, episode: &Episode, lines: &[Line]) -> Result<Vec<Vec<f32>>, ConvertError> {
        let state = |(number, line): (usize, &Line)| {
            let state = vectors::state(&line.step, self.rooms);
            state.ok_or_else(|| self.wrong(episode, number, "it does not say where the robot is"))
        };
        (1..).zip(lines).map(state).collect()
    }

    fn actions(&self, episode: &Episode, lines: &[Line]) -> Result<Vec<Vec<f32>>, ConvertError> {
        let size = self.dataset.recipe.size;
        let action = |(number, line): (usize, &Line)| {
            vectors::action(&line.step, size)
                .ok_or_else(|| self.wrong(episode, number, "there is no such kind of action"))
        };
        (1..).zip(lines).map(action).collect()
    }

    fn pictures(
        &self,
        episode: &Episode,
        lines: &[Line],
        modality: &str,
        name: &str,
        stats: &mut Stats,
    ) -> Result<Vec<Picture>, ConvertError> {
        let mut pictures = Vec::with_capacity(lines.len());
        for (place, line) in lines.iter().enumerate() {
            let (file, bytes) = self.dataset.picture(episode, &line.step, modality)?;
            if place % PICTURES_SAMPLED == 0 {
                let damaged = |reason| ConvertError::Damaged { path: self.dataset.path(episode, file), reason };
                stats.add_picture(name, &picture::decode(&bytes, self.dataset.recipe.size).map_err(damaged)?);
            }
            pictures.push(Picture { bytes, path: format!("{}/{file}", episode.folder) });
        }
        Ok(pictures)
    }

    /// What lines say besides, and the lines themselves.
    fn steps(&self, lines: &[Line]) -> [Column<'static>; 7] {
        let class = |line: &Line| {
            let action = line.step.action.as_ref();
            action.and_then(|action| self.classes.get(&action.class)).copied().unwrap_or(-1)
        };
        let object = |line: &Line| line.step.action.as_ref().map_or_else(String::new, |action| action.object.clone());
        let status = |line: &Line| {
            line.step.outcome.as_ref().map_or_else(String::new, |outcome| format!("{:?}", outcome.status))
        };
        let done = |line: &Line| line.step.action.is_none();
        let instruction = |line: &Line| line.step.instruction().to_owned();
        [
            Column { name: "next.done", values: Values::Bool(lines.iter().map(done).collect()) },
            Column {
                name: "step.tick",
                values: Values::Long(lines.iter().map(|line| line.step.tick as i64).collect()),
            },
            Column { name: "step.class", values: Values::Long(lines.iter().map(class).collect()) },
            Column { name: "step.object", values: Values::Text(lines.iter().map(object).collect()) },
            Column { name: "step.instruction", values: Values::Text(lines.iter().map(instruction).collect()) },
            Column { name: "step.status", values: Values::Text(lines.iter().map(status).collect()) },
            Column { name: "step.line", values: Values::Text(lines.iter().map(|line| line.text.clone()).collect()) },
        ]
    }

    fn wrong(&self, episode: &Episode, line: usize, reason: &str) -> ConvertError {
        ConvertError::Line { path: self.dataset.path(episode, "steps.jsonl"), line, reason: reason.to_owned() }
    }
}

/// The columns that every LeRobot data set has.
fn indices(frames: usize, position: Position) -> [Column<'static>; 5] {
    let count = frames as i64;
    let times = (0..frames).map(|frame| frame as f32 / FRAMES_PER_SECOND as f32);
    [
        Column { name: "timestamp", values: Values::Float(times.collect()) },
        Column { name: "frame_index", values: Values::Long((0..count).collect()) },
        Column { name: "episode_index", values: Values::Long(vec![position.episode; frames]) },
        Column { name: "index", values: Values::Long((position.first..position.first + count).collect()) },
        Column { name: "task_index", values: Values::Long(vec![position.task; frames]) },
    ]
}

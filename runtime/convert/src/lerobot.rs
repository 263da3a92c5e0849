//! A LeRobot data set, version 3: frames and episodes as Parquet files, with what describes them in `meta/`.
//!
//! A step is a frame. Its pictures are the PNG files of the native data set, byte for byte; `step.line` is its line, and the table
//! of episodes has `episode.json` and `mission.json` of each, so nothing is lost.

mod episodes;
mod features;
mod frames;
mod rolling;
mod stats;
mod tasks;
mod vectors;

use std::collections::BTreeMap;

use cohabit_cdf::Catalog;
use serde_json::{Value, json};

use self::{
    episodes::{Episodes, Row},
    frames::{FRAMES_PER_SECOND, Frames, Position},
    rolling::{FILES_IN_CHUNK, Rolling},
    stats::Stats,
    tasks::Tasks,
};
use crate::{Counts, card, error::ConvertError, native::Dataset, output::Output};

/// The version of the layout.
const CODEBASE_VERSION: &str = "v3.0";
/// What is said of the files.
const CARD: &str = include_str!("../data/lerobot.md");
/// What the Hugging Face hub reads of a card.
const FRONT_MATTER: &str = "---\ntask_categories:\n- robotics\ntags:\n- LeRobot\nconfigs:\n- config_name: default\n  data_files: data/*/*.parquet\n---\n\n";

/// Writes a data set into a folder; a file has `limit` bytes at most, unless one episode has more.
pub(crate) fn write(
    dataset: &Dataset,
    output: &Output,
    limit: usize,
    catalog: &Catalog,
    done: &dyn Fn(usize, usize),
) -> Result<Counts, ConvertError> {
    let names: Vec<String> = catalog.classes().iter().map(|class| class.id.clone()).collect();
    let classes: BTreeMap<String, i64> = names.iter().cloned().zip(0..).collect();
    let rooms: Vec<String> = catalog.rooms().ids().map(|room| room.id().to_owned()).collect();
    let frames = Frames { dataset, classes: &classes, rooms: &rooms };
    let (mut data, mut episodes) = (Rolling::new(output, "data", limit), Episodes::new(output, limit));
    let (mut tasks, mut stats, mut first) = (Tasks::default(), Stats::default(), 0_i64);
    for (number, episode) in dataset.episodes.iter().enumerate() {
        let lines = dataset.lines(episode)?;
        let task = tasks::of_episode(&lines);
        let position = Position { episode: number as i64, first, task: tasks.number(&task) };
        let columns = frames.columns(episode, &lines, position, &mut stats)?;
        let place = data.room_for(columns.iter().map(|column| column.values.bytes()).sum())?;
        data.write(&columns)?;
        episodes.add(Row {
            episode: number as i64,
            task,
            frames: lines.len() as i64,
            first,
            data: place,
            mission: episode.id.clone(),
            floor_plan: episode.floor_plan.clone(),
            episode_json: dataset.text(episode, "episode.json")?,
            mission_json: dataset.text(episode, "mission.json")?,
        })?;
        first += lines.len() as i64;
        done(number + 1, dataset.episodes.len());
    }
    let counts = Counts { episodes: dataset.episodes.len(), samples: first as usize, files: data.finish()? };
    episodes.finish()?;
    write_json(output, "meta/info.json", &info(dataset, &rooms, &counts, tasks.count(), limit))?;
    write_json(output, "meta/stats.json", &stats.json())?;
    write_json(output, "meta/classes.json", &json!(names))?;
    tasks.write(output)?;
    output.write("README.md", format!("{FRONT_MATTER}{}", card::text(dataset, &counts, "LeRobot v3", CARD)))?;
    Ok(counts)
}

fn info(dataset: &Dataset, rooms: &[String], counts: &Counts, tasks: usize, limit: usize) -> Value {
    let megabytes = limit.div_ceil(1 << 20);
    json!({
        "codebase_version": CODEBASE_VERSION,
        "robot_type": "cohabit",
        "total_episodes": counts.episodes,
        "total_frames": counts.samples,
        "total_tasks": tasks,
        "chunks_size": FILES_IN_CHUNK,
        "data_files_size_in_mb": megabytes,
        "video_files_size_in_mb": megabytes,
        "fps": FRAMES_PER_SECOND,
        "splits": { "train": format!("0:{}", counts.episodes) },
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": null,
        "features": features::features(&dataset.recipe, rooms),
    })
}

fn write_json(output: &Output, name: &str, value: &Value) -> Result<(), ConvertError> {
    output.write(name, format!("{value:#}\n"))
}

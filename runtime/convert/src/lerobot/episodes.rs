//! `meta/episodes`: a row for each episode.

use cohabit_parquet::{Column, Values};

use super::rolling::{Place, Rolling};
use crate::{error::ConvertError, output::Output};

/// Rows that are written together.
const ROWS_IN_GROUP: usize = 64;

/// What is said of an episode.
#[derive(Debug)]
pub(crate) struct Row {
    pub episode: i64,
    pub task: String,
    pub frames: i64,
    /// The index of its first frame.
    pub first: i64,
    /// Where its frames are.
    pub data: Place,
    pub mission: String,
    pub floor_plan: String,
    /// Its `episode.json`.
    pub episode_json: String,
    /// Its `mission.json`.
    pub mission_json: String,
}

/// The table of episodes, as it is written.
pub(crate) struct Episodes<'a> {
    files: Rolling<'a>,
    rows: Vec<Row>,
}

impl<'a> Episodes<'a> {
    pub const fn new(output: &'a Output, limit: usize) -> Self {
        Self { files: Rolling::new(output, "meta/episodes", limit), rows: Vec::new() }
    }

    /// Adds an episode.
    pub fn add(&mut self, row: Row) -> Result<(), ConvertError> {
        self.rows.push(row);
        if self.rows.len() < ROWS_IN_GROUP { Ok(()) } else { self.flush() }
    }

    /// Writes what is left; gives how many files there are.
    pub fn finish(mut self) -> Result<usize, ConvertError> {
        self.flush()?;
        self.files.finish()
    }

    fn flush(&mut self) -> Result<(), ConvertError> {
        let rows = std::mem::take(&mut self.rows);
        if rows.is_empty() {
            return Ok(());
        }
        let bytes = rows.iter().map(|row| row.episode_json.len() + row.mission_json.len() + row.task.len()).sum();
        let place = self.files.room_for(bytes)?;
        self.files.write(&columns(&rows, place))
    }
}

fn columns(rows: &[Row], place: Place) -> Vec<Column<'static>> {
    let longs =
        |name, value: &dyn Fn(&Row) -> i64| Column { name, values: Values::Long(rows.iter().map(value).collect()) };
    let texts = |name, value: &dyn Fn(&Row) -> &String| Column {
        name,
        values: Values::Text(rows.iter().map(value).cloned().collect()),
    };
    let tasks = rows.iter().map(|row| vec![row.task.clone()]).collect();
    vec![
        longs("episode_index", &|row| row.episode),
        Column { name: "tasks", values: Values::Texts(tasks) },
        longs("length", &|row| row.frames),
        longs("data/chunk_index", &|row| row.data.chunk),
        longs("data/file_index", &|row| row.data.file),
        longs("dataset_from_index", &|row| row.first),
        longs("dataset_to_index", &|row| row.first + row.frames),
        longs("meta/episodes/chunk_index", &|_| place.chunk),
        longs("meta/episodes/file_index", &|_| place.file),
        texts("mission", &|row| &row.mission),
        texts("floor_plan", &|row| &row.floor_plan),
        texts("episode.json", &|row| &row.episode_json),
        texts("mission.json", &|row| &row.mission_json),
    ]
}

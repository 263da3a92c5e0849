//! Session logs of missions that were played by whatever agent: what was done in them.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use cohabit_cdf::mission::read_mission;
use cohabit_record::{Log, LogError};
use serde_json::Value;

use crate::{
    benchmark::Benchmark,
    episode::{Recording, TickInputs},
    mission::Mission,
};

/// Why logs cannot be scored.
#[derive(Debug, thiserror::Error)]
pub enum LogsError {
    /// The folder cannot be read.
    #[error("{path}: {source}")]
    Folder {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A log is not of a mission played from its beginning, as the benchmark has it.
    #[error("{path}: {reason}")]
    Unfit {
        /// Which.
        path: PathBuf,
        /// Why, and what would be right.
        reason: String,
    },
    /// Two logs are of one mission.
    #[error("{path}: {other} is of the mission {mission}, too; leave one of them in the folder")]
    Twice {
        /// One.
        path: PathBuf,
        /// The other.
        other: PathBuf,
        /// The mission.
        mission: String,
    },
}

/// What was done in the logs of a folder.
#[derive(Clone, Debug, Default)]
pub struct Recordings {
    /// By the names of the benchmark's missions.
    pub by_mission: BTreeMap<String, Recording>,
    /// Logs of missions that the benchmark does not have.
    pub others: Vec<PathBuf>,
}

/// What was done in the logs of a folder (`.mcap`).
///
/// # Errors
/// [`LogsError`].
pub fn recordings(folder: &Path, benchmark: &Benchmark) -> Result<Recordings, LogsError> {
    let failed = |source| LogsError::Folder { path: folder.to_owned(), source };
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<Vec<_>, LogsError>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "mcap"));
    paths.sort();
    let (mut found, mut others) = (BTreeMap::<String, (PathBuf, Recording)>::new(), Vec::new());
    for path in paths {
        let log = Log::open(&path)?;
        let Some(mission) = mission_of(&log, benchmark) else {
            others.push(path);
            continue;
        };
        if let Some((other, _)) = found.get(&mission.id) {
            return Err(LogsError::Twice { path, other: other.clone(), mission: mission.id.clone() });
        }
        let recording = recording(&log, benchmark).map_err(|reason| LogsError::Unfit { path: path.clone(), reason })?;
        found.insert(mission.id.clone(), (path, recording));
    }
    Ok(Recordings { by_mission: found.into_iter().map(|(id, (_, recording))| (id, recording)).collect(), others })
}

/// The mission of the benchmark that a log is of: clients may write its file in another way, so it is compared by what it says.
fn mission_of<'a>(log: &Log, benchmark: &'a Benchmark) -> Option<&'a Mission> {
    let cdf: Value = serde_json::from_str(&log.session.mission_text).ok()?;
    benchmark.missions.iter().find(|mission| mission.cdf == cdf)
}

/// What was done in a log of one of the benchmark's missions.
///
/// # Errors
/// Why it is not of a mission played from its beginning, whole, and as the benchmark has it, in words.
pub fn recording(log: &Log, benchmark: &Benchmark) -> Result<Recording, String> {
    let session = &log.session;
    if let Some(problem) = log.problems().first() {
        return Err(format!("the log is not whole: {problem}; play the mission again"));
    }
    if session.branched.is_some() || log.ticks.first().is_some_and(|entry| entry.tick != 1) {
        return Err("the session did not begin at the beginning; play the mission again".to_owned());
    }
    if session.packs != benchmark.catalog.packs() {
        return Err(
            "the session had other world packs than this call; give those of the session by `--world`".to_owned()
        );
    }
    if !session.bodies.is_empty() {
        return Err("the session had bodies beside those of the mission; play it without `--body`".to_owned());
    }
    let read = read_mission(&session.mission_file, &session.mission_text, &benchmark.catalog);
    let mission = read.map_err(|problems| problems.to_string())?.mission;
    let seed = mission.seed.unwrap_or(benchmark.seed);
    if session.seed != seed {
        return Err(format!("the session has the seed {}; play the mission with `--seed {seed}`", session.seed));
    }
    let taken = log.ticks.iter().filter(|entry| !entry.inputs.is_empty());
    let taken =
        taken.map(|entry| TickInputs { tick: entry.tick, digest: entry.digest.clone(), inputs: entry.inputs.clone() });
    Ok(Recording { ticks: log.ticks.last().map_or(0, |entry| entry.tick), taken: taken.collect() })
}

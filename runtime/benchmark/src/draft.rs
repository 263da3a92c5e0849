//! A submission that is being written: it can be gone on with wherever it was interrupted.

use std::{
    collections::BTreeMap,
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use cohabit_durable::whole_lines;
use serde::Serialize;

use crate::{
    episode::Episode,
    error::RunError,
    submission::{Header, Line, Submission},
};

/// Episodes that are played, in a file beside the submission that comes of it.
pub(crate) struct Draft {
    header: Header,
    path: PathBuf,
    file: File,
    episodes: BTreeMap<String, Episode>,
}

/// The file of the episodes of a submission that is not whole yet.
pub(crate) fn part_of(out: &Path) -> PathBuf {
    with_ending(out, "part")
}

/// A path with one more ending.
fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".{ending}"));
    PathBuf::from(name)
}

impl Draft {
    /// Begins one, or goes on with the one of the same run: what was cut off in the middle of a line is played again.
    pub(crate) fn open(out: &Path, header: Header) -> Result<Self, RunError> {
        let path = part_of(out);
        let damaged = |line: usize, reason: String| RunError::Damaged { path: path.clone(), line, reason };
        let text = match fs::read(&path) {
            Ok(bytes) => str::from_utf8(whole_lines(&bytes)).map_err(|error| damaged(1, error.to_string()))?.to_owned(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            Err(source) => return Err(RunError::File { path: path.clone(), source }),
        };
        if text.is_empty() {
            let file = File::create(&path).map_err(at(&path))?;
            let mut draft = Self { header, path, file, episodes: BTreeMap::new() };
            let first = line(&draft.header, &draft.path)?;
            draft.append(&first)?;
            return Ok(draft);
        }
        let Submission { header: before, lines } = Submission::parse(&text).map_err(|reason| damaged(1, reason))?;
        if !before.is_same_run(&header) {
            return Err(RunError::OtherRun { path: path.clone() });
        }
        let mut episodes = BTreeMap::new();
        for Line { number, episode } in lines {
            let episode = episode.map_err(|reason| damaged(number, reason))?;
            episodes.insert(episode.mission.clone(), episode);
        }
        let file = OpenOptions::new().append(true).open(&path).map_err(at(&path))?;
        file.set_len(text.len() as u64).map_err(at(&path))?;
        Ok(Self { header: before, path, file, episodes })
    }

    /// Whether a mission was played.
    pub(crate) fn has(&self, mission: &str) -> bool {
        self.episodes.contains_key(mission)
    }

    /// Takes an episode down.
    pub(crate) fn push(&mut self, episode: Episode) -> Result<(), RunError> {
        let text = line(&episode, &self.path)?;
        self.append(&text)?;
        self.episodes.insert(episode.mission.clone(), episode);
        Ok(())
    }

    fn append(&mut self, text: &str) -> Result<(), RunError> {
        self.file.write_all(text.as_bytes()).map_err(at(&self.path))
    }

    /// Its header, and what was played of these missions, in their order.
    pub(crate) fn into_parts<'a>(mut self, missions: impl Iterator<Item = &'a str>) -> (Header, Vec<Episode>) {
        let episodes = missions.filter_map(|mission| self.episodes.remove(mission)).collect();
        (self.header, episodes)
    }
}

/// Writes a submission; it appears once it is whole, and its draft goes.
pub(crate) fn write(out: &Path, header: &Header, episodes: &[Episode]) -> Result<(), RunError> {
    let mut text = line(header, out)?;
    for episode in episodes {
        text.push_str(&line(episode, out)?);
    }
    let whole = with_ending(out, "whole");
    fs::write(&whole, text).map_err(at(&whole))?;
    fs::rename(&whole, out).map_err(at(out))?;
    let part = part_of(out);
    fs::remove_file(&part).map_err(at(&part))
}

fn line(value: &impl Serialize, path: &Path) -> Result<String, RunError> {
    let text = serde_json::to_string(value).map_err(|error| at(path)(error.into()))?;
    Ok(text + "\n")
}

fn at(path: &Path) -> impl FnOnce(io::Error) -> RunError + use<> {
    let path = path.to_owned();
    move |source| RunError::File { path, source }
}

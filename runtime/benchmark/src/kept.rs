//! Missions that were made before, in a file: making them takes far longer than reading them.

use std::{
    fs,
    path::{Path, PathBuf},
};

use cohabit_durable::{Readers, write_whole};

use crate::mission::{Mission, digest};

/// Counts changes of what a file holds.
const FORMAT: u32 = 1;

/// The file of a benchmark's missions: their digest in the first line, and a mission in each other.
pub(crate) struct Kept {
    path: PathBuf,
}

impl Kept {
    /// That of the missions that follow from all of these texts, in a folder.
    pub fn of(folder: &Path, texts: &[&str]) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(&FORMAT.to_le_bytes());
        for text in texts {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        }
        Self { path: folder.join(format!("missions-{}.jsonl", hasher.finalize().to_hex())) }
    }

    /// The missions, if they are there and have the digest that is expected; if none is expected, the one of the file. Whatever else
    /// is there counts for nothing.
    pub fn read(&self, expected: Option<&str>) -> Option<Vec<Mission>> {
        let text = fs::read_to_string(&self.path).ok()?;
        let (noted, lines) = text.split_once('\n')?;
        let missions: Option<Vec<Mission>> =
            lines.lines().map(|line| Mission::of_line(&serde_json::from_str(line).ok()?)).collect();
        missions.filter(|missions| digest(missions) == expected.unwrap_or(noted))
    }

    /// Keeps missions. Where that is not possible they are made again the next time.
    pub fn write(&self, missions: &[Mission]) {
        let lines: Vec<String> = missions.iter().map(|mission| format!("{}\n", mission.as_line())).collect();
        let text = format!("{}\n{}", digest(missions), lines.concat());
        let made = self.path.parent().map_or(Ok(()), fs::create_dir_all);
        let _ = made.and_then(|()| write_whole(&self.path, text.as_bytes(), Readers::All));
    }
}

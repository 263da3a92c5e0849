//! What lies in a study's folder.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

use cohabit_record::Log;
use cohabit_study::{Folder, Journal, Progress, is_practice};

use crate::{failure::bad_input, terminal::shown_lines};

/// The logs of a study's sessions that can be read, but for those of practice if that is left out. One that is just begun has nothing
/// in it.
pub fn logs(folder: &Path, progress: &[Progress], with_practice: bool) -> anyhow::Result<Vec<PathBuf>> {
    let mut all = files(&folder.join("logs"), "mcap")?;
    all.retain(|path| with_practice || !is_of_practice(path, progress));
    let (whole, unread): (Vec<_>, Vec<_>) = all.into_iter().partition(|path| Log::open(path).is_ok());
    for path in unread {
        eprintln!("cohabit: {} cannot be read, and is left out", shown_lines(path.display()));
    }
    Ok(whole)
}

/// Those of the logs of a folder that are not of a study's practice: of any folder but that of a study's logs, all.
pub fn without_practice(folder: &Path, mut logs: Vec<PathBuf>) -> anyhow::Result<Vec<PathBuf>> {
    let path = folder.canonicalize().map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    let Some(study) = path.parent().filter(|study| Folder::study_file(study).is_file()) else { return Ok(logs) };
    let journals = Folder::journals_in(study).map_err(bad_input)?;
    let read =
        journals.iter().map(|path| Journal::read(path).map_err(bad_input)).collect::<anyhow::Result<Vec<_>>>()?;
    let progress: Vec<Progress> = read.into_iter().flatten().collect();
    logs.retain(|path| !is_of_practice(path, &progress));
    Ok(logs)
}

fn is_of_practice(log: &Path, progress: &[Progress]) -> bool {
    log.file_stem().and_then(OsStr::to_str).is_some_and(|session| is_practice(progress, session))
}

/// The files of a folder with that ending, in the order of their names.
fn files(folder: &Path, ending: &str) -> anyhow::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    let paths = entries.flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|own| own == ending)).collect();
    found.sort();
    Ok(found)
}

//! What lies in a study's folder.

use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

use cohabit_record::Log;
use cohabit_study::{Folder, Journal, Progress, is_of_excluded, is_practice};

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

/// Where the participants are whose sessions' logs a folder holds: nobody, if it is any folder but that of a study's logs.
pub fn participants_of(folder: &Path) -> anyhow::Result<Vec<Progress>> {
    let path = folder.canonicalize().map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    let Some(study) = path.parent().filter(|study| Folder::study_file(study).is_file()) else { return Ok(Vec::new()) };
    let journals = Folder::journals_in(study).map_err(bad_input)?;
    let read =
        journals.iter().map(|path| Journal::read(path).map_err(bad_input)).collect::<anyhow::Result<Vec<_>>>()?;
    Ok(read.into_iter().flatten().collect())
}

/// Whether a log is of a practice.
pub fn is_of_practice(log: &Path, progress: &[Progress]) -> bool {
    session(log).is_some_and(|session| is_practice(progress, session))
}

/// Whether a log is of somebody whom the experimenter excluded.
pub fn is_left_out(log: &Path, progress: &[Progress]) -> bool {
    session(log).is_some_and(|session| is_of_excluded(progress, session))
}

fn session(log: &Path) -> Option<&str> {
    log.file_stem().and_then(OsStr::to_str)
}

/// The files of a folder with that ending, in the order of their names.
fn files(folder: &Path, ending: &str) -> anyhow::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    let paths = entries.flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = paths.filter(|path| path.extension().is_some_and(|own| own == ending)).collect();
    found.sort();
    Ok(found)
}

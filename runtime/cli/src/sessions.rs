//! Sessions that run, and where the logs of those that did are kept.

use std::{
    fs,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use anyhow::Context as _;
use cohabit_bus::Session;

use crate::failure::bad_input;

/// The folder that was asked for, or the one for sessions in the user's data folder; made if it is not there.
pub fn folder(asked: Option<&Path>) -> anyhow::Result<PathBuf> {
    let folder = asked.map_or_else(usual_folder, Path::to_owned);
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

/// The time now, as names of logs have it.
pub fn time() -> String {
    jiff::Zoned::now().strftime("%Y-%m-%d_%H-%M-%S").to_string()
}

/// A seed, where none was asked for.
pub fn clock_seed() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // What JSON numbers hold exactly.
    u64::from(since.subsec_nanos()) ^ (since.as_secs() << 20) & ((1 << 53) - 1)
}

/// The folder for sessions in the user's data folder.
pub fn usual_folder() -> PathBuf {
    data_folder().join("sessions")
}

/// Where this user's data of this program is.
pub fn data_folder() -> PathBuf {
    let home = || std::env::var_os("HOME").map(|home| Path::new(&home).join(".local/share"));
    let base = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from).filter(|path| path.is_absolute());
    base.or_else(home).unwrap_or_else(std::env::temp_dir).join("cohabit")
}

/// The session of that name, or the one that runs.
pub fn running(name: Option<&str>) -> anyhow::Result<Session> {
    if let Some(name) = name {
        return Session::new(name).map_err(bad_input);
    }
    let mut running = Session::all_supervised();
    match (running.pop(), running.is_empty()) {
        (Some(session), true) => Ok(session),
        (None, _) => Err(bad_input("no session runs here: start one with `cohabit play`")),
        (Some(last), false) => {
            let names: Vec<_> = running.iter().chain([&last]).map(Session::name).collect();
            Err(bad_input(format!("several sessions run: choose one by `--session`: {}", names.join(", "))))
        }
    }
}

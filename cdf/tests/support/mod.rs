//! The missions to test with: the project's own, and real ones, for tests that need the reference data.

#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses what it needs")]

use std::{fs, path::PathBuf};

use cohabit_cdf::mission::{builtin, sources};

/// The reference data, beside the project's folder.
pub fn arena() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/arena"))
}

/// The files of real missions, as `(name, text)`.
pub fn real_files() -> Vec<(String, String)> {
    let arena = arena();
    let names = [
        "cdf/mission_01.json",
        "cdf/mission_07.json",
        "cdf/mission_08.json",
        "missions-dev.jsonl",
        "human-sessions-dev.json",
    ];
    let read = |name: &str| {
        let path = arena.join(name);
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (name.to_owned(), text)
    };
    names.into_iter().map(read).collect()
}

/// The real missions, as `(name, text)`.
pub fn real_missions() -> Vec<(String, String)> {
    let mut missions = Vec::new();
    for (file, text) in real_files() {
        for source in sources(&file, &text) {
            let (line, id) = (source.position.0, source.id.clone().unwrap_or_default());
            missions.push((format!("{file}:{line} {id}"), source.text.to_owned()));
        }
    }
    missions
}

/// The project's own missions, as `(name, text)`.
pub fn own_missions() -> Vec<(String, String)> {
    builtin().iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

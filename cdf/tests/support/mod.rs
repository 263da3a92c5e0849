//! The missions to test with: the project's own, and real ones where they are at hand.

#![allow(dead_code, clippy::unwrap_used, reason = "each test file uses what it needs")]

use std::{fs, path::PathBuf};

use cohabit_cdf::mission::{builtin, sources};

/// Where real missions may lie, beside the project's folder.
pub fn arena() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/arena"))
}

/// The files of real missions that are there, as `(name, text)`; said when there are none.
pub fn real_files() -> Vec<(String, String)> {
    let arena = arena();
    let names = [
        "cdf/mission_01.json",
        "cdf/mission_07.json",
        "cdf/mission_08.json",
        "missions-dev.jsonl",
        "human-sessions-dev.json",
    ];
    let read = |name: &str| Some((name.to_owned(), fs::read_to_string(arena.join(name)).ok()?));
    let files: Vec<_> = names.into_iter().filter_map(read).collect();
    if files.is_empty() {
        eprintln!("skipped: no real missions at {}", arena.display());
    }
    files
}

/// The real missions that are there, as `(name, text)`.
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

/// The project's own missions and the real ones.
pub fn all_missions() -> Vec<(String, String)> {
    let own = builtin().iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
    own.chain(real_missions()).collect()
}

//! The sets of labelled utterances.

use std::{fs, path::PathBuf};

/// The name and the text of each set in a folder of this crate, or of those that are named.
pub fn read(sets: &str, named: &[String]) -> Vec<(String, String)> {
    let files = fs::read_dir(folder(sets)).expect("the sets").flatten();
    let sets = files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|kind| kind == "txt"));
    let sets = sets.map(|path| (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), path));
    let sets = sets.filter(|(name, _)| named.is_empty() || named.contains(name));
    sets.map(|(name, path)| (name, fs::read_to_string(&path).expect("a set"))).collect()
}

/// A folder of this crate.
pub fn folder(path: &str) -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), path].iter().collect()
}

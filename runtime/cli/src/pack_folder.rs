//! The folder of a world pack that a command makes.

use std::{
    fs,
    io::{Error, ErrorKind},
    path::Path,
};

use crate::failure::{bad_input, environment};

/// The name of a pack: that which is given, or that of its folder.
pub fn name(folder: &Path, given: Option<&str>) -> String {
    let of_folder = || folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    given.map_or_else(of_folder, str::to_owned)
}

/// Nothing is there yet.
pub fn check_is_new(folder: &Path) -> anyhow::Result<()> {
    if folder.exists() { Err(exists_already(folder)) } else { Ok(()) }
}

fn exists_already(folder: &Path) -> anyhow::Error {
    bad_input(format!("{}: exists already: take another folder", folder.display()))
}

/// Makes the folder, and writes these files, by their paths from it.
pub fn write(folder: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    fs::create_dir(folder).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists_already(folder),
        ErrorKind::NotFound => {
            bad_input(format!("{}: there is no folder to write it into: make that first", folder.display()))
        }
        _ => failed(folder, &error),
    })?;
    for (path, text) in files {
        let path = folder.join(path);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(|error| failed(parent, &error))?;
        fs::write(&path, text).map_err(|error| failed(&path, &error))?;
    }
    Ok(())
}

/// A file or folder that could not be made.
pub fn failed(path: &Path, error: &Error) -> anyhow::Error {
    environment(format!("{}: {error}", path.display()))
}

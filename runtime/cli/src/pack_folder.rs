//! The folder of a world pack that a command makes.

use std::{
    fs,
    io::{Error, ErrorKind},
    path::Path,
};

use cohabit_cdf::world_pack;

use crate::failure::{bad_input, environment};

/// The name of a pack: that which is given, or that of its folder.
pub fn name(folder: &Path, given: Option<&str>) -> String {
    let of_folder = || folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    given.map_or_else(of_folder, str::to_owned)
}

/// Neither the pack nor its folder is called as a pack that is built in: `--world` would take the one for the other, and both could not be
/// in one world.
pub fn check_is_own(folder: &Path, name: &str) -> anyhow::Result<()> {
    let called = folder.file_name().unwrap_or_default().to_string_lossy();
    match [name, &*called].into_iter().find(|one| world_pack::builtin_files(one).is_some()) {
        Some(taken) => Err(bad_input(format!(
            "{}: `{taken}` is the name of a world pack that comes with the program: take another one",
            folder.display()
        ))),
        None => Ok(()),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_pack_is_called_as_one_that_is_built_in() {
        let check = |folder: &str, given: Option<&str>| {
            let folder = Path::new(folder);
            check_is_own(folder, &name(folder, given)).map_err(|error| error.to_string())
        };
        let taken = [("homes", None), ("packs/homes/", None), ("homes", Some("mine")), ("mine", Some("homes"))];
        for (folder, given) in taken {
            let told = check(folder, given).expect_err(folder);
            assert!(told.contains("`homes` is the name of a world pack that comes with the program"), "{told}");
        }
        assert_eq!(check("mine", None), Ok(()));
    }
}

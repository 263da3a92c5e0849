//! The folder in which a package is made ready, beside those that are complete.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{InstallError, make};

/// What temporary folders are called, before the number of the process.
pub const TEMPORARY: &str = ".install-";

/// A folder that is gone when it is done with.
pub struct Temporary {
    /// Where it is.
    pub path: PathBuf,
}

impl Temporary {
    /// Of this process, in the data folder.
    pub fn new(folder: &Path) -> Result<Self, InstallError> {
        let temporary = Self { path: folder.join(format!("{TEMPORARY}{}", std::process::id())) };
        // What a process of the same number left behind.
        let _ = fs::remove_dir_all(&temporary.path);
        make(&temporary.path)?;
        Ok(temporary)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Removes what processes left behind that were broken off.
pub fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let process = name.to_str().and_then(|name| name.strip_prefix(TEMPORARY)?.parse::<u32>().ok());
        if process.is_some_and(|process| !Path::new(&format!("/proc/{process}")).exists()) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

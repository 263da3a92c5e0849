//! A folder for what a command writes and does not keep.

use std::{
    env, fs, io,
    os::unix::fs::DirBuilderExt as _,
    path::{Path, PathBuf},
    process,
};

/// A folder of this user's alone, which goes when this is dropped.
pub struct Scratch(PathBuf);

impl Scratch {
    /// A new one for that purpose; none if something has its name already, which another user may have put there.
    pub fn new(purpose: &str) -> io::Result<Self> {
        let folder = env::temp_dir().join(format!("cohabit-{purpose}-{}", process::id()));
        let made = fs::DirBuilder::new().mode(0o700).create(&folder);
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", folder.display()));
        made.map_err(named)?;
        Ok(Self(folder))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

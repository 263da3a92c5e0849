//! What tests share: folders, and a program that takes everything.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process,
};

use cohabit_cdf::{PackFile, WorldData};

use crate::check::Program;

/// A folder of a test's own, which goes when this is dropped.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new(test: &str) -> Self {
        let folder = env::temp_dir().join(format!("cohabit-study-{test}-{}", process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder for the test");
        Self(folder)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).expect("a file of the test's");
        self.path(name)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A program that finds nothing wrong with settings and missions.
pub(crate) struct Anything;

impl Program for Anything {
    fn check_arguments(&self, _: &[String]) -> Result<(), String> {
        Ok(())
    }

    fn check_mission(&self, _: &str, _: Option<&WorldData>) -> Result<(), String> {
        Ok(())
    }

    fn check_session(&self, _: &[String], _: &str, _: &Path, _: Option<&WorldData>) -> Result<(), String> {
        Ok(())
    }

    fn pack_files(&self, _: &Path) -> Result<Vec<PackFile>, String> {
        Ok(Vec::new())
    }
}

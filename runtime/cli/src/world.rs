//! World packs that a command is given: which folders, and that they are still what they were.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

use cohabit_cdf::{PackId, WorldData, WorldPack};
use cohabit_engine::{read_world_folder, world_folder_files};

use crate::failure::bad_input;

/// World packs beside what is built in.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct WorldPacks {
    /// A folder with a world pack, or the name of one that comes with the program (homes): floor plans, objects, devices and missions
    /// beside the built-in ones; as often as needed. A later one may add to an earlier one
    #[arg(long = "world", value_name = "FOLDER")]
    world_folders: Vec<PathBuf>,
    /// The hashes that these packs have, in their order
    #[arg(long = "world-hash", hide = true, value_name = "HASH")]
    world_hashes: Vec<String>,
}

impl WorldPacks {
    /// Those that lie in these folders of a folder, and are still what they were.
    pub fn beside<'a>(folder: &Path, packs: impl Iterator<Item = (&'a str, &'a PackId)>) -> Self {
        let (folders, hashes) = packs.map(|(name, id)| (folder.join(name), id.digest.clone())).unzip();
        Self { world_folders: folders, world_hashes: hashes }
    }

    /// Reads them all.
    pub fn read(&self) -> anyhow::Result<WorldData> {
        if self.world_folders.is_empty() {
            return Ok(WorldData::builtin());
        }
        let packs = read_all(&self.world_folders)?;
        for (pack, hash) in packs.iter().zip(&self.world_hashes) {
            if pack.id().digest != *hash {
                // A process that is started again must not play on in another world.
                let message = format!(
                    "the world pack {} has changed since the session began, when its hash was {hash}: put its files back",
                    pack.id()
                );
                return Err(bad_input(message));
            }
        }
        WorldData::layered(packs).map_err(bad_input)
    }

    /// Reads them all with the pack in `folder` as the last one, but for one of its files, whose path from there is `path`.
    pub fn read_but(&self, folder: &Path, path: &str) -> anyhow::Result<WorldData> {
        let mut packs = read_all(&self.others(folder))?;
        let mut files = world_folder_files(folder).map_err(bad_input)?;
        files.retain(|file| file.path != path);
        packs.push(WorldPack::parse(&folder.to_string_lossy(), files).map_err(bad_input)?);
        WorldData::layered(packs).map_err(bad_input)
    }

    /// The same with the pack in `folder` as the last one, which may be among them already.
    pub fn with_once(&self, folder: &Path) -> Self {
        let mut world_folders = self.others(folder);
        world_folders.push(folder.to_owned());
        Self { world_folders, world_hashes: Vec::new() }
    }

    /// All but the pack in `folder`.
    fn others(&self, folder: &Path) -> Vec<PathBuf> {
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        self.world_folders.iter().filter(|other| real(other) != real(folder)).cloned().collect()
    }

    /// The same with one more, the last.
    pub fn with(&self, folder: &Path) -> Self {
        let mut packs = self.clone();
        packs.world_folders.push(folder.to_owned());
        packs
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.world_folders.is_empty()
    }

    /// The same as arguments of another process of this session, which then plays in the very same `world` or not at all.
    pub fn arguments(&self, world: &WorldData) -> Vec<OsString> {
        let hashes = world.packs().iter().map(|pack| format!("--world-hash={}", pack.id().digest).into());
        self.folders().chain(hashes).collect()
    }

    /// The same folders as arguments of another command.
    pub fn folders(&self) -> impl Iterator<Item = OsString> + '_ {
        self.world_folders.iter().map(|folder| {
            let mut argument = OsString::from("--world=");
            argument.push(folder);
            argument
        })
    }
}

/// Reads the packs in these folders; where some cannot be read, says of each why.
fn read_all(folders: &[PathBuf]) -> anyhow::Result<Vec<WorldPack>> {
    let (mut packs, mut errors) = (Vec::new(), Vec::new());
    for folder in folders {
        match read_world_folder(folder) {
            Ok(pack) => packs.push(pack),
            Err(error) => errors.push(error.to_string()),
        }
    }
    if errors.is_empty() { Ok(packs) } else { Err(bad_input(errors.join("\n"))) }
}

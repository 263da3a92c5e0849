//! The world packs of a study.

use std::path::{Component, Path};

use cohabit_cdf::{WorldData, WorldPack, mission::Pointer, world_pack};

use super::Checking;
use crate::{design::StudyWorld, written::Words};

impl Checking<'_, '_> {
    /// The packs that a study names, whose files are kept with its data. Missions are then checked in their world; where something
    /// is wrong with one of them, in the built-in one.
    pub(super) fn worlds(&mut self, named: Option<&Words>) -> Vec<StudyWorld> {
        let Some(named) = named.filter(|named| !named.is_empty()) else { return Vec::new() };
        let at = Pointer::default().key("world");
        let (mut packs, mut worlds) = (Vec::new(), Vec::new());
        for (index, name) in named.iter().enumerate() {
            let folder = name.get_ref().trim_end_matches('/');
            match self.pack(folder) {
                Ok(pack) => {
                    worlds.push(StudyWorld { folder: folder.to_owned(), id: pack.id().clone() });
                    packs.push(pack);
                }
                Err(problem) => {
                    let remedy = "name a world pack that is built in, or the folder of one in the folder of the study; `cohabit check --world` says more";
                    self.findings.add(name.span(), &at.item(index), problem, remedy);
                }
            }
        }
        match WorldData::layered(packs) {
            Ok(world) => self.world = Some(world),
            Err(problem) => {
                let span = named.last().map(toml::Spanned::span).unwrap_or_default();
                let remedy = "mend one of the packs, or leave it out: all of them are in one world";
                self.findings.add(span, &at, problem.to_string(), remedy);
            }
        }
        worlds
    }

    /// The pack in a folder of the study, or the one that is built in, where there is no such folder; or what is wrong with it.
    fn pack(&mut self, folder: &str) -> Result<WorldPack, String> {
        if !Path::new(folder).components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(format!("`{folder}`: it lies outside the folder of the study"));
        }
        let path = self.folder.join(folder);
        let builtin = if path.exists() { None } else { world_pack::builtin_files(folder) };
        let files = builtin.map_or_else(|| self.program.pack_files(&path), Ok)?;
        for file in &files {
            let name = format!("{folder}/{}", file.path);
            let text = str::from_utf8(&file.bytes);
            let text =
                text.map_err(|_| format!("{name}: a study keeps packs of text files alone: take this file out"))?;
            self.files.insert(name, text.to_owned());
        }
        WorldPack::parse(folder, files).map_err(|problem| problem.to_string())
    }
}

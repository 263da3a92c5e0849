//! World packs: floor plans, objects, models, devices, rooms and missions from outside, beside what is built in.
//!
//! A pack is a folder. Whoever reads it hands its files over as bytes; here they become a [`WorldPack`], and several of
//! those, in their order, a [`WorldData`]. A later pack may add to what was there; it takes the place of nothing.
//!
//! | file | what it holds |
//! |---|---|
//! | `world.toml` | name, version, licence, description, rooms |
//! | `layouts/ID.toml` | a floor plan |
//! | `objects/*.toml`, `models/*.toml` | classes of objects, and what they look like |
//! | `table/*.toml` | rules of actions, devices and works |
//! | `missions/*.json` | missions (CDF), perhaps with a `.script` |
//!
//! All other files are of no meaning, and count for the hash alone.

mod error;
mod ids;
mod limits;
mod rooms;
mod template;

use std::sync::Arc;

use serde::Deserialize;

pub use error::PackError;
pub use template::{NAME_RULE, files as template, is_name};

use crate::{
    builtin,
    catalog::{Catalog, Layer, PackId},
    layout::Layout,
    room::{RoomEntry, Rooms},
};
use ids::Ids;

/// The file that makes a folder a pack.
pub const HEAD: &str = "world.toml";
/// The most packs that one world has.
pub const MOST_PACKS: usize = 8;

/// A file of a pack.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PackFile {
    /// Its path from the pack's folder, with `/` between its parts.
    pub path: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// What `world.toml` says.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    name: String,
    version: String,
    licence: String,
    description: String,
    #[serde(default, rename = "room")]
    rooms: Vec<RoomEntry>,
}

/// `(file name, text)`; a file's name begins with the pack's folder.
type Texts = Vec<(String, String)>;

/// A world pack, read and checked by itself.
#[derive(Clone, Debug)]
pub struct WorldPack {
    root: String,
    id: PackId,
    licence: String,
    description: String,
    rooms: Vec<RoomEntry>,
    objects: Texts,
    models: Texts,
    table: Texts,
    layouts: Texts,
    missions: Texts,
}

impl WorldPack {
    /// Reads the files of the folder `root`, whose name stands in messages alone.
    ///
    /// # Errors
    /// [`PackError`] names the file, the place in it, and what would be right.
    pub fn parse(root: &str, mut files: Vec<PackFile>) -> Result<Self, PackError> {
        files.sort_by(|one, other| one.path.cmp(&other.path));
        files.iter().try_for_each(|file| limits::check_path(root, &file.path))?;
        let digest = digest(&files);
        let head = files.iter().find(|file| file.path == HEAD);
        let head_file = format!("{root}/{HEAD}");
        let text = text(&head_file, &head.ok_or_else(|| PackError::NoHead { root: root.to_owned() })?.bytes)?;
        let Head { name, version, licence, description, rooms } = limits::read(&head_file, &text)?;
        let mut pack = Self {
            root: root.to_owned(),
            id: PackId { name, version, digest },
            licence,
            description,
            rooms,
            objects: Vec::new(),
            models: Vec::new(),
            table: Vec::new(),
            layouts: Vec::new(),
            missions: Vec::new(),
        };
        pack.check_head(&head_file)?;
        for file in &files {
            pack.take(file)?;
        }
        limits::check_scripts(root, &files)?;
        limits::check_objects(&pack.objects)?;
        limits::check_models(&pack.models)?;
        Ok(pack)
    }

    fn check_head(&self, file: &str) -> Result<(), PackError> {
        let PackId { name, version, .. } = &self.id;
        if !is_name(name) {
            return Err(PackError::at(file, "name", format!("`{name}` is no name"), NAME_RULE));
        }
        for (at, text, most) in
            [("version", version, 32), ("licence", &self.licence, 128), ("description", &self.description, 1024)]
        {
            if text.trim().is_empty() || text.len() > most || text.chars().any(char::is_control) {
                let reason = "it is empty, too long, or of several lines".to_owned();
                return Err(PackError::at(file, at, reason, &format!("write one line of at most {most} bytes")));
            }
        }
        rooms::check(file, &self.rooms)
    }

    /// Its head, as messages name it.
    fn head_file(&self) -> String {
        format!("{}/{HEAD}", self.root)
    }

    /// Takes a file in, by the folder that it lies in.
    fn take(&mut self, file: &PackFile) -> Result<(), PackError> {
        let name = format!("{}/{}", self.root, file.path);
        let parts: Vec<&str> = file.path.split('/').collect();
        let list = match parts.as_slice() {
            ["objects", one] if one.ends_with(".toml") => &mut self.objects,
            ["models", one] if one.ends_with(".toml") => &mut self.models,
            ["table", one] if one.ends_with(".toml") => &mut self.table,
            ["layouts", one] if one.ends_with(".toml") => &mut self.layouts,
            ["missions", one] if one.ends_with(".json") => &mut self.missions,
            [HEAD] => return Ok(()),
            [.., one] if one.ends_with(".toml") => {
                let reason = "it lies where no file of a pack is looked for".to_owned();
                let remedy = "put it into objects, models, table or layouts, without folders in these";
                return Err(PackError::at(&name, "", reason, remedy));
            }
            _ => return Ok(()),
        };
        let text = text(&name, &file.bytes)?;
        if name.ends_with(".toml") {
            limits::check_numbers(&name, &text)?;
        }
        list.push((name, text));
        Ok(())
    }

    /// Its name, version and hash.
    #[must_use]
    pub const fn id(&self) -> &PackId {
        &self.id
    }

    /// The licence that it names.
    #[must_use]
    pub fn licence(&self) -> &str {
        &self.licence
    }

    /// What it is, in a line.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Its missions, as `(file name, text)`; a name begins with the pack's folder.
    pub fn missions(&self) -> impl Iterator<Item = (&str, &str)> {
        pairs(&self.missions)
    }

    /// The ids of its floor plans, without their mirror images.
    pub fn plans(&self) -> impl Iterator<Item = &str> {
        self.layouts.iter().map(|(file, _)| ids::stem(file))
    }

    /// The file of one of its floor plans.
    #[must_use]
    pub fn plan_file(&self, id: &str) -> Option<&str> {
        self.layouts.iter().map(|(file, _)| file.as_str()).find(|file| ids::stem(file) == id)
    }
}

/// All that worlds are made of: what is built in, and world packs.
#[derive(Clone, Debug)]
pub struct WorldData {
    catalog: Arc<Catalog>,
    packs: Vec<WorldPack>,
}

impl WorldData {
    /// What is built in alone.
    #[must_use]
    pub fn builtin() -> Self {
        Self { catalog: Arc::new(Catalog::builtin()), packs: Vec::new() }
    }

    /// The same with packs, in their order.
    ///
    /// # Errors
    /// [`PackError::Twice`] names both files of what is there twice; [`PackError`] of all else that does not fit.
    pub fn layered(packs: Vec<WorldPack>) -> Result<Self, PackError> {
        if packs.len() > MOST_PACKS {
            return Err(PackError::TooMany { packs: packs.len() });
        }
        let mut ids = Ids::of_builtin();
        packs.iter().try_for_each(|pack| ids.add(pack))?;
        let objects = joined(builtin::OBJECTS, &packs, |pack| &pack.objects);
        let models = joined(builtin::MODELS, &packs, |pack| &pack.models);
        // The rules of packs are tried before the built-in ones, the last of which take whatever comes.
        let mut table: Vec<(&str, &str)> = packs.iter().flat_map(|pack| pairs(&pack.table)).collect();
        table.extend_from_slice(builtin::TABLE);
        let layer = Layer {
            packs: packs.iter().map(|pack| pack.id.clone()).collect(),
            plans: packs.iter().flat_map(|pack| pack.layouts.iter().cloned()).collect(),
        };
        let mut rooms = Rooms::builtin();
        packs.iter().try_for_each(|pack| rooms::add(&pack.head_file(), &mut rooms, &pack.rooms))?;
        let catalog = Catalog::parse(&objects, &models)?.with_table(&table)?.with_layer(rooms, layer);
        for pack in &packs {
            for (file, _) in &pack.layouts {
                let plan = Layout::find(ids::stem(file), &catalog)?;
                limits::check_plan(file, &plan, &catalog)?;
                rooms::check_plan(file, &plan, catalog.rooms())?;
            }
        }
        Ok(Self { catalog: Arc::new(catalog), packs })
    }

    /// The classes, devices and floor plans that there are.
    #[must_use]
    pub const fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// The packs, in their order.
    #[must_use]
    pub fn packs(&self) -> &[WorldPack] {
        &self.packs
    }

    /// All missions that have a name, as `(file name, text)` without folders: the built-in ones, then those of packs.
    pub fn missions(&self) -> impl Iterator<Item = (&str, &str)> {
        let own = self.packs.iter().flat_map(WorldPack::missions);
        let named = own.map(|(file, text)| (file.rsplit('/').next().unwrap_or(file), text));
        builtin::MISSIONS.iter().copied().chain(named)
    }
}

fn pairs(texts: &[(String, String)]) -> impl Iterator<Item = (&str, &str)> {
    texts.iter().map(|(file, text)| (file.as_str(), text.as_str()))
}

fn joined<'a>(
    builtin: &[(&'static str, &'static str)],
    packs: &'a [WorldPack],
    of: impl Fn(&'a WorldPack) -> &'a Texts,
) -> Vec<(&'a str, &'a str)> {
    let mut all: Vec<(&str, &str)> = builtin.to_vec();
    for pack in packs {
        all.extend(pairs(of(pack)));
    }
    all
}

fn text(file: &str, bytes: &[u8]) -> Result<String, PackError> {
    String::from_utf8(bytes.to_vec()).map_err(|error| {
        let at = format!("byte {}", error.utf8_error().valid_up_to());
        PackError::at(file, &at, "no UTF-8 text".to_owned(), "save the file as UTF-8")
    })
}

/// Paths and contents in the order of paths, each behind its length.
fn digest(files: &[PackFile]) -> String {
    let mut hasher = blake3::Hasher::new();
    for file in files {
        for part in [file.path.as_bytes(), &file.bytes] {
            hasher.update(&(part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests;

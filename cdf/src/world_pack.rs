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

mod draft;
mod error;
mod ids;
mod limits;
mod rooms;
mod template;
mod with_program;

use std::{collections::BTreeSet, sync::Arc};

use serde::Deserialize;

pub use draft::PlanDraft;
pub use error::{PackError, PackErrors};
pub use template::{NAME_RULE, files as template, is_name};
pub use with_program::{builtin_files, names as builtin_names};

use crate::{
    builtin,
    catalog::{Catalog, Layer, PackId, Speech},
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
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    name: String,
    version: String,
    licence: String,
    description: String,
    #[serde(default)]
    speech: Option<Speech>,
    #[serde(default, rename = "room")]
    rooms: Vec<RoomEntry>,
}

/// What world packs declare.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum PackEntry {
    /// A class of objects.
    Class,
    /// A class of devices.
    Device,
    /// A room, or another name for one.
    Room,
    /// A floor plan.
    Plan,
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
    speech: Option<Speech>,
    rooms: Vec<RoomEntry>,
    objects: Texts,
    models: Texts,
    table: Texts,
    layouts: Texts,
    missions: Texts,
    declared: BTreeSet<(PackEntry, String)>,
}

impl Head {
    /// What is wrong in it.
    fn faults(&self, file: &str) -> Vec<PackError> {
        let mut faults = Vec::new();
        let name = &self.name;
        if !is_name(name) {
            faults.push(PackError::at(file, "name", format!("`{name}` is no name"), NAME_RULE));
        }
        for (at, text, most) in
            [("version", &self.version, 32), ("licence", &self.licence, 128), ("description", &self.description, 1024)]
        {
            if text.trim().is_empty() || text.len() > most || text.chars().any(char::is_control) {
                let reason = "it is empty, too long, or of several lines".to_owned();
                faults.push(PackError::at(file, at, reason, &format!("write one line of at most {most} bytes")));
            }
        }
        faults.extend(rooms::check(file, &self.rooms));
        faults
    }
}

impl WorldPack {
    /// Reads the files of the folder `root`, whose name stands in messages alone.
    ///
    /// # Errors
    /// [`PackErrors`] names, of all that is wrong, the file, the place in it, and what would be right.
    pub fn parse(root: &str, mut files: Vec<PackFile>) -> Result<Self, PackErrors> {
        files.sort_by(|one, other| one.path.cmp(&other.path));
        let head = files.iter().find(|file| file.path == HEAD);
        let head = head.ok_or_else(|| PackError::NoHead { root: root.to_owned() })?;
        let mut errors = Vec::new();
        let head_file = format!("{root}/{HEAD}");
        let head = text(&head_file, &head.bytes).and_then(|text| limits::read::<Head>(&head_file, &text));
        let head = match head {
            Ok(head) => {
                errors.extend(head.faults(&head_file));
                head
            }
            // The other files are checked all the same.
            Err(error) => {
                errors.push(error);
                Head::default()
            }
        };
        let Head { name, version, licence, description, speech, rooms } = head;
        let mut pack = Self {
            root: root.to_owned(),
            id: PackId { name, version, digest: digest(&files) },
            licence,
            description,
            speech,
            rooms,
            objects: Vec::new(),
            models: Vec::new(),
            table: Vec::new(),
            layouts: Vec::new(),
            missions: Vec::new(),
            declared: BTreeSet::new(),
        };
        for file in &files {
            match limits::check_path(root, &file.path) {
                Ok(()) => errors.extend(pack.take(file)),
                Err(error) => errors.push(error),
            }
        }
        errors.extend(limits::check_scripts(root, &files));
        errors.extend(limits::check_objects(&pack.objects));
        errors.extend(limits::check_models(&pack.models));
        pack.declared = ids::declared(&pack);
        PackErrors::none_or(pack, errors)
    }

    /// Its head, as messages name it.
    fn head_file(&self) -> String {
        format!("{}/{HEAD}", self.root)
    }

    /// Takes a file in, by the folder that it lies in; gives what is wrong with it.
    fn take(&mut self, file: &PackFile) -> Vec<PackError> {
        let name = format!("{}/{}", self.root, file.path);
        let parts: Vec<&str> = file.path.split('/').collect();
        let list = match parts.as_slice() {
            ["objects", one] if one.ends_with(".toml") => &mut self.objects,
            ["models", one] if one.ends_with(".toml") => &mut self.models,
            ["table", one] if one.ends_with(".toml") => &mut self.table,
            ["layouts", one] if one.ends_with(".toml") => &mut self.layouts,
            ["missions", one] if one.ends_with(".json") => &mut self.missions,
            [HEAD] => return Vec::new(),
            [.., one] if one.ends_with(".toml") => {
                let reason = "it lies where no file of a pack is looked for".to_owned();
                let remedy = "put it into objects, models, table or layouts, without folders in these";
                return vec![PackError::at(&name, "", reason, remedy)];
            }
            _ => return Vec::new(),
        };
        let text = match text(&name, &file.bytes) {
            Ok(text) => text,
            Err(error) => return vec![error],
        };
        let errors = if name.ends_with(".toml") { limits::check_numbers(&name, &text) } else { Vec::new() };
        if errors.is_empty() {
            list.push((name, text));
        }
        errors
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

    /// Whether it declares this.
    #[must_use]
    pub fn declares(&self, entry: PackEntry, id: &str) -> bool {
        self.declared.contains(&(entry, id.to_owned()))
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
    /// [`PackError::Twice`] names both files of what is there twice; [`PackErrors`] has all that does not fit.
    pub fn layered(packs: Vec<WorldPack>) -> Result<Self, PackErrors> {
        if packs.len() > MOST_PACKS {
            return Err(PackError::TooMany { packs: packs.len() }.into());
        }
        let (mut ids, mut rooms, mut errors) = (Ids::of_builtin(), Rooms::builtin(), Vec::new());
        for pack in &packs {
            errors.extend(ids.add(pack));
            errors.extend(rooms::add(&pack.head_file(), &mut rooms, &pack.rooms));
        }
        let objects = joined(builtin::OBJECTS, &packs, |pack| &pack.objects);
        let models = joined(builtin::MODELS, &packs, |pack| &pack.models);
        // The rules of packs are tried before the built-in ones, the last of which take whatever comes.
        let mut table: Vec<(&str, &str)> = packs.iter().flat_map(|pack| pairs(&pack.table)).collect();
        table.extend_from_slice(builtin::TABLE);
        let layer = Layer {
            packs: packs.iter().map(|pack| pack.id.clone()).collect(),
            plans: packs.iter().flat_map(|pack| pack.layouts.iter().cloned()).collect(),
            speech: packs.iter().rev().find_map(|pack| pack.speech).unwrap_or_default(),
        };
        let (catalog, of_catalog) = Catalog::gather(&objects, &models);
        errors.extend(of_catalog.into_iter().map(PackError::from));
        let (catalog, of_table) = catalog.gather_table(&table);
        errors.extend(of_table.into_iter().map(PackError::from));
        let catalog = catalog.with_layer(rooms, layer);
        // Floor plans are laid out with whole classes and rooms alone.
        if errors.is_empty() {
            errors
                .extend(packs.iter().flat_map(|pack| &pack.layouts).flat_map(|(file, _)| plan_faults(file, &catalog)));
        }
        PackErrors::none_or(Self { catalog: Arc::new(catalog), packs }, errors)
    }

    /// The pack that declares this, if one does.
    #[must_use]
    pub fn pack_of(&self, entry: PackEntry, id: &str) -> Option<&WorldPack> {
        self.packs.iter().find(|pack| pack.declares(entry, id))
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

/// What is wrong with a floor plan of a pack.
fn plan_faults(file: &str, catalog: &Catalog) -> Vec<PackError> {
    match Layout::find(ids::stem(file), catalog) {
        Ok(plan) => {
            let mut faults = rooms::check_plan(file, &plan, catalog.rooms());
            // Ways are looked for between rooms that there are.
            if faults.is_empty() {
                faults = limits::check_plan(file, &plan, catalog);
            }
            faults
        }
        Err(error) => vec![error.into()],
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

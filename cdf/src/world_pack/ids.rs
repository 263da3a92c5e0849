//! What is named in which file, so that nothing is there twice. Classes and models are told apart by the catalogue itself.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, de::IgnoredAny};

use super::{PackEntry, PackError, WorldPack, limits};
use crate::builtin;

/// The end of the ids of mirrored floor plans.
const MIRRORED: &str = "_mirror";

/// The file of each id, by what has it.
#[derive(Default)]
pub(super) struct Ids {
    files: BTreeMap<(&'static str, String), String>,
}

/// The ids in a file of the table.
#[derive(Default, Deserialize)]
#[serde(default)]
struct TableIds {
    power_work: Option<IgnoredAny>,
    times: Option<IgnoredAny>,
    rule: Vec<Named>,
    device: Vec<OfClasses>,
    work: Vec<Named>,
    slice: BTreeMap<String, IgnoredAny>,
    prints: BTreeMap<String, IgnoredAny>,
    yesterday: BTreeMap<String, IgnoredAny>,
}

#[derive(Deserialize)]
struct Named {
    name: String,
}

#[derive(Deserialize)]
struct OfClasses {
    class: Vec<String>,
}

/// The ids in a file of classes.
#[derive(Default, Deserialize)]
#[serde(default)]
struct ObjectIds {
    object: Vec<WithId>,
}

#[derive(Deserialize)]
struct WithId {
    id: String,
}

impl TableIds {
    fn all(&self) -> Vec<(&'static str, String)> {
        let named = |kind, list: &[Named]| list.iter().map(|one| (kind, one.name.clone())).collect::<Vec<_>>();
        let keys = |kind, map: &BTreeMap<String, IgnoredAny>| {
            map.keys().map(|class| (kind, class.clone())).collect::<Vec<_>>()
        };
        let devices = self.device.iter().flat_map(|device| &device.class).map(|class| ("device of", class.clone()));
        [
            named("rule", &self.rule),
            named("work", &self.work),
            devices.collect(),
            keys("slice of", &self.slice),
            keys("print of", &self.prints),
            keys("yesterday's thing of", &self.yesterday),
        ]
        .concat()
    }
}

/// A file's name without its folder and its ending.
pub(super) fn stem(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

impl Ids {
    /// Those of what is built in.
    pub fn of_builtin() -> Self {
        let mut ids = Self::default();
        for (kind, files) in [("floor plan", builtin::LAYOUTS), ("mission", builtin::MISSIONS)] {
            for (file, _) in files {
                ids.files.insert((kind, stem(file).to_owned()), built_in(file));
            }
        }
        for (file, text) in builtin::TABLE {
            let table: TableIds = toml::from_str(text).expect("invariant: the built-in table parses");
            ids.files.extend(table.all().into_iter().map(|id| (id, built_in(file))));
        }
        ids
    }

    /// Those of a pack; what is wrong, where one of them was there before.
    pub fn add(&mut self, pack: &WorldPack) -> Vec<PackError> {
        let head = pack.head_file();
        let mut errors = Vec::new();
        errors.extend(self.note("world pack", &pack.id.name, &head));
        for room in &pack.rooms {
            errors.extend(self.note("room", room.id.id(), &head));
        }
        for (file, _) in &pack.layouts {
            if stem(file).ends_with(MIRRORED) {
                let reason = format!("`{MIRRORED}` is how mirror images of floor plans end");
                errors.push(PackError::at(file, "", reason, "give the file another name"));
            }
            errors.extend(self.note("floor plan", stem(file), file));
        }
        for (file, _) in &pack.missions {
            errors.extend(self.note("mission", stem(file), file));
        }
        for (file, text) in &pack.table {
            // Why a file is not read is said where the table is read.
            let Ok(table) = limits::read::<TableIds>(file, text) else { continue };
            for (at, found, remedy) in [
                ("power_work", &table.power_work, "leave it out; a device has `work` and `shut_work`"),
                ("times", &table.times, "leave it out; a device has `work_s` and `moment_s`"),
            ] {
                if found.is_some() {
                    let reason = "it is of the whole world, and not a pack's to say".to_owned();
                    errors.push(PackError::at(file, at, reason, remedy));
                }
            }
            for (kind, id) in table.all() {
                errors.extend(self.note(kind, &id, file));
            }
        }
        errors
    }

    fn note(&mut self, kind: &'static str, id: &str, file: &str) -> Option<PackError> {
        let first = self.files.insert((kind, id.to_owned()), file.to_owned())?;
        Some(PackError::Twice { kind, id: id.to_owned(), first, second: file.to_owned() })
    }
}

/// What a pack declares, that can be read.
pub(super) fn declared(pack: &WorldPack) -> BTreeSet<(PackEntry, String)> {
    let rooms = pack.rooms.iter().map(|room| (PackEntry::Room, room.id.id().to_owned()));
    let plans = pack.plans().map(|id| (PackEntry::Plan, id.to_owned()));
    let mut all: BTreeSet<(PackEntry, String)> = rooms.chain(plans).collect();
    for (file, text) in &pack.objects {
        let classes = limits::read::<ObjectIds>(file, text).unwrap_or_default().object;
        all.extend(classes.into_iter().map(|class| (PackEntry::Class, class.id)));
    }
    for (file, text) in &pack.table {
        let devices = limits::read::<TableIds>(file, text).unwrap_or_default().device;
        all.extend(devices.into_iter().flat_map(|device| device.class).map(|class| (PackEntry::Device, class)));
    }
    all
}

/// The file as messages name it.
fn built_in(file: &str) -> String {
    format!("the built-in {file}")
}

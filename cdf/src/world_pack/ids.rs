//! What is named in which file, so that nothing is there twice. Classes and models are told apart by the catalogue itself.

use std::collections::BTreeMap;

use serde::{Deserialize, de::IgnoredAny};

use super::{PackError, WorldPack, limits};
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
    basin: Option<IgnoredAny>,
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

    /// Those of a pack.
    ///
    /// # Errors
    /// [`PackError`], where one of them was there before.
    pub fn add(&mut self, pack: &WorldPack) -> Result<(), PackError> {
        let head = pack.head_file();
        self.note("world pack", &pack.id.name, &head)?;
        for room in &pack.rooms {
            self.note("room", room.id.id(), &head)?;
        }
        for (file, _) in &pack.layouts {
            if stem(file).ends_with(MIRRORED) {
                let reason = format!("`{MIRRORED}` is how mirror images of floor plans end");
                return Err(PackError::at(file, "", reason, "give the file another name"));
            }
            self.note("floor plan", stem(file), file)?;
        }
        for (file, _) in &pack.missions {
            self.note("mission", stem(file), file)?;
        }
        for (file, text) in &pack.table {
            let table: TableIds = limits::read(file, text)?;
            for (at, found, remedy) in [
                ("basin", &table.basin, "leave it out"),
                ("power_work", &table.power_work, "leave it out; a device has `work` and `shut_work`"),
                ("times", &table.times, "leave it out; a device has `work_s` and `moment_s`"),
            ] {
                if found.is_some() {
                    let reason = "it is of the whole world, and not a pack's to say".to_owned();
                    return Err(PackError::at(file, at, reason, remedy));
                }
            }
            for (kind, id) in table.all() {
                self.note(kind, &id, file)?;
            }
        }
        Ok(())
    }

    fn note(&mut self, kind: &'static str, id: &str, file: &str) -> Result<(), PackError> {
        match self.files.insert((kind, id.to_owned()), file.to_owned()) {
            None => Ok(()),
            Some(first) => Err(PackError::Twice { kind, id: id.to_owned(), first, second: file.to_owned() }),
        }
    }
}

/// The file as messages name it.
fn built_in(file: &str) -> String {
    format!("the built-in {file}")
}

//! Finds and reads mission files.

use std::{fs::File, io::Read as _, path::Path, sync::Arc};

use cohabit_cdf::{BodyRequest, Catalog, WorldData, mission};
use cohabit_engine::{BuildError, SessionPlan};

use crate::failure::bad_input;

/// The mission played when none is named.
const DEFAULT: &str = "make_cereal.json";

/// A mission file: its name and its text.
pub struct MissionFile {
    /// As the user named it.
    pub name: String,
    /// Its text.
    pub text: String,
}

impl MissionFile {
    /// The file at that path, or the mission of that name that is built in or of a world pack; the default one for `None`.
    pub fn find_in(name: Option<&str>, world: &WorldData) -> anyhow::Result<Self> {
        let known: Vec<(&str, &str)> = world.missions().collect();
        Self::find_up_to(name, mission::limits::BYTES, &known)
    }

    /// The same of a file that may have so many bytes, as it holds many missions, or of a mission that is `known` by its name. One with more is
    /// not read.
    pub fn find_up_to(name: Option<&str>, most: usize, known: &[(&str, &str)]) -> anyhow::Result<Self> {
        let name = name.unwrap_or(DEFAULT);
        if Path::new(name).is_file() {
            let mut bytes = Vec::new();
            let read = File::open(name).and_then(|file| file.take(most as u64 + 1).read_to_end(&mut bytes));
            read.map_err(|error| bad_input(format!("{name}: {error}")))?;
            if bytes.len() > most {
                return Err(bad_input(format!("{name}: the file has more than {most} bytes, the most that are read")));
            }
            let text = String::from_utf8(bytes).map_err(|error| {
                bad_input(format!("{name}: not UTF-8 text from byte {}", error.utf8_error().valid_up_to()))
            })?;
            return Ok(Self { name: name.to_owned(), text });
        }
        let wanted = name.trim_end_matches(".json");
        match known.iter().find(|(file, _)| file.trim_end_matches(".json") == wanted) {
            Some((file, text)) => Ok(Self { name: (*file).to_owned(), text: (*text).to_owned() }),
            None => {
                let names: Vec<&str> = known.iter().map(|(file, _)| file.trim_end_matches(".json")).collect();
                Err(bad_input(format!(
                    "{name}: there is no such file, and no built-in mission of that name, or of a world pack that is given (there are {})",
                    names.join(", ")
                )))
            }
        }
    }

    /// Checks it; `seed` is taken where the mission leaves it to chance, `bodies` join those of the mission.
    pub fn plan(&self, catalog: &Arc<Catalog>, seed: u64, bodies: &[BodyRequest]) -> Result<SessionPlan, BuildError> {
        let plan = SessionPlan::new(&self.name, &self.text, Arc::clone(catalog), seed)?;
        Ok(plan.with_bodies(bodies.to_vec()))
    }
}

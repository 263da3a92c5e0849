//! Finds and reads mission files.

use std::{fs, path::Path, sync::Arc};

use cohabit_cdf::{BodyRequest, Catalog, mission};
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
    /// The file at that path, or the built-in mission of that name; the default one for `None`.
    pub fn find(name: Option<&str>) -> anyhow::Result<Self> {
        let name = name.unwrap_or(DEFAULT);
        if Path::new(name).is_file() {
            let bytes = fs::read(name).map_err(|error| bad_input(format!("{name}: {error}")))?;
            let text = String::from_utf8(bytes).map_err(|error| {
                bad_input(format!("{name}: not UTF-8 text from byte {}", error.utf8_error().valid_up_to()))
            })?;
            return Ok(Self { name: name.to_owned(), text });
        }
        let known = mission::builtin();
        let wanted = name.trim_end_matches(".json");
        match known.iter().find(|(file, _)| file.trim_end_matches(".json") == wanted) {
            Some((file, text)) => Ok(Self { name: (*file).to_owned(), text: (*text).to_owned() }),
            None => {
                let names: Vec<&str> = known.iter().map(|(file, _)| file.trim_end_matches(".json")).collect();
                Err(bad_input(format!(
                    "{name}: there is no such file, and no built-in mission of that name (there are {})",
                    names.join(", ")
                )))
            }
        }
    }

    /// Checks it; `seed` is taken where the mission leaves it to chance, `bodies` join those of the mission.
    pub fn plan(&self, seed: u64, bodies: &[BodyRequest]) -> Result<SessionPlan, BuildError> {
        let plan = SessionPlan::new(&self.name, &self.text, Arc::new(Catalog::builtin()), seed)?;
        Ok(plan.with_bodies(bodies.to_vec()))
    }
}

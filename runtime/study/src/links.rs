//! The tokens of a study's pages: who was given a link may use it, and nobody else. They lie in a file of the owner alone.

use std::{collections::BTreeMap, fs, io, path::Path};

use cohabit_dialog::token;
use cohabit_durable::{Readers, write_whole};
use serde::{Deserialize, Serialize};

/// All tokens of a study.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Links {
    /// Of the experimenter's page.
    pub experimenter: String,
    /// Of the wizard's page; made when it is first needed.
    #[serde(default)]
    pub wizard: String,
    /// Of the observers' page; made when it is first needed.
    #[serde(default)]
    pub observer: String,
    /// Of the sign-up page.
    pub sign_up: String,
    /// Of each participant, by place.
    pub participants: BTreeMap<u32, String>,
    /// What leads participants back to where they came from, by place: parameters of the links by which they came.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub back: BTreeMap<u32, BTreeMap<String, String>>,
    /// Whether they are of a dry run, which nobody opens.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub synthetic: bool,
}

impl Links {
    /// Those in a file; new ones, if it is not there, which are perhaps of a dry run.
    ///
    /// # Errors
    /// Of the file system, or when the file holds something else.
    pub fn open(path: &Path, synthetic: bool) -> io::Result<Self> {
        match fs::read(path) {
            Ok(bytes) => {
                let mut links: Self = serde_json::from_slice(&bytes)?;
                // Earlier versions had no wizards, or no observers.
                let is_whole = !links.wizard.is_empty() && !links.observer.is_empty();
                for own in [&mut links.wizard, &mut links.observer].into_iter().filter(|own| own.is_empty()) {
                    *own = token::fresh()?;
                }
                if !is_whole {
                    links.save(path)?;
                }
                Ok(links)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let [experimenter, wizard, observer] = [token::fresh()?, token::fresh()?, token::fresh()?];
                let sign_up = token::fresh()?;
                let (participants, back) = (BTreeMap::new(), BTreeMap::new());
                let links = Self { experimenter, wizard, observer, sign_up, participants, back, synthetic };
                links.save(path)?;
                Ok(links)
            }
            Err(error) => Err(error),
        }
    }

    /// Keeps them in a file.
    ///
    /// # Errors
    /// Of the file system; the file is then as it was.
    pub fn save(&self, path: &Path) -> io::Result<()> {
        write_whole(path, &serde_json::to_vec_pretty(self)?, Readers::Owner)
    }

    /// The place of the participant with a token.
    #[must_use]
    pub fn place(&self, given: &str) -> Option<u32> {
        let own = self.participants.iter().find(|(_, token)| token::admits(token, Some(given)));
        own.map(|(place, _)| *place)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn links_are_kept_and_are_nobody_elses() {
        let folder = Scratch::new("links");
        let path = folder.path("links.json");
        let mut links = Links::open(&path, false).unwrap();
        links.participants.insert(3, token::fresh().unwrap());
        links.save(&path).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        let again = Links::open(&path, false).unwrap();
        assert_eq!((&again.experimenter, again.participants.len()), (&links.experimenter, 1));
        assert_eq!(again.place(&links.participants[&3]), Some(3));
        assert_eq!(again.place(""), None);
        let earlier = fs::read_to_string(&path).unwrap().replace("\"wizard\"", "\"other\"");
        fs::write(&path, earlier).unwrap();
        let [first, second] = [Links::open(&path, false).unwrap(), Links::open(&path, false).unwrap()];
        assert!(first.wizard.len() == 32 && first.wizard == second.wizard && first.experimenter == links.experimenter);
        let earlier = fs::read_to_string(&path).unwrap().replace("\"observer\"", "\"other\"");
        fs::write(&path, earlier).unwrap();
        let [third, fourth] = [Links::open(&path, false).unwrap(), Links::open(&path, false).unwrap()];
        assert!(third.observer.len() == 32 && third.observer == fourth.observer && third.wizard == first.wizard);
        fs::write(&path, "{").unwrap();
        assert!(Links::open(&path, false).is_err(), "links that are lost are not made anew in silence");
    }
}

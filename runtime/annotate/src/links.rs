//! The tokens of annotators' pages: who was given a link may write under its pseudonym, and nobody else.

use std::{collections::BTreeMap, fs, io, path::Path};

use cohabit_dialog::token;
use cohabit_durable::{Readers, write_whole};
use serde::{Deserialize, Serialize};

use crate::error::{AnnotateError, at};

/// The longest pseudonym, in characters.
const LONGEST_NAME: usize = 32;

/// All tokens of a data set.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Links {
    /// The token of each annotator, by pseudonym.
    pub annotators: BTreeMap<String, String>,
}

/// The pseudonyms of so many annotators: `A01`, `A02` and so on.
#[must_use]
pub fn pseudonyms(count: usize) -> Vec<String> {
    (1..=count).map(|number| format!("A{number:02}")).collect()
}

impl Links {
    /// Those in a file, with new ones for whoever has none there. Whoever had one keeps it.
    ///
    /// # Errors
    /// [`AnnotateError::Annotators`] for a name that can be none, [`AnnotateError::File`], and [`AnnotateError::Damaged`] when
    /// the file holds something else.
    pub fn open(path: &Path, names: &[String]) -> Result<Self, AnnotateError> {
        names.iter().try_for_each(|name| check(name))?;
        let mut links = match fs::read(path) {
            Ok(bytes) => serde_json::from_slice(&bytes).map_err(|error| AnnotateError::Damaged {
                path: path.to_owned(),
                reason: format!("{error}; mend it, or remove it, and all links are made anew"),
            })?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => Self::default(),
            Err(error) => return Err(at(path)(error)),
        };
        let known = links.annotators.len();
        for name in names {
            if !links.annotators.contains_key(name) {
                links.annotators.insert(name.clone(), token::fresh().map_err(at(Path::new("/dev/urandom")))?);
            }
        }
        if links.annotators.is_empty() {
            let remedy = "nobody annotates it yet: say how many do with `--annotators`, or who with `--names`";
            return Err(AnnotateError::Annotators(remedy.to_owned()));
        }
        if links.annotators.len() > known {
            let bytes = serde_json::to_vec_pretty(&links).map_err(|error| at(path)(error.into()))?;
            write_whole(path, &bytes, Readers::Owner).map_err(at(path))?;
        }
        Ok(links)
    }

    /// Whose token that is. All are compared, each in constant time.
    #[must_use]
    pub fn annotator(&self, given: &str) -> Option<&str> {
        let mut own = None;
        for (name, token) in &self.annotators {
            if token::admits(token, Some(given)) {
                own = Some(name.as_str());
            }
        }
        own
    }
}

/// Whether somebody may be called that: it stands in files and tables.
fn check(name: &str) -> Result<(), AnnotateError> {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_');
    if (1..=LONGEST_NAME).contains(&name.len()) && name.chars().all(is_plain) {
        return Ok(());
    }
    Err(AnnotateError::Annotators(format!(
        "`{}` cannot be a pseudonym: write 1 to {LONGEST_NAME} letters (a to z), figures, `-` and `_`, such as A01",
        name.escape_debug()
    )))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use cohabit_tests::Scratch;

    use super::*;

    #[test]
    fn links_are_kept_and_are_nobody_elses() {
        let scratch = Scratch::new("annotate-links");
        let path = scratch.path("links.json");
        let path = Path::new(&path);
        assert!(matches!(Links::open(path, &[]), Err(AnnotateError::Annotators(_))));
        let first = Links::open(path, &pseudonyms(2)).unwrap();
        assert_eq!(fs::metadata(path).unwrap().permissions().mode() & 0o777, 0o600);
        let again = Links::open(path, &["bela".to_owned()]).unwrap();
        assert_eq!(again.annotators.keys().collect::<Vec<_>>(), ["A01", "A02", "bela"]);
        assert_eq!(again.annotators["A02"], first.annotators["A02"]);
        assert_eq!(again.annotator(&first.annotators["A02"]), Some("A02"));
        for wrong in ["", "x", "00000000000000000000000000000000"] {
            assert_eq!(again.annotator(wrong), None, "{wrong}");
        }
        fs::write(path, "{").unwrap();
        assert!(matches!(Links::open(path, &[]), Err(AnnotateError::Damaged { .. })));
    }

    #[test]
    fn names_are_plain() {
        for name in ["A01", "x_y-z"] {
            assert!(check(name).is_ok(), "{name}");
        }
        for name in ["", "a b", "ä", "a,b", "../x"] {
            assert!(check(name).is_err(), "{name}");
        }
        assert!(check(&"x".repeat(33)).is_err());
    }
}

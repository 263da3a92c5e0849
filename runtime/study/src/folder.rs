//! A study's folder: all data of its participants, by pseudonym, and apart from them their consent.
//!
//! | in it | what it is |
//! |---|---|
//! | `study/` | the study as it was when the first participant came: `study.toml`, and the files that it names |
//! | `participants.csv`, `answers.csv` | tables, written anew from the journals |
//! | `journals/P01.jsonl` | what happened to a participant, an event a line; what they filled in before they sent it, too |
//! | `logs/P01-03-1.mcap` | sessions: participant, step, and which try; those of a pair begin with what it is called, as `pair01-03-1.mcap` |
//! | `consent/P01.json` | to which version of the form they agreed, to which of its sentences, and when |
//! | `private/links.json` | the tokens of all pages |
//! | `notes.jsonl`, `withdrawn.jsonl` | the experimenter's notes; whose data were removed, and when |
//! | `synthetic.json` | only after a dry run: that programs played all participants, with the seed |

mod error;

use std::{
    collections::BTreeMap,
    fs::{self, DirBuilder, File, OpenOptions},
    io,
    os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
};

use cohabit_durable::{LineFile, Readers, sync_folder, whole_lines, write_whole};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

pub use error::FolderError;

use crate::{
    journal::Journal,
    links::Links,
    pair::{pair_label, pair_of},
    plan::{place_of, pseudonym},
    progress::Progress,
};

/// A consent.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Consent {
    /// Whose.
    pub participant: String,
    /// When, ms since 1970.
    pub at_ms: u64,
    /// The version of the form.
    pub version: String,
    /// What they agreed to.
    pub agreed: Vec<String>,
    /// What they did not agree to, and need not.
    #[serde(default)]
    pub declined: Vec<String>,
}

/// What the experimenter noted.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Note {
    /// When, ms since 1970.
    pub at_ms: u64,
    /// About whom, if about one.
    pub participant: Option<String>,
    /// The note.
    pub text: String,
}

/// That somebody's data were removed.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Withdrawal {
    /// Whose.
    pub participant: String,
    /// When, ms since 1970.
    pub at_ms: u64,
    /// What their pair is called, whose sessions were removed with them: what their partner answered stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<String>,
}

/// A study's folder, held by this process alone.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    is_synthetic: bool,
    _lock: File,
}

/// A line of a file, or all of it, with a mark if it is of a dry run.
#[derive(Serialize)]
struct Marked<'a, T> {
    #[serde(flatten)]
    what: &'a T,
    #[serde(skip_serializing_if = "Option::is_none")]
    synthetic: Option<bool>,
}

const PARTS: [&str; 5] = ["journals", "logs", "consent", "private", STUDY];
/// Where the study's own files are.
const STUDY: &str = "study";
/// What is locked by who holds the folder.
const LOCK: &str = "private/lock";
/// Tables that are written anew from the journals.
const TABLES: [&str; 2] = ["participants.csv", "answers.csv"];
/// What says that a folder is of a dry run.
const SYNTHETIC: &str = "synthetic.json";

impl Folder {
    /// Takes a folder for a study with these files, by name; makes it, if it is not there.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn begin(path: &Path, study: &BTreeMap<String, String>) -> Result<Self, FolderError> {
        if Self::is_synthetic_in(path) {
            return Err(FolderError::Synthetic { path: path.to_owned() });
        }
        Self::take(path, study)
    }

    /// Takes a folder for a dry run of a study with these files; makes it. Nothing may be in it. What is known of the run, such
    /// as its seed, is kept.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn begin_synthetic(
        path: &Path,
        study: &BTreeMap<String, String>,
        run: &impl Serialize,
    ) -> Result<Self, FolderError> {
        if Self::is_synthetic_in(path) {
            return Err(FolderError::Synthetic { path: path.to_owned() });
        }
        make(path)?;
        if !names(path)?.is_empty() {
            return Err(FolderError::NotEmpty { path: path.to_owned() });
        }
        // First of all, so that nothing is ever in it without.
        let mark = path.join(SYNTHETIC);
        let bytes = serde_json::to_vec_pretty(&Marked { what: run, synthetic: Some(true) });
        write_whole(&mark, &bytes.map_err(|error| failed(&mark, error.into()))?, Readers::Owner)
            .map_err(|source| failed(&mark, source))?;
        Self::take(path, study)
    }

    fn take(path: &Path, study: &BTreeMap<String, String>) -> Result<Self, FolderError> {
        make(path)?;
        let path = path.canonicalize().map_err(|source| failed(path, source))?;
        let copies = path.join(STUDY);
        // What is there before anybody has held the folder is somebody's own.
        if copies.is_dir() && !path.join(LOCK).exists() && !names(&copies)?.is_empty() {
            return Err(FolderError::Foreign { path: copies });
        }
        PARTS.iter().try_for_each(|part| make(&path.join(part)))?;
        let folder = Self::lock(&path)?;
        let has_participants = !folder.places()?.is_empty();
        if !has_participants {
            // A file that the study names no more would count as one of its world packs' files.
            fs::remove_dir_all(&copies).map_err(|source| failed(&copies, source))?;
            make(&copies)?;
        }
        for (file, text) in study {
            let copy = copies.join(file);
            match fs::read_to_string(&copy) {
                Ok(known) if known == *text => {}
                _ if has_participants => return Err(FolderError::OtherStudy { path, file: file.clone() }),
                _ => {
                    copy.parent().map_or(Ok(()), make)?;
                    write_whole(&copy, text.as_bytes(), Readers::Owner).map_err(|source| failed(&copy, source))?;
                }
            }
        }
        Ok(folder)
    }

    /// Where the study's file is in its folder, with the files that it names.
    #[must_use]
    pub fn study_file(path: &Path) -> PathBuf {
        path.join(STUDY).join("study.toml")
    }

    /// Takes the folder of a study that was begun.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn open(path: &Path) -> Result<Self, FolderError> {
        if !Self::study_file(path).is_file() || !path.join("journals").is_dir() {
            return Err(FolderError::NoStudy { path: path.to_owned() });
        }
        Self::lock(&path.canonicalize().map_err(|source| failed(path, source))?)
    }

    fn lock(path: &Path) -> Result<Self, FolderError> {
        let file = path.join(LOCK);
        let opened = OpenOptions::new().write(true).create(true).truncate(false).mode(0o600).open(&file);
        let lock = opened.map_err(|source| failed(&file, source))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { path: path.to_owned(), is_synthetic: Self::is_synthetic_in(path), _lock: lock }),
            Err(fs::TryLockError::WouldBlock) => Err(FolderError::Busy { path: path.to_owned() }),
            Err(fs::TryLockError::Error(source)) => Err(failed(&file, source)),
        }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether programs played those whose data are in it.
    #[must_use]
    pub const fn is_synthetic(&self) -> bool {
        self.is_synthetic
    }

    /// The same of a folder that somebody else may hold.
    #[must_use]
    pub fn is_synthetic_in(path: &Path) -> bool {
        path.join(SYNTHETIC).exists()
    }

    fn marked<'a, T>(&self, what: &'a T) -> Marked<'a, T> {
        Marked { what, synthetic: self.is_synthetic.then_some(true) }
    }

    /// The tokens of all pages.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn links(&self) -> Result<Links, FolderError> {
        let path = self.links_path();
        Links::open(&path, self.is_synthetic).map_err(|source| failed(&path, source))
    }

    /// Where the tokens are kept.
    #[must_use]
    pub fn links_path(&self) -> PathBuf {
        self.path.join("private/links.json")
    }

    /// The journal of a participant.
    #[must_use]
    pub fn journal_path(&self, place: u32) -> PathBuf {
        self.path.join("journals").join(format!("{}.jsonl", pseudonym(place)))
    }

    /// Where a session is recorded.
    #[must_use]
    pub fn log_path(&self, session: &str) -> PathBuf {
        self.path.join("logs").join(format!("{session}.mcap"))
    }

    /// The places of those whose journals are here.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn places(&self) -> Result<Vec<u32>, FolderError> {
        let names = names(&self.path.join("journals"))?;
        let mut places: Vec<u32> = names.iter().filter_map(|name| place_of(name.strip_suffix(".jsonl")?)).collect();
        places.sort_unstable();
        Ok(places)
    }

    /// The journals of a folder that somebody else may hold, in the order of places.
    ///
    /// # Errors
    /// [`FolderError::File`], [`FolderError::NoStudy`].
    pub fn journals_in(path: &Path) -> Result<Vec<PathBuf>, FolderError> {
        let journals = path.join("journals");
        if !journals.is_dir() {
            return Err(FolderError::NoStudy { path: path.to_owned() });
        }
        let of_place = |name: &String| place_of(name.strip_suffix(".jsonl")?);
        let mut places: Vec<u32> = names(&journals)?.iter().filter_map(of_place).collect();
        places.sort_unstable();
        Ok(places.into_iter().map(|place| journals.join(format!("{}.jsonl", pseudonym(place)))).collect())
    }

    /// All journals, opened to be carried on with. Those of people who had not agreed yet go.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn journals(&self) -> Result<Vec<(Journal, Progress)>, FolderError> {
        let mut all = Vec::new();
        for path in self.places()?.into_iter().map(|place| self.journal_path(place)) {
            match Journal::open(&path)? {
                Some(journal) => all.push(journal),
                None => remove(&path)?,
            }
        }
        Ok(all)
    }

    /// Keeps a consent, apart from data.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn keep_consent(&self, place: u32, consent: &Consent) -> Result<(), FolderError> {
        let path = self.consent_path(place);
        let bytes = serde_json::to_vec_pretty(&self.marked(consent)).map_err(|error| failed(&path, error.into()))?;
        write_whole(&path, &bytes, Readers::Owner).map_err(|source| failed(&path, source))
    }

    fn consent_path(&self, place: u32) -> PathBuf {
        self.path.join("consent").join(format!("{}.json", pseudonym(place)))
    }

    /// Adds a note of the experimenter's.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn note(&self, note: &Note) -> Result<(), FolderError> {
        self.append("notes.jsonl", note)
    }

    /// The experimenter's notes.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn notes(&self) -> Result<Vec<Note>, FolderError> {
        Self::notes_in(&self.path)
    }

    /// The same of a folder that somebody else may hold.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn notes_in(path: &Path) -> Result<Vec<Note>, FolderError> {
        lines(&path.join("notes.jsonl"))
    }

    /// Whose data were removed.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn withdrawals(&self) -> Result<Vec<Withdrawal>, FolderError> {
        Self::withdrawals_in(&self.path)
    }

    /// The same of a folder that somebody else may hold.
    ///
    /// # Errors
    /// [`FolderError::File`].
    pub fn withdrawals_in(path: &Path) -> Result<Vec<Withdrawal>, FolderError> {
        lines(&path.join("withdrawn.jsonl"))
    }

    /// Removes all data of a participant: journal, logs, also those of sessions that they played with a partner, consent, notes about
    /// them, link; and the tables, which are written anew without them. That it was done is kept, first of all: what is interrupted can
    /// be done again.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn withdraw(&self, pseudonym: &str, at_ms: u64) -> Result<(), FolderError> {
        let known = self.known()?;
        let place = place_of(pseudonym).filter(|_| known.iter().any(|one| one == pseudonym));
        let place = place.ok_or_else(|| FolderError::NoParticipant {
            path: self.path.clone(),
            pseudonym: pseudonym.to_owned(),
            known: if known.is_empty() { "none".to_owned() } else { known.join(", ") },
        })?;
        let logs = self.path.join("logs");
        let pair = pair_label(pair_of(place));
        let [own, shared] = [pseudonym, pair.as_str()].map(|label| format!("{label}-"));
        let recorded = names(&logs)?;
        if !self.withdrawals()?.iter().any(|one| one.participant == pseudonym) {
            let pair = recorded.iter().any(|name| name.starts_with(&shared)).then_some(pair);
            self.append("withdrawn.jsonl", &Withdrawal { participant: pseudonym.to_owned(), at_ms, pair })?;
        }
        TABLES.iter().try_for_each(|table| remove(&self.path.join(table)))?;
        for name in recorded.iter().filter(|name| name.starts_with(&own) || name.starts_with(&shared)) {
            remove(&logs.join(name))?;
        }
        let notes: Vec<Note> = self.notes()?;
        let others: Vec<&Note> = notes.iter().filter(|note| note.participant.as_deref() != Some(pseudonym)).collect();
        if others.len() < notes.len() {
            self.replace("notes.jsonl", &others)?;
        }
        remove(&self.consent_path(place))?;
        let mut links = self.links()?;
        let (token, back) = (links.participants.remove(&place), links.back.remove(&place));
        if token.is_some() || back.is_some() {
            let path = self.links_path();
            links.save(&path).map_err(|source| failed(&path, source))?;
        }
        // Last, since by it they are found.
        remove(&self.journal_path(place))
    }

    /// The pseudonyms of all who have anything here.
    fn known(&self) -> Result<Vec<String>, FolderError> {
        let journals = self.places()?.into_iter().map(pseudonym);
        let consents = names(&self.path.join("consent"))?;
        let consents = consents.iter().filter_map(|name| name.strip_suffix(".json").map(str::to_owned));
        let mut known: Vec<String> = journals.chain(consents).filter(|name| place_of(name).is_some()).collect();
        known.sort();
        known.dedup();
        Ok(known)
    }

    fn append(&self, name: &str, line: &impl Serialize) -> Result<(), FolderError> {
        let path = self.path.join(name);
        let write = || {
            let mut options = OpenOptions::new();
            let file = options.read(true).write(true).create(true).truncate(false).mode(0o600).open(&path)?;
            let (mut lines, _) = LineFile::new(path.clone(), file)?;
            // What a crash left of a line would take this one along.
            lines.drop_rest()?;
            lines.append(&self.marked(line))?;
            sync_folder(&path)
        };
        write().map_err(|source| failed(&path, source))
    }

    fn replace(&self, name: &str, lines: &[impl Serialize]) -> Result<(), FolderError> {
        let path = self.path.join(name);
        let write = || {
            let mut bytes = Vec::new();
            for line in lines {
                serde_json::to_writer(&mut bytes, &self.marked(line))?;
                bytes.push(b'\n');
            }
            write_whole(&path, &bytes, Readers::Owner)
        };
        write().map_err(|source: io::Error| failed(&path, source))
    }
}

fn lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, FolderError> {
    match fs::read(path) {
        // A last line that was cut off is none.
        Ok(bytes) => {
            let lines = whole_lines(&bytes).split(|byte| *byte == b'\n');
            Ok(lines.filter_map(|line| serde_json::from_slice(line).ok()).collect())
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(source) => Err(failed(path, source)),
    }
}

fn failed(path: &Path, source: io::Error) -> FolderError {
    FolderError::File { path: path.to_owned(), source }
}

/// Makes a folder of this user alone; one that is there must be so.
fn make(path: &Path) -> Result<(), FolderError> {
    DirBuilder::new().recursive(true).mode(0o700).create(path).map_err(|source| failed(path, source))?;
    let mode = fs::metadata(path).map_err(|source| failed(path, source))?.permissions().mode();
    if mode & 0o077 == 0 { Ok(()) } else { Err(FolderError::Open { path: path.to_owned() }) }
}

/// The names of what is in a folder.
fn names(path: &Path) -> Result<Vec<String>, FolderError> {
    let entries = fs::read_dir(path).map_err(|source| failed(path, source))?;
    Ok(entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
}

fn remove(path: &Path) -> Result<(), FolderError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(failed(path, error)),
        _ => Ok(()),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

//! The journal of one participant: a JSON line an event, on the disk before anything follows from it.
//!
//! The first line holds the participant's plan, which is never drawn again. A line that was cut off by a crash was not
//! carried out, and is dropped. What somebody fills in of a questionnaire before they send it is in it, too; tables never
//! hold that.

use std::{
    fs::OpenOptions,
    io,
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
};

use cohabit_durable::{LineFile, sync_folder, whole_lines};
use serde::{Deserialize, Serialize};

use crate::{
    plan::Plan,
    progress::{Event, Progress},
};

/// Why a journal cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The system refuses it.
    #[error("{path}: {source}")]
    File {
        /// The journal.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another version wrote it.
    #[error(
        "{path}: it is a journal of format {format}, written by {program}, and this is cohabit {own} with format {own_format}: go on \
         with the version that the study was begun with, or export its data with that one"
    )]
    OtherVersion {
        /// The journal.
        path: PathBuf,
        /// Its format.
        format: u32,
        /// What wrote it.
        program: String,
        /// The version of this program.
        own: &'static str,
        /// The format that this program writes.
        own_format: u32,
    },
    /// A line is none of a journal.
    #[error("{path}:{line}: {reason}; the lines before it are intact: mend or remove this one")]
    Line {
        /// The journal.
        path: PathBuf,
        /// Which, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

/// The format that is written: 2 since journals say so, and by which version they were begun; 3 since tutorials are in them; 4 since
/// pairs are.
const FORMAT: u32 = 4;
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A line.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
struct Line {
    at_ms: u64,
    #[serde(flatten)]
    what: What,
    /// Of the first line.
    #[serde(flatten)]
    writer: Option<Writer>,
}

/// What wrote a journal.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
struct Writer {
    format: u32,
    program: String,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum What {
    Enrolled(Plan),
    Event(Event),
}

/// An open journal.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    lines: LineFile,
}

impl Journal {
    /// Begins the journal of a participant who agrees to take part.
    ///
    /// # Errors
    /// [`JournalError::File`], also if there is one already; where none could be begun, none is left.
    pub fn begin(path: &Path, plan: &Plan, agreed: &Event, at_ms: u64) -> Result<Self, JournalError> {
        let failed = |source| JournalError::File { path: path.to_owned(), source };
        let file = OpenOptions::new().read(true).write(true).create_new(true).mode(0o600).open(path).map_err(failed)?;
        let (lines, _) = LineFile::new(path.to_owned(), file).map_err(failed)?;
        let mut journal = Self { path: path.to_owned(), lines };
        let writer = Some(Writer { format: FORMAT, program: VERSION.to_owned() });
        let enrolled = Line { at_ms, what: What::Enrolled(plan.clone()), writer };
        let written = journal.write(&enrolled).and_then(|()| journal.append(agreed, at_ms));
        // The file's name, too, outlasts a crash.
        let kept = written.and_then(|()| sync_folder(path).map_err(failed));
        if let Err(error) = kept {
            let _ = std::fs::remove_file(path);
            return Err(error);
        }
        Ok(journal)
    }

    /// Opens a journal; gives where its participant is. `None` if it was cut off before they had agreed.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn open(path: &Path) -> Result<Option<(Self, Progress)>, JournalError> {
        let failed = |source| JournalError::File { path: path.to_owned(), source };
        let file = OpenOptions::new().read(true).write(true).open(path).map_err(failed)?;
        let (mut lines, bytes) = LineFile::new(path.to_owned(), file).map_err(failed)?;
        let progress = restored(path, &bytes)?;
        lines.drop_rest().map_err(failed)?;
        let journal = Self { path: path.to_owned(), lines };
        Ok(progress.filter(Progress::has_consented).map(|progress| (journal, progress)))
    }

    /// Where its participant is, by a journal that somebody else may be writing.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn read(path: &Path) -> Result<Option<Progress>, JournalError> {
        let bytes = std::fs::read(path).map_err(|source| JournalError::File { path: path.to_owned(), source })?;
        Ok(restored(path, whole_lines(&bytes))?.filter(Progress::has_consented))
    }

    /// Writes an event down; it is on the disk when this is back.
    ///
    /// # Errors
    /// [`JournalError::File`]; the event is not in it then.
    pub fn append(&mut self, event: &Event, at_ms: u64) -> Result<(), JournalError> {
        self.write(&Line { at_ms, what: What::Event(event.clone()), writer: None })
    }

    fn write(&mut self, line: &Line) -> Result<(), JournalError> {
        self.lines.append(line).map_err(|source| JournalError::File { path: self.path.clone(), source })
    }
}

/// What wrote a journal, by its first line. The first format did not say.
fn writer(bytes: &[u8]) -> Writer {
    let first = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
    serde_json::from_slice(first).unwrap_or_else(|_| Writer { format: 1, program: "an earlier version".to_owned() })
}

/// Where a participant is. What cannot be read of another format is for the version that wrote it.
fn restored(path: &Path, bytes: &[u8]) -> Result<Option<Progress>, JournalError> {
    let Writer { format, program } = writer(bytes);
    let read = if format > FORMAT { None } else { Some(restored_lines(path, bytes)) };
    match read {
        Some(Ok(progress)) => Ok(progress),
        Some(Err(error)) if format == FORMAT || bytes.is_empty() => Err(error),
        _ => {
            Err(JournalError::OtherVersion { path: path.to_owned(), format, program, own: VERSION, own_format: FORMAT })
        }
    }
}

fn restored_lines(path: &Path, bytes: &[u8]) -> Result<Option<Progress>, JournalError> {
    let mut progress: Option<Progress> = None;
    for (number, line) in (1..).zip(bytes.split_inclusive(|byte| *byte == b'\n')) {
        let failed = |reason: String| JournalError::Line { path: path.to_owned(), line: number, reason };
        let line: Line = serde_json::from_slice(line).map_err(|error| failed(error.to_string()))?;
        match (line.what, &mut progress) {
            (What::Enrolled(plan), None) => {
                let mut enrolled = Progress::new(plan);
                enrolled.step(&Event::Read, line.at_ms).map_err(|refused| failed(refused.to_string()))?;
                progress = Some(enrolled);
            }
            (What::Event(event), Some(progress)) => {
                progress.step(&event, line.at_ms).map_err(|refused| failed(refused.to_string()))?;
            }
            (What::Enrolled(_), Some(_)) => return Err(failed("a second plan".to_owned())),
            (What::Event(_), None) => return Err(failed("no plan stands before it".to_owned())),
        }
    }
    Ok(progress)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fs;

    use super::*;
    use crate::{
        plan::Step,
        progress::{Doing, Phase},
        scratch::Scratch,
    };

    fn plan() -> Plan {
        let step = Step::Break { block: 0, limit_s: Some(1.5) };
        Plan { place: 7, steps: vec![step.clone(), step], ..Plan::default() }
    }

    fn consented() -> Event {
        Event::Consented { version: "2".to_owned(), ticked: vec![0], audio: false }
    }

    #[test]
    fn who_is_killed_goes_on_after_the_last_whole_line() {
        let folder = Scratch::new("journal");
        let path = folder.path("P07.jsonl");
        let mut journal = Journal::begin(&path, &plan(), &consented(), 1).unwrap();
        assert!(Journal::begin(&path, &plan(), &consented(), 1).is_err(), "a place is taken once");
        journal.append(&Event::GoesOn, 3).unwrap();
        let whole = fs::read(&path).unwrap();
        let last = whole[..whole.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
        for cut in last..=whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let (mut journal, progress) = Journal::open(&path).unwrap().unwrap();
            let step = usize::from(cut == whole.len());
            assert_eq!(progress.phase(), &Phase::At(step, Doing::Ready), "{cut}");
            assert_eq!(progress.plan(), &plan());
            journal.append(&Event::GoesOn, 4).unwrap();
            assert_eq!(Journal::read(&path).unwrap().unwrap().done().len(), step + 1);
        }
    }

    #[test]
    fn a_line_that_cannot_be_is_named() {
        let folder = Scratch::new("journal-wrong");
        let path = folder.path("P07.jsonl");
        Journal::begin(&path, &plan(), &consented(), 1).unwrap();
        let whole = fs::read_to_string(&path).unwrap();
        for (line, part) in
            [("nonsense\n", ":3: expected"), ("{\"at_ms\":5,\"event\":\"started\"}\n", ":3: the study is at")]
        {
            fs::write(&path, format!("{whole}{line}")).unwrap();
            let error = Journal::open(&path).map(drop).unwrap_err().to_string();
            assert!(error.contains(part) && error.contains("P07.jsonl"), "{error}");
        }
        // What another version wrote is for that one.
        let (first, rest) = whole.split_once('\n').unwrap();
        let later = first.replace("\"format\":4", "\"format\":5").replace(VERSION, "9.9.9");
        let earlier = first.replace("\"format\":4", "\"form\":4").replace("\"place\"", "\"seat\"");
        for (first, part) in
            [(later, "format 5, written by 9.9.9"), (earlier, "format 1, written by an earlier version")]
        {
            fs::write(&path, format!("{first}\n{rest}")).unwrap();
            let error = Journal::read(&path).unwrap_err().to_string();
            assert!(error.contains(part) && error.contains("go on with the version"), "{error}");
        }
        let unsaid = first.replace("\"format\":4", "\"form\":4");
        fs::write(&path, format!("{unsaid}\n{rest}")).unwrap();
        assert!(Journal::read(&path).unwrap().is_some(), "what can be read of an earlier version is");
        // Who was cut off before they had agreed has not.
        let (enrolled, _) = whole.split_once('\n').unwrap();
        for text in [String::new(), format!("{enrolled}\n")] {
            fs::write(&path, text).unwrap();
            assert!(Journal::open(&path).unwrap().is_none() && Journal::read(&path).unwrap().is_none());
        }
    }
}

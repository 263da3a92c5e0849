//! Reads a log, also one that was cut off.

use std::{
    collections::BTreeMap,
    io,
    path::{Path, PathBuf},
};

use mcap::{MessageStream, read::Options};
use serde::de::DeserializeOwned;

use crate::entry::{DialogEntry, Entry, EventEntry, SessionEntry, TickEntry};

/// A whole log in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Log {
    /// What was played.
    pub session: SessionEntry,
    /// Every tick, in order.
    pub ticks: Vec<TickEntry>,
    /// What happened.
    pub events: Vec<EventEntry>,
    /// What was said.
    pub dialog: Vec<DialogEntry>,
    /// Why it ends early, if it does: its recorder was killed, or the file is damaged from there on.
    pub cut: Option<String>,
}

/// Why a log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be opened or made.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another process writes it.
    #[error("{path} is being written by another recorder: choose another `--log`")]
    Busy {
        /// Which.
        path: PathBuf,
    },
    /// It is the log of another session.
    #[error("{path} holds session `{session}` already: choose another `--log`")]
    OtherSession {
        /// Which.
        path: PathBuf,
        /// The session's name.
        session: String,
    },
    /// The log cannot be written.
    #[error("write {path}: {source}")]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: mcap::McapError,
    },
    /// An entry cannot be written as JSON.
    #[error("write {path}: {source}")]
    Encode {
        /// Which log.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// It is no session log.
    #[error("{path} is not a session log: {reason}")]
    NotALog {
        /// Which.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A newer program wrote it.
    #[error(
        "{path} has format {found}, this program reads up to {known}: use the program of version {program} or newer"
    )]
    TooNew {
        /// Which.
        path: PathBuf,
        /// Its format.
        found: u32,
        /// The newest format known here.
        known: u32,
        /// Who wrote it.
        program: String,
    },
}

impl Log {
    /// Reads the log at `path`.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let bytes = std::fs::read(path).map_err(|source| LogError::File { path: path.to_owned(), source })?;
        Self::parse(path, &bytes)
    }

    /// Reads a log's bytes; `path` is for messages alone.
    ///
    /// # Errors
    /// [`LogError::NotALog`], [`LogError::TooNew`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, LogError> {
        let not_a_log = |reason: String| LogError::NotALog { path: path.to_owned(), reason };
        let stream = MessageStream::new_with_options(bytes, Options::IgnoreEndMagic.into())
            .map_err(|error| not_a_log(error.to_string()))?;
        let (mut session, mut cut) = (None, None);
        let (mut ticks, mut events, mut dialog) = (Vec::new(), Vec::new(), Vec::new());
        for message in stream {
            let taken = message.map_err(|error| error.to_string()).and_then(|message| {
                match message.channel.topic.as_str() {
                    SessionEntry::TOPIC => session = Some(decode::<SessionEntry>(&message.data)?),
                    TickEntry::TOPIC => ticks.push(decode(&message.data)?),
                    EventEntry::TOPIC => events.push(decode(&message.data)?),
                    DialogEntry::TOPIC => dialog.push(decode(&message.data)?),
                    _ => {}
                }
                Ok(())
            });
            if let Err(reason) = taken {
                cut = Some(reason);
                break;
            }
        }
        if cut.is_none() && !bytes.ends_with(mcap::MAGIC) {
            cut = Some("its recorder did not end it".to_owned());
        }
        let reason = || cut.clone().unwrap_or_else(|| "no session entry".to_owned());
        let session = session.ok_or_else(|| not_a_log(reason()))?;
        if session.format > SessionEntry::FORMAT {
            let (found, known, program) = (session.format, SessionEntry::FORMAT, session.program);
            return Err(LogError::TooNew { path: path.to_owned(), found, known, program });
        }
        Ok(Self { session, ticks, events, dialog, cut })
    }
}

impl Log {
    /// How many events and dialog messages are missing between the first and the last of their senders: nobody took
    /// them down in time.
    #[must_use]
    pub fn missing(&self) -> u64 {
        let events = self.events.iter().map(|entry| (entry.run, entry.sequence));
        let dialog = self.dialog.iter().map(|entry| (entry.run, entry.sequence));
        gaps(events) + gaps(dialog)
    }
}

/// The numbers that are missing between the first and the last of each run's.
fn gaps(numbers: impl Iterator<Item = (u64, u64)>) -> u64 {
    let mut newest = BTreeMap::new();
    // Where no run is told, none was counted.
    let counted = numbers.filter(|(run, _)| *run != 0);
    counted.map(|(run, number)| newest.insert(run, number).map_or(0, |before| number.saturating_sub(before + 1))).sum()
}

fn decode<T: DeserializeOwned>(data: &[u8]) -> Result<T, String> {
    serde_json::from_slice(data).map_err(|error| error.to_string())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_cdf::Action;

    use super::*;
    use crate::{entry::InputEntry, writer::LogWriter};

    fn sample(path: &Path) -> Log {
        let session = SessionEntry {
            format: SessionEntry::FORMAT,
            program: "test".to_owned(),
            session: "s".to_owned(),
            mission_file: "m.json".to_owned(),
            mission_text: "{}".to_owned(),
            seed: u64::MAX,
            bodies: vec!["person@Lab1".parse().unwrap()],
            run: u64::MAX,
        };
        let inputs = vec![InputEntry { command: 1 << 50, turn: 1, body: 0, action: Action::LookAround }];
        let ticks: Vec<_> = (0..50)
            .map(|tick| TickEntry { tick, digest: format!("{tick:064x}"), wall_nanos: tick, inputs: inputs.clone() })
            .collect();
        let mut writer = LogWriter::create(path, &session, 1).unwrap();
        for tick in &ticks {
            writer.tick(tick).unwrap();
        }
        writer.finish().unwrap();
        Log { session, ticks, events: Vec::new(), dialog: Vec::new(), cut: None }
    }

    #[test]
    fn what_is_written_is_read_also_when_cut_anywhere() {
        let path = std::env::temp_dir().join(format!("cohabit-log-{}.mcap", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let whole = sample(&path);
        assert_eq!(Log::open(&path).unwrap(), whole);
        assert!(matches!(LogWriter::create(&path, &whole.session, 1), Err(LogError::File { .. })), "never overwritten");
        let bytes = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        for length in (0..bytes.len()).step_by(7) {
            if let Ok(part) = Log::parse(&path, &bytes[..length]) {
                assert!(part.cut.is_some(), "cut at {length} unnoticed");
                assert_eq!(part.ticks, whole.ticks[..part.ticks.len()]);
            }
        }
        let end = bytes.len();
        assert!(Log::parse(&path, &bytes[..end - 1]).unwrap().ticks.len() == 50);
    }
}

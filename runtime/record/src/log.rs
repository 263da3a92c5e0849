//! Reads a log, also one that was cut off.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read as _},
    path::{Path, PathBuf},
};

use mcap::records::Record;

use crate::{
    entry::{AnswerEntry, DialogEntry, EventEntry, GapEntry, SessionEntry, TickEntry},
    reading::Reading,
    segment::{Piece, SEAL, Segments, index_problem, records},
    snapshot::Snapshot,
};

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
    /// What people answered to questionnaires.
    pub answers: Vec<AnswerEntry>,
    /// The state after some of the ticks.
    pub snapshots: Vec<Snapshot>,
    /// What its recorder could not take down in time.
    pub gaps: Vec<GapEntry>,
    /// What was damaged since.
    pub lost: Vec<Lost>,
    /// Why it ends early, if it does: its recorder was killed, or the file is damaged from there on.
    pub cut: Option<String>,
}

/// A part of a log that is not as it was written.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Lost {
    /// Its first byte, and the one after its last.
    pub bytes: [usize; 2],
    /// The newest tick before it; 0 if there is none.
    pub after_tick: u64,
    /// The first tick behind it, if there is one.
    pub before_tick: Option<u64>,
}

impl std::fmt::Display for Lost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([from, to], after) = (self.bytes, self.after_tick);
        let next = after.saturating_add(1);
        if from == 0 && self.before_tick == Some(next) {
            return write!(f, "bytes 0 to {to} are damaged: its beginning, which is read from a copy further behind");
        }
        write!(f, "bytes {from} to {to} are damaged, and lost: ")?;
        match self.before_tick.map(|before| (before, before.saturating_sub(next))) {
            Some((before, 0)) => write!(f, "what was noted between tick {after} and tick {before}"),
            Some((_, 1)) => write!(f, "tick {next}"),
            Some((before, _)) => write!(f, "ticks {next} to {}", before - 1),
            None => write!(f, "what followed tick {after}"),
        }
    }
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
    /// The disk does not take the log.
    #[error("write {path}: {source}")]
    Disk {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
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
    /// Whether there is a file that begins as logs do. Of what is no file, such as a pipe, nothing is read.
    #[must_use]
    pub fn is_at(path: &Path) -> bool {
        let mut beginning = Vec::new();
        let length = mcap::MAGIC.len() as u64;
        path.is_file()
            && File::open(path)
                .is_ok_and(|file| file.take(length).read_to_end(&mut beginning).is_ok() && beginning == mcap::MAGIC)
    }

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
        let mut log = Opening { path, reading: Reading::default(), lost: Vec::new(), is_sealed: false, cut: None };
        if Segments::new(bytes).any(|piece| matches!(piece, Piece::Whole(_))) {
            log.is_sealed = true;
            log.read_segments(bytes)?;
        } else if bytes.starts_with(mcap::MAGIC) {
            log.read_unsealed(bytes)?;
        } else {
            return Err(log.not_a_log("it is no MCAP file".to_owned()));
        }
        log.open()
    }
}

const NO_COPY: &str = "its beginning is damaged, and no copy of its session entry follows";

/// A log that is being read.
struct Opening<'a> {
    path: &'a Path,
    reading: Reading,
    lost: Vec<Lost>,
    is_sealed: bool,
    cut: Option<String>,
}

impl Opening<'_> {
    fn read_segments(&mut self, bytes: &[u8]) -> Result<(), LogError> {
        self.cut = Some("its recorder did not end it".to_owned());
        for piece in Segments::new(bytes) {
            match piece {
                Piece::Whole(range) => self.take(&bytes[..range.end], range.start)?,
                Piece::Damaged(range) => {
                    let after_tick = self.reading.newest_tick();
                    self.lost.push(Lost { bytes: [range.start, range.end], after_tick, before_tick: None });
                }
                Piece::Rest(range) => {
                    self.cut = Some(format!("its last {} bytes are torn or damaged", range.len()));
                }
                Piece::End(at) => {
                    self.cut = index_problem(bytes, at, self.lost.is_empty()).map(str::to_owned);
                }
            }
        }
        Ok(())
    }

    /// Takes in sealed records: what they say was written so.
    fn take(&mut self, bytes: &[u8], at: usize) -> Result<(), LogError> {
        let known = self.reading.ticks.len();
        for (kind, body) in records(bytes, at) {
            let start = body.start;
            let record = mcap::parse_record(kind, &bytes[body]).map_err(|error| error.to_string());
            let taken = record.and_then(|record| self.reading.take(&record));
            taken.map_err(|reason| self.unknown(start, &reason))?;
            self.ensure_known()?;
        }
        let Some(tick) = self.reading.ticks.get(known).map(|entry| entry.tick) else { return Ok(()) };
        for lost in self.lost.iter_mut().rev().take_while(|lost| lost.before_tick.is_none()) {
            lost.before_tick = Some(tick);
        }
        Ok(())
    }

    fn unknown(&self, at: usize, reason: &str) -> LogError {
        if self.reading.session.is_none() && !self.reading.knows_channels() {
            return self.not_a_log(NO_COPY.to_owned());
        }
        self.not_a_log(format!("what is at byte {at} is not known here: {reason}"))
    }

    fn ensure_known(&self) -> Result<(), LogError> {
        let Some(session) = &self.reading.session else { return Ok(()) };
        if session.format <= SessionEntry::FORMAT {
            return Ok(());
        }
        let (found, known, program) = (session.format, SessionEntry::FORMAT, session.program.clone());
        Err(LogError::TooNew { path: self.path.to_owned(), found, known, program })
    }

    /// Format 1 had no seals: what is damaged in it is found only where it cannot be read.
    fn read_unsealed(&mut self, bytes: &[u8]) -> Result<(), LogError> {
        let mut end = mcap::MAGIC.len();
        self.cut = Some("its recorder did not end it".to_owned());
        for (kind, body) in records(bytes, 0) {
            let (start, after) = (body.start, body.end);
            match mcap::parse_record(kind, &bytes[body]) {
                Ok(Record::Unknown { opcode: SEAL, .. }) => {
                    return Err(self.not_a_log("its beginning is damaged".to_owned()));
                }
                Ok(Record::DataEnd(_)) => {
                    self.cut = index_problem(bytes, end, true).map(str::to_owned);
                    break;
                }
                record => {
                    let taken = record.map_err(|error| error.to_string());
                    if let Err(reason) = taken.and_then(|record| self.reading.take(&record)) {
                        self.cut = Some(format!("it is damaged at byte {start}: {reason}"));
                        break;
                    }
                    self.ensure_known()?;
                }
            }
            end = after;
        }
        match &self.reading.session {
            Some(session) if session.format > 1 => Err(self.not_a_log("its beginning is damaged".to_owned())),
            Some(_) => Ok(()),
            None => Err(self.not_a_log("it has no session entry, or its beginning is damaged or torn".to_owned())),
        }
    }

    fn not_a_log(&self, reason: String) -> LogError {
        LogError::NotALog { path: self.path.to_owned(), reason }
    }

    fn open(self) -> Result<Log, LogError> {
        let Self { path, reading, mut lost, is_sealed, cut } = self;
        let Reading { session, ticks, events, dialog, answers, snapshots, gaps, .. } = reading;
        let reason = if is_sealed { NO_COPY } else { "no session entry" };
        let session = session.ok_or(LogError::NotALog { path: path.to_owned(), reason: reason.to_owned() })?;
        // Before its first tick a log has none; one that goes on from another one begins behind its point.
        let first = session.branched.as_ref().map_or(0, |branch| branch.tick);
        for lost in lost.iter_mut().take_while(|lost| lost.after_tick == 0) {
            lost.after_tick = first;
        }
        Ok(Log { session, ticks, events, dialog, answers, snapshots, gaps, lost, cut })
    }
}

impl Log {
    /// How many ticks, events, dialog messages and answers are missing between the first and the last of their senders: nobody
    /// took them down in time, or they were damaged since.
    #[must_use]
    pub fn missing(&self) -> u64 {
        let events = self.events.iter().map(|entry| (entry.run, entry.sequence));
        let dialog = self.dialog.iter().map(|entry| (entry.run, entry.sequence));
        let answers = self.answers.iter().map(|entry| (entry.run, entry.sequence));
        // Ticks are of the simulator's run alone, whose number does not matter.
        let ticks = self.ticks.iter().map(|entry| (1, entry.tick));
        [gaps(events), gaps(dialog), gaps(answers), gaps(ticks)].into_iter().fold(0, u64::saturating_add)
    }

    /// Two ticks of which the later one in the log is not the later one in the session, if there are such: none of this
    /// program's recorders writes them so.
    #[must_use]
    pub fn disorder(&self) -> Option<[u64; 2]> {
        let mut pairs = self.ticks.windows(2).map(|pair| [pair[0].tick, pair[1].tick]);
        pairs.find(|[first, second]| first >= second)
    }

    /// What is wrong with it, a sentence each; nothing, if it is as its recorder wrote it and nothing was missed.
    #[must_use]
    pub fn problems(&self) -> Vec<String> {
        let lost = self.lost.iter().map(ToString::to_string);
        let cut = self.cut.iter().map(|reason| format!("it ends early: {reason}"));
        let disorder = self
            .disorder()
            .map(|[first, second]| format!("its ticks are not in their order: tick {second} follows tick {first}"));
        lost.chain(self.gaps.iter().map(ToString::to_string)).chain(cut).chain(disorder).collect()
    }
}

/// The numbers that are missing between the first and the last of each run's.
fn gaps(numbers: impl Iterator<Item = (u64, u64)>) -> u64 {
    let mut newest = BTreeMap::new();
    // Where no run is told, none was counted.
    let counted = numbers.filter(|(run, _)| *run != 0);
    counted
        .map(|(run, number)| {
            newest.insert(run, number).map_or(0, |before| number.saturating_sub(before).saturating_sub(1))
        })
        .fold(0, u64::saturating_add)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_is_said() {
        let lost = |after_tick, before_tick| Lost { bytes: [10, 20], after_tick, before_tick }.to_string();
        assert_eq!(lost(4, None), "bytes 10 to 20 are damaged, and lost: what followed tick 4");
        assert_eq!(lost(4, Some(5)), "bytes 10 to 20 are damaged, and lost: what was noted between tick 4 and tick 5");
        assert_eq!(lost(4, Some(6)), "bytes 10 to 20 are damaged, and lost: tick 5");
        assert_eq!(lost(4, Some(9)), "bytes 10 to 20 are damaged, and lost: ticks 5 to 8");
        let beginning = |before_tick| Lost { bytes: [0, 20], after_tick: 0, before_tick }.to_string();
        assert!(beginning(Some(1)).contains("its beginning, which is read from a copy"), "{}", beginning(Some(1)));
        assert_eq!(beginning(Some(9)), "bytes 0 to 20 are damaged, and lost: ticks 1 to 8");
    }

    #[test]
    fn what_is_no_log_is_refused() {
        let check = |bytes: &[u8]| match Log::parse(Path::new("x.mcap"), bytes) {
            Err(LogError::NotALog { reason, .. }) => assert!(!reason.is_empty()),
            other => panic!("{other:?}"),
        };
        check(b"");
        check(b"my notes");
        check(mcap::MAGIC);
        check(&[mcap::MAGIC, mcap::MAGIC].concat());
    }
}

//! Carries on with a log whose recorder was killed: keeps every sealed segment, drops a torn last one, and knows what
//! was written already.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{Read as _, Seek as _, SeekFrom},
    path::Path,
};

use mcap::records::Record;

use crate::{
    entry::{GapEntry, SessionEntry},
    log::{Log, LogError},
    reading::{Reading, library},
    segment::{Piece, Segments, records},
    writer::{LIBRARY, LogWriter},
};

/// What a log holds already.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Written {
    /// The newest tick; 0 before the first.
    pub tick: u64,
    /// How many messages its recorders could not take down in time.
    pub(crate) missing: u64,
    /// The tick of the newest snapshot.
    snapshot: Option<u64>,
    events: BTreeMap<u64, u64>,
    dialog: BTreeMap<u64, u64>,
    answers: BTreeMap<u64, u64>,
}

impl Written {
    /// What is in `log`.
    fn of(log: &Log) -> Self {
        let tick = log.ticks.last().map_or(0, |entry| entry.tick);
        let snapshot = log.snapshots.last().map(|snapshot| snapshot.tick);
        let missing = log.gaps.iter().map(GapEntry::messages).fold(0, u64::saturating_add);
        let mut written = Self { tick, snapshot, missing, ..Self::default() };
        for entry in &log.events {
            written.event(entry.run, entry.sequence);
        }
        for entry in &log.dialog {
            written.dialog(entry.run, entry.sequence);
        }
        for entry in &log.answers {
            written.answer(entry.run, entry.sequence);
        }
        written
    }

    /// Takes note of an event of a publisher's run; how many of the run are missing before it, or `None` if the log has
    /// it.
    pub(crate) fn event(&mut self, run: u64, sequence: u64) -> Option<u64> {
        step(&mut self.events, run, sequence)
    }

    /// The same of a dialog message.
    pub(crate) fn dialog(&mut self, run: u64, sequence: u64) -> Option<u64> {
        step(&mut self.dialog, run, sequence)
    }

    /// The same of an answer.
    pub(crate) fn answer(&mut self, run: u64, sequence: u64) -> Option<u64> {
        step(&mut self.answers, run, sequence)
    }

    /// The same of a tick.
    pub(crate) fn tick(&mut self, tick: u64) -> Option<u64> {
        let missing = tick.checked_sub(self.tick + 1)?;
        // Who joins a world that has gone on for a while begins there.
        let missing = if self.tick == 0 { 0 } else { missing };
        self.tick = tick;
        Some(missing)
    }

    /// Takes note of a snapshot; whether it is a new one.
    pub(crate) fn snapshot(&mut self, tick: u64) -> bool {
        let is_new = self.snapshot.is_none_or(|newest| newest < tick);
        self.snapshot = self.snapshot.max(Some(tick));
        is_new
    }
}

fn step(newest: &mut BTreeMap<u64, u64>, run: u64, sequence: u64) -> Option<u64> {
    let missing = match newest.get(&run) {
        Some(before) => sequence.checked_sub(before + 1)?,
        None => 0,
    };
    newest.insert(run, sequence);
    Some(missing)
}

impl LogWriter {
    /// Opens the log of the same session that an earlier recorder began and did not end, or has ended too early: what it
    /// holds is kept, but for a torn segment at its end. Gives what it holds.
    ///
    /// # Errors
    /// [`LogError::File`], [`LogError::Busy`], [`LogError::NotALog`], [`LogError::OtherSession`], [`LogError::Write`].
    pub fn carry_on(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<(Self, Written), LogError> {
        let failed = |source| LogError::File { path: path.to_owned(), source };
        let mut file = File::options().read(true).write(true).open(path).map_err(failed)?;
        file.try_lock().map_err(|_| LogError::Busy { path: path.to_owned() })?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let mut segments = Segments::new(&bytes);
        if let Some(Piece::Damaged(range)) = segments.by_ref().find(|piece| matches!(piece, Piece::Damaged(_))) {
            let reason = format!("it is damaged between byte {} and byte {}", range.start, range.end);
            return Err(LogError::NotALog { path: path.to_owned(), reason });
        }
        let sealed = segments.sealed_to();
        if sealed == 0 {
            ensure_unbegun(path, &bytes, session)?;
            // Its recorder was killed before it had written anything.
            file.set_len(0).and_then(|()| file.rewind()).map_err(failed)?;
            return Ok((Self::begin(path, Box::new(file), session, wall_nanos)?, Written::default()));
        }
        let log = Log::parse(path, &bytes[..sealed])?;
        ensure_same(path, &log.session, session)?;
        let written = Written::of(&log);
        file.set_len(sealed as u64).and_then(|()| file.seek(SeekFrom::Start(sealed as u64))).map_err(failed)?;
        let there = records(&bytes[..sealed], 0).filter_map(|(kind, body)| mcap::parse_record(kind, &bytes[body]).ok());
        Ok((Self::after(path, Box::new(file), there, segments.seal())?, written))
    }
}

fn ensure_same(path: &Path, found: &SessionEntry, session: &SessionEntry) -> Result<(), LogError> {
    if found == session {
        return Ok(());
    }
    Err(LogError::OtherSession { path: path.to_owned(), session: found.session.clone() })
}

/// Nothing of it was sealed: is it the torn beginning of a log of this session?
fn ensure_unbegun(path: &Path, bytes: &[u8], session: &SessionEntry) -> Result<(), LogError> {
    let not_a_log = |reason: String| Err(LogError::NotALog { path: path.to_owned(), reason });
    let magic = bytes.len().min(mcap::MAGIC.len());
    if bytes[..magic] != mcap::MAGIC[..magic] {
        return not_a_log("it is no MCAP file".to_owned());
    }
    let mut reading = Reading::default();
    for (kind, body) in records(bytes, 0) {
        match mcap::parse_record(kind, &bytes[body]) {
            Ok(Record::Header(header)) if header.library != LIBRARY => return not_a_log(library(&header.library)),
            Ok(Record::Unknown { .. } | Record::DataEnd(_)) | Err(_) => {
                return not_a_log("its beginning is damaged".to_owned());
            }
            Ok(record) => drop(reading.take(&record)),
        }
    }
    reading.session.map_or(Ok(()), |found| ensure_same(path, &found, session))
}

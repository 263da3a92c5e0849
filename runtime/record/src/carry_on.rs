//! Carries on with a log whose recorder was killed: keeps every whole record, drops a torn last one, and knows what was
//! written already.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write},
    path::Path,
};

use mcap::records::Record;
use serde::de::DeserializeOwned;

use crate::{
    entry::{DialogEntry, Entry, EventEntry, SessionEntry, TickEntry},
    log::LogError,
    writer::{LIBRARY, LogWriter},
};

/// The longest record taken for one: a mission's text is the longest that is written.
const LONGEST_RECORD: u64 = 64 << 20;
/// What stands before a record's body: its kind, and the body's length.
const RECORD_HEADER: u64 = 9;

/// What a log holds already.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Written {
    /// The newest tick; 0 before the first.
    pub tick: u64,
    events: BTreeMap<u64, u64>,
    dialog: BTreeMap<u64, u64>,
}

impl Written {
    /// Takes note of an event of a publisher's run; how many of the run are missing before it, or `None` if the log has
    /// it.
    pub(crate) fn event(&mut self, run: u64, sequence: u64) -> Option<u64> {
        step(&mut self.events, run, sequence)
    }

    /// The same of a dialog message.
    pub(crate) fn dialog(&mut self, run: u64, sequence: u64) -> Option<u64> {
        step(&mut self.dialog, run, sequence)
    }

    /// The same of a tick.
    pub(crate) fn tick(&mut self, tick: u64) -> Option<u64> {
        let missing = tick.checked_sub(self.tick + 1)?;
        // Who joins a world that has gone on for a while begins there.
        let missing = if self.tick == 0 { 0 } else { missing };
        self.tick = tick;
        Some(missing)
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

/// Opens the log at `path` of that session to append to it.
///
/// # Errors
/// [`LogError::File`], [`LogError::Busy`], [`LogError::NotALog`], [`LogError::OtherSession`], [`LogError::Write`].
pub(crate) fn carry_on(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<(LogWriter, Written), LogError> {
    let failed = |source| LogError::File { path: path.to_owned(), source };
    let mut file = File::options().read(true).write(true).open(path).map_err(failed)?;
    file.try_lock().map_err(|_| LogError::Busy { path: path.to_owned() })?;
    let mut scan = Scan { path, expected: session, found: false, written: Written::default(), topics: BTreeMap::new() };
    let end = each_record(path, &file, |record| scan.take(&record))?;
    let length = file.metadata().map_err(failed)?.len();
    if length - end > LONGEST_RECORD {
        return Err(not_a_log(path, format!("it is damaged at byte {end}")));
    }
    if !scan.found {
        // Its recorder was killed before it had written anything.
        file.set_len(0).and_then(|()| file.rewind()).map_err(failed)?;
        return Ok((LogWriter::begin(path, file, session, wall_nanos)?, Written::default()));
    }
    let written = scan.written;
    // The lock stays with the first handle; the second has a place of its own to read at.
    let reader = File::open(path).map_err(failed)?;
    file.set_len(end).and_then(|()| file.seek(SeekFrom::Start(end))).map_err(failed)?;
    let mut log = LogWriter::after(path, Tail::new(file, end))?;
    each_record(path, &reader, |record| log.again(&record))?;
    Ok((log, written))
}

fn not_a_log(path: &Path, reason: String) -> LogError {
    LogError::NotALog { path: path.to_owned(), reason }
}

/// Hands the records of a file to `take`, until the end of the log's data or a torn record; gives where the last one
/// that was taken ends.
fn each_record(
    path: &Path,
    file: &File,
    mut take: impl FnMut(Record<'_>) -> Result<(), LogError>,
) -> Result<u64, LogError> {
    let failed = |source| LogError::File { path: path.to_owned(), source };
    let mut file = BufReader::with_capacity(1 << 20, file);
    file.seek(SeekFrom::Start(0)).map_err(failed)?;
    let mut magic = [0; mcap::MAGIC.len()];
    let read = read_up_to(&mut file, &mut magic).map_err(failed)?;
    if magic[..read] != mcap::MAGIC[..read] {
        return Err(not_a_log(path, "it is no MCAP file".to_owned()));
    }
    let mut end = read as u64;
    let mut body = Vec::new();
    loop {
        let mut header = [0; RECORD_HEADER as usize];
        if read_up_to(&mut file, &mut header).map_err(failed)? < header.len() {
            return Ok(end);
        }
        let [kind, length @ ..] = header;
        let length = u64::from_le_bytes(length);
        if length > LONGEST_RECORD {
            return Ok(end);
        }
        body.resize(usize::try_from(length).unwrap_or(0), 0);
        if read_up_to(&mut file, &mut body).map_err(failed)? < body.len() {
            return Ok(end);
        }
        let record = mcap::parse_record(kind, &body).map_err(|error| damaged(path, end, &error))?;
        if matches!(record, Record::DataEnd(_)) {
            return Ok(end);
        }
        take(record)?;
        end += RECORD_HEADER + length;
    }
}

fn damaged(path: &Path, offset: u64, reason: &dyn std::fmt::Display) -> LogError {
    not_a_log(path, format!("it is damaged at byte {offset}: {reason}"))
}

/// Fills `bytes` as far as there is something to read.
fn read_up_to(file: &mut impl Read, bytes: &mut [u8]) -> io::Result<usize> {
    let mut read = 0;
    while read < bytes.len() {
        match file.read(&mut bytes[read..]) {
            Ok(0) => break,
            Ok(more) => read += more,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(read)
}

/// What is found in a log that is to be carried on with.
struct Scan<'a> {
    path: &'a Path,
    expected: &'a SessionEntry,
    found: bool,
    written: Written,
    topics: BTreeMap<u16, String>,
}

impl Scan<'_> {
    fn take(&mut self, record: &Record<'_>) -> Result<(), LogError> {
        match record {
            Record::Header(header) if header.library != LIBRARY => {
                return Err(not_a_log(self.path, format!("`{}` wrote it, not this program", header.library)));
            }
            Record::Channel(channel) => {
                self.topics.insert(channel.id, channel.topic.clone());
            }
            Record::Message { header, data } => {
                let topic = self.topics.get(&header.channel_id).map(String::as_str);
                match topic {
                    Some(SessionEntry::TOPIC) => self.session(&self.decode(data)?)?,
                    Some(TickEntry::TOPIC) => self.written.tick = self.decode::<TickEntry>(data)?.tick,
                    Some(EventEntry::TOPIC) => {
                        let entry: EventEntry = self.decode(data)?;
                        self.written.event(entry.run, entry.sequence);
                    }
                    Some(DialogEntry::TOPIC) => {
                        let entry: DialogEntry = self.decode(data)?;
                        self.written.dialog(entry.run, entry.sequence);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn session(&mut self, found: &SessionEntry) -> Result<(), LogError> {
        self.found = true;
        if found == self.expected {
            return Ok(());
        }
        Err(LogError::OtherSession { path: self.path.to_owned(), session: found.session.clone() })
    }

    fn decode<T: DeserializeOwned>(&self, data: &[u8]) -> Result<T, LogError> {
        serde_json::from_slice(data).map_err(|error| not_a_log(self.path, format!("it is damaged: {error}")))
    }
}

/// The end of a file whose beginning is there already: what is written first is taken to be that, and not written again.
pub(crate) struct Tail {
    file: BufWriter<File>,
    position: u64,
    kept: u64,
}

impl Tail {
    /// The tail after the first `kept` bytes.
    pub(crate) fn new(file: File, kept: u64) -> Self {
        Self { file: BufWriter::new(file), position: 0, kept }
    }
}

impl Write for Tail {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let there = self.kept.saturating_sub(self.position).min(bytes.len() as u64);
        let written = if there > 0 { usize::try_from(there).unwrap_or(0) } else { self.file.write(bytes)? };
        self.position += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A log is only ever appended to: its writer asks where it is, and never goes elsewhere.
impl Seek for Tail {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match to {
            SeekFrom::Current(0) => Ok(self.position),
            _ => Err(io::ErrorKind::Unsupported.into()),
        }
    }
}

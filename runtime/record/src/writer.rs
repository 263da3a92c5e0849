//! Appends entries to a log.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use mcap::{
    McapError, WriteOptions,
    records::{MessageHeader, Record},
};

use crate::{
    channels::SNAPSHOTS,
    copies::Copies,
    entry::{AnswerEntry, DialogEntry, Entry, EventEntry, GapEntry, SessionEntry, TickEntry},
    film::FrameEntry,
    log::LogError,
    segment::{SEAL, Seal},
    snapshot::Snapshot,
    spool::Spool,
    tape::AudioEntry,
};

/// What wrote a log.
pub(crate) const LIBRARY: &str = concat!("cohabit ", env!("CARGO_PKG_VERSION"));
/// How snapshots are encoded: not as JSON.
const SNAPSHOT_ENCODING: &str = "cohabit-snapshot";

/// An open log, locked for this process if it is a file. What was appended is safe from the end of this process after
/// [`Self::flush`].
pub struct LogWriter {
    path: PathBuf,
    out: Spool,
    mcap: mcap::Writer<Segment>,
    segment: Segment,
    seal: Seal,
    channels: BTreeMap<String, u16>,
    sequence: u32,
    /// The newest message's time.
    newest_nanos: u64,
    copies: Copies,
}

impl LogWriter {
    /// Creates the log file, which must not exist, with its session entry.
    ///
    /// # Errors
    /// [`LogError::File`], [`LogError::Busy`], [`LogError::Write`].
    pub fn create(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<Self, LogError> {
        let file = File::create_new(path).map_err(|source| LogError::File { path: path.to_owned(), source })?;
        file.try_lock().map_err(|_| LogError::Busy { path: path.to_owned() })?;
        Self::begin(path, Box::new(file), session, wall_nanos)
    }

    /// Begins a log that goes to `out`; `path` is for messages alone.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn begin(
        path: &Path,
        out: Box<dyn Write + Send>,
        session: &SessionEntry,
        wall_nanos: u64,
    ) -> Result<Self, LogError> {
        let mut log = Self::empty(path, out)?;
        log.open_channels(&session.frames, session.audio)?;
        log.append(session, wall_nanos)?;
        log.flush()?;
        Ok(log)
    }

    fn empty(path: &Path, out: Box<dyn Write + Send>) -> Result<Self, LogError> {
        let segment = Segment::default();
        let mcap = WriteOptions::new()
            .profile("cohabit")
            .library(LIBRARY)
            .compression(None)
            .use_chunks(false)
            .create(segment.clone())
            .map_err(|source| LogError::Write { path: path.to_owned(), source })?;
        let (out, path, seal) = (Spool::new(path, out), path.to_owned(), Seal::default());
        let (channels, copies) = (BTreeMap::new(), Copies::default());
        Ok(Self { path, out, mcap, segment, seal, channels, sequence: 0, newest_nanos: 0, copies })
    }

    /// All at the beginning: an entry can be understood wherever what precedes it is damaged.
    fn open_channels(&mut self, cameras: &[String], audio: bool) -> Result<(), LogError> {
        self.open_channel::<SessionEntry>()?;
        self.open_channel::<TickEntry>()?;
        self.open_channel::<EventEntry>()?;
        self.open_channel::<DialogEntry>()?;
        self.open_channel::<AnswerEntry>()?;
        self.open_channel::<GapEntry>()?;
        self.add_channel(0, SNAPSHOTS, SNAPSHOT_ENCODING)?;
        for camera in cameras {
            let schema = self.mcap.add_schema(FrameEntry::SCHEMA_NAME, "jsonschema", FrameEntry::SCHEMA.as_bytes());
            let schema = self.written(schema)?;
            self.add_channel(schema, &format!("{}{camera}", FrameEntry::TOPICS), "json")?;
        }
        for (channel, _) in AudioEntry::CHANNELS.into_iter().filter(|_| audio) {
            let schema = self.mcap.add_schema(AudioEntry::SCHEMA_NAME, "jsonschema", AudioEntry::SCHEMA.as_bytes());
            let schema = self.written(schema)?;
            self.add_channel(schema, channel, "json")?;
        }
        Ok(())
    }

    fn open_channel<E: Entry>(&mut self) -> Result<(), LogError> {
        let schema = self.mcap.add_schema(&E::TOPIC[1..], "jsonschema", E::SCHEMA.as_bytes());
        let schema = self.written(schema)?;
        self.add_channel(schema, E::TOPIC, "json")
    }

    fn add_channel(&mut self, schema: u16, topic: &str, encoding: &str) -> Result<(), LogError> {
        // Numbers are given in order, from 1.
        let id = self.mcap.add_channel(schema, topic, encoding, &BTreeMap::new());
        self.channels.insert(topic.to_owned(), self.written(id)?);
        Ok(())
    }

    /// Appends a tick.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn tick(&mut self, entry: &TickEntry) -> Result<(), LogError> {
        self.append(entry, entry.wall_nanos)
    }

    /// Appends an event.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn event(&mut self, entry: &EventEntry, wall_nanos: u64) -> Result<(), LogError> {
        self.append(entry, wall_nanos)
    }

    /// Appends a dialog message.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn dialog(&mut self, entry: &DialogEntry, wall_nanos: u64) -> Result<(), LogError> {
        self.append(entry, wall_nanos)
    }

    /// Appends an answer to a questionnaire.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn answer(&mut self, entry: &AnswerEntry, wall_nanos: u64) -> Result<(), LogError> {
        self.append(entry, wall_nanos)
    }

    /// Appends that something is missing.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn gap(&mut self, entry: &GapEntry, wall_nanos: u64) -> Result<(), LogError> {
        self.append(entry, wall_nanos)
    }

    /// Appends a snapshot.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn snapshot(&mut self, snapshot: &Snapshot, wall_nanos: u64) -> Result<(), LogError> {
        self.message(SNAPSHOTS, &snapshot.message(), wall_nanos)
    }

    /// Appends a frame of a camera that the session entry names.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub(crate) fn frame(&mut self, entry: &FrameEntry, wall_nanos: u64) -> Result<(), LogError> {
        let data = serde_json::to_vec(entry).map_err(|source| LogError::Encode { path: self.path.clone(), source })?;
        self.message(&entry.topic(), &data, wall_nanos)
    }

    /// Appends a piece of sound, where the session entry says that there is any.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub(crate) fn audio(&mut self, channel: &str, entry: &AudioEntry, wall_nanos: u64) -> Result<(), LogError> {
        let data = serde_json::to_vec(entry).map_err(|source| LogError::Encode { path: self.path.clone(), source })?;
        self.message(channel, &data, wall_nanos)
    }

    /// Seals all that was appended, and hands it to the operating system in one piece; what the disk has no room for
    /// waits, and goes before what comes next.
    ///
    /// # Errors
    /// [`LogError::Disk`], [`LogError::Write`].
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.seal()?;
        if self.copies.is_due(self.segment.end()) {
            self.copy_session()?;
        }
        let handed = self.out.push(&self.segment.take());
        self.handed(handed)
    }

    /// Ends the log with another copy of the session entry, and its index.
    ///
    /// # Errors
    /// [`LogError::Disk`], [`LogError::Write`].
    pub fn finish(mut self) -> Result<(), LogError> {
        self.seal()?;
        if self.copies.is_due_at_end(self.segment.end()) {
            self.copy_session()?;
        }
        let finished = self.mcap.finish().map(drop);
        self.written(finished)?;
        let handed = self.out.push(&self.segment.take()).and_then(|()| self.out.finish());
        self.handed(handed)
    }

    fn seal(&mut self) -> Result<(), LogError> {
        let next = self.segment.unsealed(|segment| (!segment.is_empty()).then(|| self.seal.next(segment)));
        let Some(next) = next else { return Ok(()) };
        self.seal = next;
        let sealed = self.mcap.write_private_record(SEAL, &next.body(), Default::default());
        self.written(sealed)?;
        self.segment.end_segment();
        self.copies.note_seal(self.segment.end());
        Ok(())
    }

    /// Repeats the session entry in a segment of its own: what is damaged then is one or the other.
    fn copy_session(&mut self) -> Result<(), LogError> {
        let entry = self.copies.entry();
        self.message(SessionEntry::TOPIC, &entry, self.newest_nanos)?;
        self.seal()
    }

    fn append<E: Entry>(&mut self, entry: &E, wall_nanos: u64) -> Result<(), LogError> {
        let data = serde_json::to_vec(entry).map_err(|source| LogError::Encode { path: self.path.clone(), source })?;
        self.message(E::TOPIC, &data, wall_nanos)
    }

    fn message(&mut self, topic: &str, data: &[u8], wall_nanos: u64) -> Result<(), LogError> {
        let channel_id = self.channels.get(topic).copied().unwrap_or(u16::MAX);
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: wall_nanos, publish_time: wall_nanos };
        let written = self.mcap.write_to_known_channel(&header, data);
        self.written(written)?;
        self.note(&header, data);
        Ok(())
    }

    /// Takes note of a message that is written now, or was written by an earlier recorder.
    fn note(&mut self, header: &MessageHeader, data: &[u8]) {
        self.sequence = header.sequence.wrapping_add(1);
        self.newest_nanos = header.log_time;
        let is_of = |topic: &str| self.channels.get(topic) == Some(&header.channel_id);
        if is_of(SessionEntry::TOPIC) {
            self.copies.note_session(data);
        } else if is_of(SNAPSHOTS) {
            self.copies.note_snapshot();
        }
    }

    fn handed(&self, handed: io::Result<()>) -> Result<(), LogError> {
        handed.map_err(|source| LogError::Disk { path: self.path.clone(), source })
    }

    fn written<T>(&self, written: Result<T, McapError>) -> Result<T, LogError> {
        written.map_err(|source| LogError::Write { path: self.path.clone(), source })
    }
}

/// What a log holds already, when it is carried on with.
impl LogWriter {
    /// A log that goes on in `out` after these sealed records, which are there already.
    pub(crate) fn after<'a>(
        path: &Path,
        out: Box<dyn Write + Send>,
        records: impl IntoIterator<Item = Record<'a>>,
        seal: Seal,
    ) -> Result<Self, LogError> {
        let mut log = Self::empty(path, out)?;
        for record in records {
            log.again(&record)?;
            log.segment.take();
        }
        log.seal = seal;
        // The copy that was due when its recorder was killed.
        log.flush()?;
        Ok(log)
    }

    /// Takes note of a record that is there.
    fn again(&mut self, record: &Record<'_>) -> Result<(), LogError> {
        let done = match record {
            Record::Schema { header, data } => {
                self.mcap.add_schema(&header.name, &header.encoding, data).map(|id| id == header.id)
            }
            Record::Channel(channel) => {
                self.channels.insert(channel.topic.clone(), channel.id);
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                let id = self.mcap.add_channel(channel.schema_id, topic, encoding, &channel.metadata);
                id.map(|id| id == channel.id)
            }
            Record::Message { header, data } => {
                self.note(header, data);
                self.mcap.write_to_known_channel(header, data).map(|()| true)
            }
            Record::Unknown { opcode, data } => {
                let written = self.mcap.write_private_record(*opcode, data, Default::default());
                self.copies.note_seal(self.segment.end());
                written.map(|()| true)
            }
            _ => Ok(true),
        };
        if self.written(done)? {
            return Ok(());
        }
        Err(LogError::NotALog { path: self.path.clone(), reason: "its channels are numbered otherwise".to_owned() })
    }
}

/// Bytes of a log that were not handed on yet: the segment that is written, and perhaps sealed ones before it.
#[derive(Clone, Default)]
struct Segment(Arc<Mutex<Unsealed>>);

#[derive(Default)]
struct Unsealed {
    bytes: Vec<u8>,
    /// How many of them are sealed.
    sealed: usize,
    /// How many went before.
    before: u64,
}

impl Segment {
    fn lock(&self) -> MutexGuard<'_, Unsealed> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn unsealed<T>(&self, read: impl FnOnce(&[u8]) -> T) -> T {
        let unsealed = self.lock();
        read(&unsealed.bytes[unsealed.sealed..])
    }

    /// All up to here is sealed.
    fn end_segment(&self) {
        let mut unsealed = self.lock();
        unsealed.sealed = unsealed.bytes.len();
    }

    /// Where the log ends, counted from its beginning.
    fn end(&self) -> u64 {
        let unsealed = self.lock();
        unsealed.before + unsealed.bytes.len() as u64
    }

    fn take(&self) -> Vec<u8> {
        let mut unsealed = self.lock();
        unsealed.before += unsealed.bytes.len() as u64;
        unsealed.sealed = 0;
        std::mem::take(&mut unsealed.bytes)
    }
}

impl Write for Segment {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.lock().bytes.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A log is only ever appended to: its writer asks where it is, and never goes elsewhere.
impl Seek for Segment {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let here = self.end();
        match to {
            SeekFrom::Current(0) => Ok(here),
            SeekFrom::Start(there) if there == here => Ok(here),
            _ => Err(io::Error::other("a log is only appended to")),
        }
    }
}

//! Appends entries to a log.

use std::{
    collections::BTreeMap,
    fs::File,
    io::Write as _,
    path::{Path, PathBuf},
};

use mcap::{
    WriteOptions,
    records::{MessageHeader, Record},
};

use crate::{
    carry_on::{Tail, Written, carry_on},
    entry::{DialogEntry, Entry, EventEntry, SessionEntry, TickEntry},
    log::LogError,
};

/// What wrote a log.
pub(crate) const LIBRARY: &str = concat!("cohabit ", env!("CARGO_PKG_VERSION"));

/// An open log, locked for this process. What was appended is safe from the end of this process after [`Self::flush`].
pub struct LogWriter {
    path: PathBuf,
    mcap: mcap::Writer<Tail>,
    channels: BTreeMap<String, u16>,
    sequence: u32,
}

impl LogWriter {
    /// Creates the log file, which must not exist, with its session entry.
    ///
    /// # Errors
    /// [`LogError::File`], [`LogError::Busy`], [`LogError::Write`].
    pub fn create(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<Self, LogError> {
        let file = File::create_new(path).map_err(|source| LogError::File { path: path.to_owned(), source })?;
        file.try_lock().map_err(|_| LogError::Busy { path: path.to_owned() })?;
        Self::begin(path, file, session, wall_nanos)
    }

    /// Opens the log of the same session that an earlier recorder began and did not end, or has ended too early: what it
    /// holds is kept, but for a torn record at its end. Gives what it holds.
    ///
    /// # Errors
    /// [`LogError::File`], [`LogError::Busy`], [`LogError::NotALog`], [`LogError::OtherSession`], [`LogError::Write`].
    pub fn carry_on(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<(Self, Written), LogError> {
        carry_on(path, session, wall_nanos)
    }

    /// Begins a log in an empty file.
    pub(crate) fn begin(path: &Path, file: File, session: &SessionEntry, wall_nanos: u64) -> Result<Self, LogError> {
        let mut log = Self::after(path, Tail::new(file, 0))?;
        log.append(session, wall_nanos)?;
        log.flush()?;
        Ok(log)
    }

    /// A log that goes on after what its tail knows to be there, which must then be told [`Self::again`].
    pub(crate) fn after(path: &Path, tail: Tail) -> Result<Self, LogError> {
        let mcap = WriteOptions::new()
            .profile("cohabit")
            .library(LIBRARY)
            .compression(None)
            .use_chunks(false)
            .create(tail)
            .map_err(|source| LogError::Write { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), mcap, channels: BTreeMap::new(), sequence: 0 })
    }

    /// Takes note of a record that is there.
    pub(crate) fn again(&mut self, record: &Record<'_>) -> Result<(), LogError> {
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
                self.sequence = header.sequence.wrapping_add(1);
                self.mcap.write_to_known_channel(header, data).map(|()| true)
            }
            _ => Ok(true),
        };
        match done {
            Ok(true) => Ok(()),
            Ok(false) => {
                Err(LogError::NotALog { path: self.path.clone(), reason: "its channels are numbered otherwise".into() })
            }
            Err(source) => Err(LogError::Write { path: self.path.clone(), source }),
        }
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

    /// Hands all that was appended to the operating system.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.mcap.flush().map_err(|source| LogError::Write { path: self.path.clone(), source })
    }

    /// Ends the log with its index.
    ///
    /// # Errors
    /// [`LogError::Write`].
    pub fn finish(mut self) -> Result<(), LogError> {
        let path = self.path;
        self.mcap.finish().map_err(|source| LogError::Write { path: path.clone(), source })?;
        self.mcap.into_inner().flush().map_err(|source| LogError::File { path, source })
    }

    fn append<E: Entry>(&mut self, entry: &E, wall_nanos: u64) -> Result<(), LogError> {
        let failed = |path: &Path, source| LogError::Write { path: path.to_owned(), source };
        let channel_id = match self.channels.get(E::TOPIC) {
            Some(id) => *id,
            None => {
                let id = self.open_channel::<E>().map_err(|source| failed(&self.path, source))?;
                self.channels.insert(E::TOPIC.to_owned(), id);
                id
            }
        };
        let data = serde_json::to_vec(entry).map_err(|source| LogError::Encode { path: self.path.clone(), source })?;
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time: wall_nanos, publish_time: wall_nanos };
        self.sequence = self.sequence.wrapping_add(1);
        self.mcap.write_to_known_channel(&header, &data).map_err(|source| failed(&self.path, source))
    }

    fn open_channel<E: Entry>(&mut self) -> mcap::McapResult<u16> {
        let schema = self.mcap.add_schema(&E::TOPIC[1..], "jsonschema", E::SCHEMA.as_bytes())?;
        self.mcap.add_channel(schema, E::TOPIC, "json", &BTreeMap::new())
    }
}

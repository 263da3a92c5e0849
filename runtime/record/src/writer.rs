//! Appends entries to a log.

use std::{
    collections::BTreeMap,
    fs::File,
    io::BufWriter,
    path::{Path, PathBuf},
};

use mcap::{WriteOptions, records::MessageHeader};

use crate::{
    entry::{DialogEntry, Entry, EventEntry, SessionEntry, TickEntry},
    log::LogError,
};

/// An open log. What was appended is safe from the end of this process after [`Self::flush`].
pub struct LogWriter {
    path: PathBuf,
    mcap: mcap::Writer<BufWriter<File>>,
    channels: BTreeMap<&'static str, u16>,
    sequence: u32,
}

impl LogWriter {
    /// Creates the log file, which must not exist, with its session entry.
    ///
    /// # Errors
    /// [`LogError::File`], [`LogError::Write`].
    pub fn create(path: &Path, session: &SessionEntry, wall_nanos: u64) -> Result<Self, LogError> {
        let file = File::create_new(path).map_err(|source| LogError::File { path: path.to_owned(), source })?;
        let failed = |source| LogError::Write { path: path.to_owned(), source };
        let mcap = WriteOptions::new()
            .profile("cohabit")
            .library(concat!("cohabit ", env!("CARGO_PKG_VERSION")))
            .compression(None)
            .use_chunks(false)
            .create(BufWriter::new(file))
            .map_err(failed)?;
        let mut log = Self { path: path.to_owned(), mcap, channels: BTreeMap::new(), sequence: 0 };
        log.append(session, wall_nanos)?;
        log.flush()?;
        Ok(log)
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
        self.mcap.finish().map(|_| ()).map_err(|source| LogError::Write { path: self.path.clone(), source })
    }

    fn append<E: Entry>(&mut self, entry: &E, wall_nanos: u64) -> Result<(), LogError> {
        let failed = |path: &Path, source| LogError::Write { path: path.to_owned(), source };
        let channel_id = match self.channels.get(E::TOPIC) {
            Some(id) => *id,
            None => {
                let id = self.open_channel::<E>().map_err(|source| failed(&self.path, source))?;
                self.channels.insert(E::TOPIC, id);
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

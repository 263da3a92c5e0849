//! What is on its way to a file, and waits in memory while the disk is full.

use std::{
    io::{self, ErrorKind, Write},
    path::{Path, PathBuf},
};

/// The most that waits, bytes: some hours of a session without frames.
const MOST_WAITING: usize = 64 << 20;

/// Bytes on their way to a file. Nothing is lost while the disk is full, as long as memory is spared for what waits.
pub(crate) struct Spool {
    /// For messages.
    path: PathBuf,
    out: Box<dyn Write + Send>,
    waiting: Vec<u8>,
    /// Why there was no room when it was last tried.
    no_room: Option<io::Error>,
}

impl Spool {
    pub fn new(path: &Path, out: Box<dyn Write + Send>) -> Self {
        Self { path: path.to_owned(), out, waiting: Vec::new(), no_room: None }
    }

    /// Hands these bytes on behind those that wait, as far as there is room.
    ///
    /// # Errors
    /// When the disk fails otherwise than by being full, or too much waits.
    pub fn push(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.waiting.extend_from_slice(bytes);
        let handed = self.hand_on();
        match handed {
            Err(error) if is_full(&error) && self.waiting.len() <= MOST_WAITING => self.wait_for_room(error),
            Err(error) => return Err(error),
            Ok(()) => self.go_on(),
        }
        Ok(())
    }

    /// Hands all on.
    ///
    /// # Errors
    /// When something is left for which there is no room.
    pub fn finish(&mut self) -> io::Result<()> {
        self.push(&[])?;
        let Some(error) = self.no_room.take() else { return Ok(()) };
        let missing = self.waiting.len().div_ceil(1 << 10);
        Err(io::Error::new(error.kind(), format!("{error}; the last {missing} KiB are missing")))
    }

    fn hand_on(&mut self) -> io::Result<()> {
        let mut handed = 0;
        let ended = loop {
            let left = &self.waiting[handed..];
            if left.is_empty() {
                break self.out.flush();
            }
            match self.out.write(left) {
                Ok(0) => break Err(ErrorKind::WriteZero.into()),
                Ok(written) => handed += written,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => break Err(error),
            }
        };
        self.waiting.drain(..handed);
        ended
    }

    fn wait_for_room(&mut self, error: io::Error) {
        if self.no_room.is_none() {
            let (path, most) = (self.path.display(), MOST_WAITING >> 20);
            tracing::error!("{path}: {error}; up to {most} MiB of the session wait in memory: make room");
        }
        self.no_room = Some(error);
    }

    fn go_on(&mut self) {
        if self.no_room.take().is_some() {
            tracing::warn!("{}: there is room again; nothing is missing", self.path.display());
        }
    }
}

fn is_full(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded)
}

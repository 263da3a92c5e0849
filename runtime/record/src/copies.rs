//! When the session entry is repeated, so that no single damaged place loses a log.

/// A log of this length behind its beginning has a second session entry: more than a disk or a file system loses at once, and
/// about a second of a session.
const FIRST_BEHIND: u64 = 8 << 10;
/// Further ones come with snapshots, when at least so many times the entry's length was written since: a mission of any size
/// makes logs longer by an eighth at most.
const TIMES_ITS_LENGTH: u64 = 8;

/// What was written of the session entry so far.
#[derive(Default)]
pub(crate) struct Copies {
    entry: Vec<u8>,
    count: u64,
    /// Where the newest one's segment ends.
    newest_end: u64,
    /// Whether the segment that is not sealed yet holds one.
    is_open: bool,
    /// Whether a snapshot was written since.
    snapshot: bool,
}

impl Copies {
    /// The entry, as JSON.
    pub fn entry(&self) -> Vec<u8> {
        self.entry.clone()
    }

    /// Takes note of a session entry.
    pub fn note_session(&mut self, entry: &[u8]) {
        if self.count == 0 {
            self.entry = entry.to_owned();
        }
        self.count += 1;
        self.is_open = true;
    }

    /// Takes note of a snapshot.
    pub fn note_snapshot(&mut self) {
        self.snapshot = true;
    }

    /// Takes note of the end of a segment.
    pub fn note_seal(&mut self, end: u64) {
        if std::mem::take(&mut self.is_open) {
            self.newest_end = end;
            self.snapshot = false;
        }
    }

    /// Whether the next one is to be written in a log that ends here.
    pub fn is_due(&self, end: u64) -> bool {
        let since = end - self.newest_end;
        match self.count {
            0 => false,
            1 => since >= FIRST_BEHIND,
            _ => self.snapshot && since >= TIMES_ITS_LENGTH * self.entry.len() as u64,
        }
    }

    /// Whether a log that ends here, and is not gone on with, ends with one.
    pub fn is_due_at_end(&self, end: u64) -> bool {
        self.count > 0 && end > self.newest_end
    }
}

//! One measurement, and how its processes are told of it.

use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is sent, to how many, how often.
#[derive(Clone, Debug)]
pub struct Case {
    /// Bytes of a message.
    pub bytes: usize,
    /// Subscribers, each a process of its own.
    pub subscribers: usize,
    /// Whether the sender writes and each subscriber reads every cache line of each message.
    pub touched: bool,
    /// Messages sent at the pace.
    pub count: u64,
    /// Between two of them.
    pub beat: Duration,
    /// How long messages are sent as fast as they are taken, afterwards.
    pub rush: Duration,
    /// Sockets and the board of this measurement lie here; its name is unlike that of any other.
    pub folder: PathBuf,
}

impl Case {
    /// As arguments of a process.
    pub fn arguments(&self) -> Vec<String> {
        vec![
            self.bytes.to_string(),
            self.subscribers.to_string(),
            u8::from(self.touched).to_string(),
            self.count.to_string(),
            self.beat.as_nanos().to_string(),
            self.rush.as_nanos().to_string(),
            self.folder.display().to_string(),
        ]
    }

    /// What [`Self::arguments`] gave.
    pub fn parse(arguments: &[String]) -> Option<Self> {
        let [bytes, subscribers, touched, count, beat, rush, folder] = arguments else { return None };
        let nanos = |text: &str| text.parse().ok().map(Duration::from_nanos);
        Some(Self {
            bytes: bytes.parse().ok()?,
            subscribers: subscribers.parse().ok()?,
            touched: touched == "1",
            count: count.parse().ok()?,
            beat: nanos(beat)?,
            rush: nanos(rush)?,
            folder: PathBuf::from(folder),
        })
    }

    /// The name that no other measurement has.
    pub fn name(&self) -> &str {
        self.folder.file_name().and_then(|name| name.to_str()).unwrap_or_default()
    }

    /// A file of this measurement.
    pub fn file(&self, name: &str) -> PathBuf {
        Path::new(&self.folder).join(name)
    }
}

//! What a log holds, as JSON messages of MCAP channels: a file for each kind of entry.

mod answer;
mod dialog;
mod event;
mod gap;
mod session;
mod tick;

use serde::{Deserialize, Serialize};

pub use answer::AnswerEntry;
pub use dialog::{DialogEntry, OfferEntry};
pub use event::EventEntry;
pub use gap::GapEntry;
pub use session::{Branch, SessionEntry, SessionFacts};
pub use tick::{InputEntry, TickEntry};

/// The kinds of entries, each on its own channel.
pub(crate) trait Entry: Serialize + for<'de> Deserialize<'de> {
    /// The channel's topic.
    const TOPIC: &'static str;
    /// The JSON Schema of the entries, for other tools.
    const SCHEMA: &'static str;
}

/// Stands for a value: another one has another.
#[must_use]
pub fn fingerprint(value: &(impl std::fmt::Debug + ?Sized)) -> String {
    hex(&blake3::hash(format!("{value:?}").as_bytes()).as_bytes()[..8])
}

/// A digest as a log writes it.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Whether a number is left out of its entry.
fn is_zero<N: Default + PartialEq>(number: &N) -> bool {
    *number == N::default()
}

/// A run's number, in hexadecimal: it has more bits than numbers of JSON hold exactly.
mod run {
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
    pub fn serialize<S: Serializer>(run: &u64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{run:x}"))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
        let text = std::borrow::Cow::<str>::deserialize(deserializer)?;
        u64::from_str_radix(&text, 16).map_err(D::Error::custom)
    }
}

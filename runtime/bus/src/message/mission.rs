//! The mission that a simulator plays.

use bytemuck::{Pod, Zeroable};

use super::{Malformed, layout};
use crate::text::Text;

/// What stands before a mission's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MissionHeader {
    /// The seed of all that is random.
    pub seed: u64,
    /// Length of the text, bytes.
    pub text_bytes: u32,
    /// 1 in lock-step, 0 in real time.
    pub lock_step: u32,
    /// The name of the file it came from.
    pub file: Text<254>,
}

/// A mission: its file's text, and what was chosen beyond it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissionMessage {
    /// All but the text.
    pub header: MissionHeader,
    /// The mission file's text.
    pub text: String,
}

impl MissionMessage {
    /// Bytes of the payload.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        layout::space::<MissionHeader>(1) + layout::space::<u8>(self.text.len())
    }

    /// Writes the payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(&self, payload: &mut [u8]) {
        let mut writer = layout::Writer::new(payload);
        writer.put(&[MissionHeader { text_bytes: u32::try_from(self.text.len()).unwrap_or(0), ..self.header }]);
        writer.put(self.text.as_bytes());
    }

    /// Reads a payload.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn read(payload: &[u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &MissionHeader = reader.one()?;
        let text = reader.take::<u8>(header.text_bytes)?.to_vec();
        Ok(Self { header: *header, text: String::from_utf8(text).map_err(|_| Malformed("not UTF-8"))? })
    }
}

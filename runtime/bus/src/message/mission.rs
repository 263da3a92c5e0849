//! The mission that a simulator plays.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::{BodyKind, BodyRequest};

use super::{CameraRecord, Malformed, layout, room};
use crate::text::Text;

/// What stands before a mission's text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MissionHeader {
    /// The seed of all that is random.
    pub seed: u64,
    /// Length of the text, bytes.
    pub text_bytes: u32,
    /// Bodies asked for beside the mission's.
    pub bodies: u32,
    /// 1 in lock-step, 0 in real time.
    pub lock_step: u32,
    /// Cameras that there are.
    pub cameras: u32,
    /// The name of the file it came from.
    pub file: Text<254>,
}

/// A body asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct BodyRequestRecord {
    /// `BodyKind`.
    kind: u32,
    /// Its room's id, and zeroes behind it; zeroes alone if it has none.
    room: [u8; 24],
}

impl From<&BodyRequest> for BodyRequestRecord {
    fn from(request: &BodyRequest) -> Self {
        Self { kind: request.kind as u32, room: request.room.map_or([0; 24], room::text_of) }
    }
}

impl TryFrom<&BodyRequestRecord> for BodyRequest {
    type Error = Malformed;

    fn try_from(record: &BodyRequestRecord) -> Result<Self, Malformed> {
        let kind = BodyKind::ALL.get(record.kind as usize).copied().ok_or(Malformed("no such kind of body"))?;
        let room = (record.room != [0; 24]).then(|| room::of_text(&record.room)).transpose()?;
        Ok(Self { kind, room })
    }
}

/// A mission: its file's text, and what was chosen beyond it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissionMessage {
    /// All but the lists and the text.
    pub header: MissionHeader,
    /// Bodies asked for beside the mission's, in the order of their ids.
    pub bodies: Vec<BodyRequest>,
    /// The session's cameras.
    pub cameras: Vec<CameraRecord>,
    /// The mission file's text.
    pub text: String,
}

impl MissionMessage {
    /// Bytes of the payload.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        layout::space::<MissionHeader>(1)
            + layout::space::<BodyRequestRecord>(self.bodies.len())
            + layout::space::<CameraRecord>(self.cameras.len())
            + layout::space::<u8>(self.text.len())
    }

    /// Writes the payload.
    ///
    /// # Panics
    /// When `payload` is shorter than [`Self::bytes`].
    pub fn write(&self, payload: &mut [u8]) {
        let mut writer = layout::Writer::new(payload);
        let length = |length: usize| u32::try_from(length).unwrap_or(0);
        let (text_bytes, bodies) = (length(self.text.len()), length(self.bodies.len()));
        let cameras = length(self.cameras.len());
        writer.put(&[MissionHeader { text_bytes, bodies, cameras, ..self.header }]);
        writer.put(&self.bodies.iter().map(BodyRequestRecord::from).collect::<Vec<_>>());
        writer.put(&self.cameras);
        writer.put(self.text.as_bytes());
    }

    /// Reads a payload.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn read(payload: &[u8]) -> Result<Self, Malformed> {
        let mut reader = layout::Reader::new(payload);
        let header: &MissionHeader = reader.one()?;
        let bodies = reader.take::<BodyRequestRecord>(header.bodies)?;
        let bodies = bodies.iter().map(BodyRequest::try_from).collect::<Result<_, _>>()?;
        let cameras = reader.take::<CameraRecord>(header.cameras)?.to_vec();
        let text = reader.take::<u8>(header.text_bytes)?.to_vec();
        let text = String::from_utf8(text).map_err(|_| Malformed("not UTF-8"))?;
        Ok(Self { header: *header, bodies, cameras, text })
    }
}

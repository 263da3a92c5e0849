//! Rooms in records: by their ids, where who reads a message need not know the world.

use cohabit_cdf::RoomId;

use super::Malformed;

/// A room's id, and zeroes behind it.
pub(super) fn text_of(room: RoomId) -> [u8; 24] {
    let mut text = [0; 24];
    text.iter_mut().zip(room.id().bytes()).for_each(|(to, from)| *to = from);
    text
}

/// The room with this id.
pub(super) fn of_text(text: &[u8; 24]) -> Result<RoomId, Malformed> {
    let length = text.iter().position(|byte| *byte == 0).unwrap_or(text.len());
    let id = std::str::from_utf8(&text[..length]).ok();
    id.and_then(RoomId::new).ok_or(Malformed("no such room"))
}

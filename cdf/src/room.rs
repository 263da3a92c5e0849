//! Rooms: their ids, and what a world says of each whatever the floor plan.

use std::{fmt, iter};

use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{Error as _, SeqAccess, Visitor},
};

use crate::builtin;

/// The most rooms of a world: a set of them is a number of 64 bits.
pub const MOST_ROOMS: usize = 64;

/// What a room's id is made of.
pub const ROOM_ID_RULE: &str = "write 1 to 24 letters, digits, `-` and `_`";

/// The longest id, bytes.
const LONGEST_ID: usize = 24;

/// What stands in the place of a built-in room's number in the ids of all others.
const OTHER: u8 = 8;

/// A room, by the id that floor plans and missions use.
///
/// In order, the built-in ones come first, as [`Self::BUILTIN`] has them; the others follow by their ids.
#[derive(Clone, Copy, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct RoomId {
    rank: u8,
    /// Behind its last character, zeroes.
    text: [u8; LONGEST_ID],
}

impl RoomId {
    /// Break room, kitchen.
    pub const BREAK_ROOM: Self = Self::of(0, "BreakRoom");
    /// Main office.
    pub const MAIN_OFFICE: Self = Self::of(1, "MainOffice");
    /// Small office, manager's office.
    pub const SMALL_OFFICE: Self = Self::of(2, "SmallOffice");
    /// Robotics lab.
    pub const LAB1: Self = Self::of(3, "Lab1");
    /// Quantum lab.
    pub const LAB2: Self = Self::of(4, "Lab2");
    /// Reception.
    pub const RECEPTION: Self = Self::of(5, "Reception");
    /// Warehouse.
    pub const WAREHOUSE: Self = Self::of(6, "Warehouse");
    /// Hallway.
    pub const HALLWAY: Self = Self::of(7, "Hallway");

    /// The rooms of the project's own floor plans. A world has more where world packs say so, as its catalogue tells.
    pub const BUILTIN: [Self; 8] = [
        Self::BREAK_ROOM,
        Self::MAIN_OFFICE,
        Self::SMALL_OFFICE,
        Self::LAB1,
        Self::LAB2,
        Self::RECEPTION,
        Self::WAREHOUSE,
        Self::HALLWAY,
    ];

    const fn of(rank: u8, id: &str) -> Self {
        let id = id.as_bytes();
        let mut text = [0; LONGEST_ID];
        let mut at = 0;
        while at < id.len() {
            text[at] = id[at];
            at += 1;
        }
        Self { rank, text }
    }

    /// The room with this id, whether or not a world has it; a built-in one in any case of letters (missions write
    /// `Breakroom` too). `None` for what is no id.
    #[must_use]
    pub fn new(id: &str) -> Option<Self> {
        let builtin = Self::BUILTIN.into_iter().find(|room| room.id().eq_ignore_ascii_case(id));
        let is_inner = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
        let is_id = (1..=LONGEST_ID).contains(&id.len()) && id.bytes().all(is_inner);
        builtin.or_else(|| is_id.then(|| Self::of(OTHER, id)))
    }

    /// Its id, as files have it.
    #[must_use]
    pub fn id(&self) -> &str {
        let length = self.text.iter().position(|byte| *byte == 0).unwrap_or(LONGEST_ID);
        std::str::from_utf8(&self.text[..length]).unwrap_or_default()
    }

    /// Its place in [`Self::BUILTIN`], if it is one of those.
    #[must_use]
    pub fn builtin_index(self) -> Option<u8> {
        (self.rank < OTHER).then_some(self.rank)
    }
}

impl fmt::Debug for RoomId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl fmt::Display for RoomId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl Serialize for RoomId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            return serializer.serialize_str(self.id());
        }
        // Digests and snapshots are as they were when all rooms were built in: one byte each.
        match self.builtin_index() {
            Some(index) => serializer.serialize_u8(index),
            None => (self.rank, self.text).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for RoomId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            return deserializer.deserialize_tuple(2, Compact);
        }
        let id = String::deserialize(deserializer)?;
        Self::new(&id).ok_or_else(|| D::Error::custom(format!("`{id}` is no id of a room: {ROOM_ID_RULE}")))
    }
}

/// Reads a room from a format that does not describe itself: a number, behind which the id follows if the room is not
/// built in.
struct Compact;

impl<'de> Visitor<'de> for Compact {
    type Value = RoomId;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the number of a built-in room, or the id of another one")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<RoomId, A::Error> {
        let lacking = || A::Error::custom("a room without an id");
        let rank: u8 = parts.next_element()?.ok_or_else(lacking)?;
        if let Some(room) = RoomId::BUILTIN.get(usize::from(rank)) {
            return Ok(*room);
        }
        let read = RoomId { rank, text: parts.next_element()?.ok_or_else(lacking)? };
        RoomId::new(read.id()).filter(|room| *room == read).ok_or_else(|| A::Error::custom(ROOM_ID_RULE))
    }
}

/// What a world says of a room, whatever the floor plan.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RoomEntry {
    /// Its id in floor plans and missions, such as `SmallOffice`.
    pub id: RoomId,
    /// What people read, in lower case.
    pub name: String,
    /// What people say; the name need not be repeated.
    #[serde(default)]
    pub words: Vec<String>,
    /// What people call several rooms of which they mean one, such as `lab`.
    #[serde(default)]
    pub kind: Vec<String>,
    /// Its colour on maps, `#rrggbb`; one that follows from its place in the table, if absent.
    #[serde(default)]
    pub color: Option<String>,
    /// Whether people only walk through it: nothing is put there by chance.
    #[serde(default)]
    pub corridor: bool,
    /// Whether its doors are those that security buttons work.
    #[serde(default)]
    pub secured: bool,
}

impl RoomEntry {
    /// Its name, then what people say besides.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        iter::once(&self.name).chain(&self.words).map(String::as_str)
    }

    /// Puts what a world pack says of the same room over what was said.
    fn put_over(&mut self, over: Self) {
        let Self { id: _, name, words, kind, color, corridor, secured } = over;
        // Who knows the old name may go on using it.
        let before = std::mem::replace(&mut self.name, name);
        self.words.push(before);
        self.words.extend(words);
        if !kind.is_empty() {
            self.kind = kind;
        }
        self.color = color.or_else(|| self.color.take());
        self.corridor |= corridor;
        self.secured |= secured;
    }
}

/// The rooms of a world: the built-in ones, then those of world packs, in their order. A room's index is its place here.
#[derive(Clone, Debug, PartialEq)]
pub struct Rooms(Vec<RoomEntry>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomFile {
    room: Vec<RoomEntry>,
}

impl Rooms {
    /// The rooms of the project's own floor plans.
    ///
    /// # Panics
    /// Never: the tests read the same text.
    #[must_use]
    pub fn builtin() -> Self {
        let read = |(_, text): &(&str, &str)| toml::from_str::<RoomFile>(text);
        let files: Result<Vec<RoomFile>, _> = builtin::ROOMS.iter().map(read).collect();
        Self(files.expect("invariant: the built-in rooms parse").into_iter().flat_map(|file| file.room).collect())
    }

    /// Adds a room, or says more of one that is there: its name then takes the place of the one before.
    pub(crate) fn add(&mut self, entry: RoomEntry) {
        match self.0.iter_mut().find(|known| known.id == entry.id) {
            Some(known) => known.put_over(entry),
            None => self.0.push(entry),
        }
    }

    /// All of them.
    #[must_use]
    pub fn all(&self) -> &[RoomEntry] {
        &self.0
    }

    /// The ids of all.
    pub fn ids(&self) -> impl Iterator<Item = RoomId> + Clone + '_ {
        self.0.iter().map(|entry| entry.id)
    }

    /// The ids of all as people may write them, for messages.
    #[must_use]
    pub fn listed(&self) -> String {
        self.0.iter().map(|entry| entry.id.id()).collect::<Vec<_>>().join(", ")
    }

    /// What is said of a room.
    #[must_use]
    pub fn get(&self, room: RoomId) -> Option<&RoomEntry> {
        self.index(room).and_then(|index| self.0.get(usize::from(index)))
    }

    /// The index of a room.
    #[must_use]
    pub fn index(&self, room: RoomId) -> Option<u8> {
        let place = || self.0.iter().position(|entry| entry.id == room);
        room.builtin_index().or_else(|| u8::try_from(place()?).ok())
    }

    /// The room with this index.
    #[must_use]
    pub fn at(&self, index: u32) -> Option<RoomId> {
        self.0.get(usize::try_from(index).ok()?).map(|entry| entry.id)
    }

    /// The room with this id, or with this name, in any case of letters.
    #[must_use]
    pub fn find(&self, text: &str) -> Option<RoomId> {
        let by_id = self.0.iter().find(|entry| entry.id.id().eq_ignore_ascii_case(text));
        let by_name = || self.0.iter().find(|entry| entry.name.eq_ignore_ascii_case(text));
        by_id.or_else(by_name).map(|entry| entry.id)
    }

    /// Whether people only walk through it.
    #[must_use]
    pub fn is_corridor(&self, room: RoomId) -> bool {
        self.get(room).is_some_and(|entry| entry.corridor)
    }

    /// Whether its doors are those that security buttons work.
    #[must_use]
    pub fn is_secured(&self, room: RoomId) -> bool {
        self.get(room).is_some_and(|entry| entry.secured)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn room(id: &str) -> RoomId {
        RoomId::new(id).unwrap()
    }

    #[test]
    fn the_table_begins_with_the_built_in_rooms() {
        let rooms = Rooms::builtin();
        assert!(rooms.ids().eq(RoomId::BUILTIN));
        for (index, id) in (0_u8..).zip(RoomId::BUILTIN) {
            assert_eq!((rooms.index(id), rooms.at(u32::from(index))), (Some(index), Some(id)));
        }
        assert_eq!((rooms.at(8), rooms.index(room("Attic"))), (None, None));
    }

    #[test]
    fn ids_are_short_and_plain() {
        for id in ["Lab3", "sun-lounge", "Meeting_Room_12", "x", "abcdefghijklmnopqrstuvwx"] {
            assert_eq!(room(id).id(), id);
        }
        for id in ["", "two words", "Café", "a/b", "abcdefghijklmnopqrstuvwxy"] {
            assert_eq!(RoomId::new(id), None, "{id}");
        }
        assert_eq!(RoomId::new("Breakroom"), Some(RoomId::BREAK_ROOM));
    }

    #[test]
    fn built_in_rooms_come_first_in_order() {
        let mut rooms = vec![room("Attic"), RoomId::HALLWAY, room("Annex"), RoomId::BREAK_ROOM, RoomId::LAB1];
        rooms.sort();
        let expected = [RoomId::BREAK_ROOM, RoomId::LAB1, RoomId::HALLWAY, room("Annex"), room("Attic")];
        assert_eq!(rooms, expected);
    }

    #[test]
    fn a_room_is_found_by_id_and_by_name() {
        let mut rooms = Rooms::builtin();
        let entry = "id = \"SunLounge\"\nname = \"sun lounge\"\nwords = [\"winter garden\"]";
        rooms.add(toml::from_str(entry).unwrap());
        let lounge = room("SunLounge");
        assert_eq!((rooms.index(lounge), rooms.at(8)), (Some(8), Some(lounge)));
        for text in ["SunLounge", "sunlounge", "Sun Lounge"] {
            assert_eq!(rooms.find(text), Some(lounge), "{text}");
        }
        assert_eq!((rooms.find("quantum lab"), rooms.find("attic")), (Some(RoomId::LAB2), None));
    }

    #[test]
    fn another_name_leaves_what_else_is_known_of_a_room() {
        let mut rooms = Rooms::builtin();
        rooms.add(toml::from_str("id = \"Hallway\"\nname = \"arcade\"").unwrap());
        let entry = rooms.get(RoomId::HALLWAY).unwrap();
        assert_eq!((entry.name.as_str(), entry.corridor, rooms.all().len()), ("arcade", true, 8));
        assert!(entry.names().any(|name| name == "hallway"));
    }

    #[test]
    fn files_have_ids_as_text() {
        for id in ["Lab1", "SunLounge"] {
            let text = serde_json::to_string(&room(id)).unwrap();
            assert_eq!(text, format!("\"{id}\""));
            assert_eq!(serde_json::from_str::<RoomId>(&text).unwrap(), room(id));
        }
        let error = serde_json::from_str::<RoomId>("\"a room\"").unwrap_err().to_string();
        assert!(error.contains("`a room` is no id of a room"), "{error}");
    }
}

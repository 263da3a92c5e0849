//! Which room of a world each room of a house becomes, by the table in `data/rooms.toml`.

use cohabit_cdf::{RoomEntry, RoomId};
use serde::Deserialize;

use crate::{error::HouseError, house::HouseRoom};

/// What the rooms of a type that come after the first are called.
const NUMBERED: [(&str, &str); 11] = [
    ("second", "two"),
    ("third", "three"),
    ("fourth", "four"),
    ("fifth", "five"),
    ("sixth", "six"),
    ("seventh", "seven"),
    ("eighth", "eight"),
    ("ninth", "nine"),
    ("tenth", "ten"),
    ("eleventh", "eleven"),
    ("twelfth", "twelve"),
];

/// The types of rooms.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoomTable {
    #[serde(rename = "room")]
    rooms: Vec<RoomType>,
    #[serde(rename = "floor")]
    floors: Vec<FloorMaterial>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomType {
    #[serde(rename = "type")]
    kind: String,
    ids: Vec<RoomId>,
    name: String,
    floor: (String, String),
    wall: String,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FloorMaterial {
    word: String,
    floor: (String, String),
}

/// What a room of a house becomes.
#[derive(Clone, Debug)]
pub struct NamedRoom {
    pub id: RoomId,
    /// What a world pack declares, for a room that is numbered.
    pub entry: Option<RoomEntry>,
    /// Material and colour of the floor.
    pub floor: (String, String),
    /// Colour of the walls.
    pub wall: String,
}

impl RoomTable {
    /// The project's own.
    pub fn builtin() -> Self {
        toml::from_str(include_str!("../data/rooms.toml")).expect("invariant: the table of rooms parses")
    }

    /// What the rooms of a house become, in their order.
    ///
    /// # Errors
    /// [`HouseError::Content`], if a type is unknown or there are too many rooms of one.
    pub fn named(&self, rooms: &[HouseRoom]) -> Result<Vec<NamedRoom>, HouseError> {
        let mut named = Vec::new();
        for (index, room) in rooms.iter().enumerate() {
            let kind = self.kind(room)?;
            let earlier = rooms[..index].iter().filter(|other| other.kind.eq_ignore_ascii_case(&room.kind)).count();
            named.push(NamedRoom {
                floor: self.floor(room, kind),
                wall: kind.wall.clone(),
                ..kind.nth(earlier, room)?
            });
        }
        Ok(named)
    }

    fn kind(&self, room: &HouseRoom) -> Result<&RoomType, HouseError> {
        let known = || self.rooms.iter().map(|kind| kind.kind.as_str()).collect::<Vec<_>>().join(", ");
        let unknown = || {
            let reason = format!("there is no type of rooms `{}`", room.kind);
            HouseError::at(&format!("{}/roomType", room.at), reason, format!("write one of {}", known()))
        };
        self.rooms.iter().find(|kind| kind.kind.eq_ignore_ascii_case(&room.kind)).ok_or_else(unknown)
    }

    fn floor(&self, room: &HouseRoom, kind: &RoomType) -> (String, String) {
        let name = room.floor.to_ascii_lowercase();
        let known = self.floors.iter().find(|material| name.contains(&material.word));
        known.map_or(&kind.floor, |material| &material.floor).clone()
    }
}

impl RoomType {
    /// The room that comes after so many others of its type.
    fn nth(&self, earlier: usize, room: &HouseRoom) -> Result<NamedRoom, HouseError> {
        let named = |id: RoomId, entry| NamedRoom { id, entry, floor: self.floor.clone(), wall: self.wall.clone() };
        if let Some(id) = self.ids.get(earlier) {
            return Ok(named(*id, None));
        }
        let after = earlier - self.ids.len();
        let too_many = || {
            let reason = format!("it is the {}th room of its type", earlier + 1);
            HouseError::at(&room.at, reason, format!("at most {} of one type", self.ids.len() + NUMBERED.len()))
        };
        let (ordinal, number) = NUMBERED.get(after).ok_or_else(too_many)?;
        let id =
            self.ids.first().and_then(|first| RoomId::new(&format!("{first}{}", after + 2))).ok_or_else(too_many)?;
        let entry = RoomEntry {
            id,
            name: format!("{ordinal} {}", self.name),
            words: vec![format!("{} {number}", self.name), format!("{} {}", self.name, after + 2)],
            kind: vec![self.name.clone()],
            color: None,
            corridor: id.id().starts_with(RoomId::HALLWAY.id()),
            secured: false,
        };
        Ok(named(id, Some(entry)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room(kind: &str, floor: &str) -> HouseRoom {
        let (kind, floor) = (kind.to_owned(), floor.to_owned());
        HouseRoom { at: "/rooms/7".to_owned(), id: String::new(), kind, corners_m: Vec::new(), floor }
    }

    fn named(kinds: &[&str]) -> Result<Vec<NamedRoom>, HouseError> {
        let rooms: Vec<HouseRoom> = kinds.iter().map(|kind| room(kind, "")).collect();
        RoomTable::builtin().named(&rooms)
    }

    #[test]
    fn rooms_of_one_type_are_numbered_after_those_that_there_are() {
        let rooms = named(&["Bedroom", "Kitchen", "Bedroom", "bedroom", "Bedroom", "Bathroom", "Bathroom"]).unwrap();
        let ids: Vec<&str> = rooms.iter().map(|room| room.id.id()).collect();
        assert_eq!(ids, ["Bedroom", "Kitchen", "GuestRoom", "Bedroom2", "Bedroom3", "Bathroom", "Bathroom2"]);
        assert!(rooms[..3].iter().all(|room| room.entry.is_none()));
        let entry = rooms[3].entry.as_ref().unwrap();
        assert_eq!((entry.name.as_str(), entry.kind.as_slice()), ("second bedroom", ["bedroom".to_owned()].as_slice()));
        assert_eq!(entry.words, ["bedroom two", "bedroom 2"]);
    }

    #[test]
    fn what_is_no_type_of_rooms_is_refused() {
        let said = |kinds: &[&str]| named(kinds).unwrap_err().to_string();
        assert!(said(&["Moat"]).contains("/rooms/7/roomType: there is no type of rooms `Moat`: write one of Bedroom"));
        assert!(said(&["Kitchen"; 13]).contains("the 13th room of its type: at most 12"));
    }

    #[test]
    fn a_floor_follows_from_the_name_of_its_material() {
        let table = RoomTable::builtin();
        let floor = |name: &str| table.named(&[room("Bathroom", name)]).unwrap()[0].floor.0.clone();
        assert_eq!([floor("DarkWoodFloors 2"), floor("CarpetWhite"), floor("Lava")], ["wood", "carpet", "tile"]);
    }
}

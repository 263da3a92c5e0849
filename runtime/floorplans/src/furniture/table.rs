//! The table of furniture: what belongs together, and what stands in which room. `data/office/furniture.toml` says what the fields mean.

use cohabit_cdf::RoomId;
use serde::Deserialize;

use crate::kind::Kind;

/// The files of each kind of building.
const OFFICE: &[&str] = &[include_str!("../../data/office/furniture.toml")];
const HOME: &[&str] = &[
    include_str!("../../data/home/living.toml"),
    include_str!("../../data/home/kitchen.toml"),
    include_str!("../../data/home/bedrooms.toml"),
    include_str!("../../data/home/bathrooms.toml"),
    include_str!("../../data/home/workrooms.toml"),
];

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FurnitureTable {
    #[serde(rename = "set")]
    pub sets: Vec<Set>,
    #[serde(rename = "furnishing")]
    pub furnishings: Vec<Furnishing>,
}

/// Furniture that belongs together.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Set {
    pub name: String,
    #[serde(rename = "part")]
    pub parts: Vec<Part>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Part {
    pub any: Vec<String>,
    pub share: Option<f64>,
    pub of: usize,
    pub side: Option<Side>,
    pub gap_m: f32,
    pub slide_m: f32,
    pub faces: bool,
    pub over_m: Option<f32>,
    pub on: Option<usize>,
    pub surface: Option<usize>,
    pub at_m: [f32; 2],
    /// Where a button is in front of the middle of the first part, left of it and above the floor.
    pub button_m: Option<[f32; 3]>,
    pub works: Option<usize>,
    pub turn_deg: i32,
}

#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    Front,
    Back,
    Left,
    Right,
}

/// What stands in some rooms.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Furnishing {
    pub rooms: Vec<RoomId>,
    pub items: Vec<Item>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Item {
    #[serde(default)]
    pub any: Vec<String>,
    #[serde(default)]
    pub first: Vec<String>,
    #[serde(rename = "where")]
    pub place: Place,
    pub count: [usize; 2],
    #[serde(default)]
    pub each_m2: Option<f32>,
    #[serde(default)]
    pub share: Option<f64>,
    #[serde(default)]
    pub must: bool,
    #[serde(default)]
    pub height_m: f32,
    #[serde(default)]
    pub of: Vec<String>,
    #[serde(default)]
    pub unless: Vec<String>,
}

#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Its back to a wall.
    Wall,
    /// In a corner, its back to one of the walls.
    Corner,
    /// The same, with the other wall at its left.
    LeftCorner,
    /// Free-standing.
    Middle,
    /// On a wall.
    Hung,
    /// On a wall, before a window.
    Window,
    /// Its back to the wall that another piece faces.
    Opposite,
    /// Below the middle of the ceiling.
    Ceiling,
}

impl FurnitureTable {
    /// That of a kind of building.
    pub fn of(kind: Kind) -> Self {
        let files = if kind == Kind::Office { OFFICE } else { HOME };
        files.iter().fold(Self::default(), |mut table, text| {
            let file: Self = toml::from_str(text).expect("invariant: the table of furniture parses");
            table.sets.extend(file.sets);
            table.furnishings.extend(file.furnishings);
            table
        })
    }

    /// What stands in a room; nothing, if the table does not say.
    pub fn of_room(&self, room: RoomId) -> &[Item] {
        let furnishing = self.furnishings.iter().find(|furnishing| furnishing.rooms.contains(&room));
        furnishing.map_or(&[], |furnishing| &furnishing.items)
    }

    /// The set with this name; a name that no set has is that of a class, which stands alone.
    pub fn set(&self, name: &str) -> Set {
        let single =
            || Set { name: name.to_owned(), parts: vec![Part { any: vec![name.to_owned()], ..Part::default() }] };
        self.sets.iter().find(|set| set.name == name).cloned().unwrap_or_else(single)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn check_names(kind: Kind) {
        let (catalog, table) = (kind.catalog(), FurnitureTable::of(kind));
        let names: BTreeSet<&str> = table.sets.iter().map(|set| set.name.as_str()).collect();
        assert_eq!(names.len(), table.sets.len(), "two sets of {kind} have one name");
        let is_class = |name: &String| catalog.find(name).is_some();
        for set in &table.sets {
            for part in &set.parts {
                assert!(part.any.iter().all(is_class) && !part.any.is_empty(), "{}: {:?}", set.name, part.any);
                for other in [Some(part.of), part.on, part.works].into_iter().flatten() {
                    assert!(other < set.parts.len(), "{}: there is no part {other}", set.name);
                }
            }
        }
        for item in table.furnishings.iter().flat_map(|furnishing| &furnishing.items) {
            let is_set = |name: &String| table.sets.iter().any(|set| set.name == *name);
            let named: Vec<&String> = item.any.iter().chain(&item.first).collect();
            assert!(!named.is_empty());
            for name in named {
                assert!(is_set(name) || is_class(name), "there is no `{name}`");
            }
            for name in item.of.iter().chain(&item.unless) {
                assert!(is_class(name), "there is no class `{name}`");
            }
            assert_eq!(item.place == Place::Opposite, !item.of.is_empty(), "{:?}", item.any);
        }
    }

    #[test]
    fn all_that_the_tables_name_is_there() {
        Kind::ALL.into_iter().for_each(check_names);
    }

    #[test]
    fn each_room_has_furniture() {
        for kind in Kind::ALL {
            let table = FurnitureTable::of(kind);
            let rooms = kind.rooms().rooms.into_iter().map(|room| room.id).chain([RoomId::HALLWAY]);
            rooms.for_each(|room| assert!(!table.of_room(room).is_empty(), "{kind}: {room}"));
        }
    }
}

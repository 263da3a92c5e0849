//! A world pack of imported houses, which goes with the pack `homes`.

use std::collections::BTreeMap;

use cohabit_cdf::{
    RoomEntry, RoomId, WorldData,
    room::MOST_ROOMS,
    world_pack::{HEAD, is_name},
};
use cohabit_floorplans::pack::{MOST_PLANS, look_around, room};

use crate::{error::HouseError, importer::ImportedPlan};

/// The most houses of a pack.
pub const MOST_HOUSES: usize = MOST_PLANS;

/// The longest prefix.
const LONGEST_PREFIX: usize = 24;

/// A world pack of houses, made one by one.
#[derive(Clone, Debug)]
pub struct HousePack {
    name: String,
    /// How many rooms a world has without those of this pack.
    rooms_before: usize,
    rooms: BTreeMap<RoomId, RoomEntry>,
    plans: Vec<(String, String)>,
    start: Option<(String, RoomId)>,
}

/// Whether the ids of floor plans may begin so.
///
/// # Errors
/// [`HouseError::Prefix`].
pub fn check_prefix(prefix: &str) -> Result<(), HouseError> {
    let is_inner = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_');
    let is_prefix = (1..=LONGEST_PREFIX).contains(&prefix.len()) && prefix.bytes().all(is_inner);
    if is_prefix { Ok(()) } else { Err(HouseError::Prefix { prefix: prefix.to_owned() }) }
}

/// The id of the floor plan of a house, by its number in its file.
#[must_use]
pub fn plan_id(prefix: &str, number: usize) -> String {
    format!("{prefix}{number:04}")
}

impl HousePack {
    /// An empty pack, to be loaded with `world`.
    ///
    /// # Errors
    /// [`HouseError::Name`], if no pack may be called so.
    pub fn new(name: &str, world: &WorldData) -> Result<Self, HouseError> {
        if !is_name(name) {
            return Err(HouseError::Name { name: name.to_owned() });
        }
        let rooms_before = world.catalog().rooms().all().len();
        Ok(Self { name: name.to_owned(), rooms_before, rooms: BTreeMap::new(), plans: Vec::new(), start: None })
    }

    /// Adds the floor plan of a house.
    ///
    /// # Errors
    /// [`HouseError::TooManyRooms`], if all rooms of all houses are more than a world may have.
    pub fn add(&mut self, plan: &ImportedPlan) -> Result<(), HouseError> {
        let new = plan.rooms.iter().filter(|room| !self.rooms.contains_key(&room.id)).count();
        let rooms = self.rooms_before + self.rooms.len() + new;
        if rooms > MOST_ROOMS {
            return Err(HouseError::TooManyRooms { rooms, most: MOST_ROOMS });
        }
        self.rooms.extend(plan.rooms.iter().map(|room| (room.id, room.clone())));
        self.plans.push((format!("layouts/{}.toml", plan.id), plan.text.clone()));
        self.start.get_or_insert_with(|| (plan.id.clone(), plan.start));
        Ok(())
    }

    /// How many houses it has.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.plans.len()
    }

    /// Its files, as `(path from its folder, text)`.
    #[must_use]
    pub fn files(&self) -> Vec<(String, String)> {
        let mission = self.start.as_ref().map(|(plan, room)| look_around(&self.name, plan, *room));
        std::iter::once((HEAD.to_owned(), self.head())).chain(self.plans.iter().cloned()).chain(mission).collect()
    }

    fn head(&self) -> String {
        let (name, count) = (&self.name, self.plans.len());
        let mut text = format!(
            "# Made by `cohabit import-house`. It needs the pack `homes` that comes with the program: --world homes --world {name}\n\
             # The licence is that of ProcTHOR's houses: write another one, if these are others.\n\
             name = \"{name}\"\nversion = \"0.1.0\"\nlicence = \"Apache-2.0\"\n\
             description = \"{count} floor plans of houses of ProcTHOR. Needs the pack homes.\"\n"
        );
        for entry in self.rooms.values() {
            text.push_str(&room(entry));
        }
        text
    }
}

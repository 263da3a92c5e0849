//! What can be seen in a picture of ids: which things, how much of each, and where.

use cohabit_cdf::SemanticClass;
use cohabit_cdf::room::MOST_ROOMS;

use crate::instance::{Instance, Look};
use crate::plan::{RoomSurface, SURFACE_IDS};

/// A thing that is seen in a picture.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Seen {
    /// Its id in the id plane.
    pub id: u32,
    /// What it is.
    pub class: SemanticClass,
    /// Pixels that show it.
    pub pixels: u32,
    /// `[left, top, right, bottom]` around them: the first column and row, and those after the last.
    pub bounds: [u32; 4],
}

/// What the ids of a scene stand for.
#[derive(Clone, Debug, Default)]
pub struct Classes {
    /// By id.
    instances: Vec<(u32, SemanticClass)>,
}

/// Finds what is seen in pictures. Keeps its memory from picture to picture.
#[derive(Clone, Debug)]
pub struct SeenTable {
    seen: Vec<Seen>,
    /// An open hash table: places in `seen`, or [`FREE`]; its length is a power of two.
    slots: Vec<u32>,
}

const FREE: u32 = u32::MAX;

impl RoomSurface {
    /// What kind of thing it is.
    #[must_use]
    pub const fn class(self) -> SemanticClass {
        match self {
            Self::Floor => SemanticClass::Floor,
            Self::Ceiling => SemanticClass::Ceiling,
            Self::EastWall | Self::NorthWall | Self::WestWall | Self::SouthWall => SemanticClass::Wall,
            Self::Frame => SemanticClass::Frame,
            Self::Lamp => SemanticClass::Lamp,
        }
    }
}

impl Look {
    /// What kind of thing it is.
    #[must_use]
    pub const fn class(self) -> SemanticClass {
        match self {
            Self::Object(class) | Self::Gate { class, .. } => SemanticClass::Object(class),
            Self::Robot { .. } => SemanticClass::Robot,
            Self::Person { .. } => SemanticClass::Person,
            _ => SemanticClass::Effect,
        }
    }
}

/// The index of the room, and the surface, behind an id of [`crate::room_surface_id`]; `None` for any other.
#[must_use]
pub fn room_surface_of_id(id: u32) -> Option<(u8, RoomSurface)> {
    let place = SURFACE_IDS.contains(&id).then(|| id - SURFACE_IDS.start)?;
    let room = Some((place >> 8) as u8).filter(|room| usize::from(*room) < MOST_ROOMS)?;
    Some((room, *RoomSurface::ALL.get(place as usize & 0xFF)?))
}

impl Classes {
    /// Takes over all instances of a scene.
    pub fn set(&mut self, instances: &[Instance]) {
        self.instances.clear();
        self.instances.extend(instances.iter().map(|instance| (instance.id, instance.look.class())));
        // What flows into a thing bears its id: it is a part of it, and no thing of its own.
        self.instances.sort_unstable_by_key(|(id, class)| (*id, *class == SemanticClass::Effect));
        self.instances.dedup_by_key(|(id, _)| *id);
    }

    /// What an id of the id plane stands for.
    #[must_use]
    pub fn of(&self, id: u32) -> SemanticClass {
        if let Ok(place) = self.instances.binary_search_by_key(&id, |(id, _)| *id) {
            return self.instances[place].1;
        }
        room_surface_of_id(id).map_or(SemanticClass::Unknown, |(_, surface)| surface.class())
    }

    /// How many ids there can be in a picture of so many rooms at most.
    #[must_use]
    pub fn most(&self, rooms: usize) -> usize {
        self.instances.len() + rooms * RoomSurface::ALL.len()
    }
}

impl Default for SeenTable {
    fn default() -> Self {
        Self { seen: Vec::new(), slots: vec![FREE; 256] }
    }
}

impl SeenTable {
    /// All that is seen in a picture of ids, `width` pixels a row; by id. Nothing (id 0) is no thing.
    pub fn look(&mut self, ids: &[u32], width: usize, classes: &Classes) -> &[Seen] {
        self.seen.clear();
        self.slots.fill(FREE);
        for (row, line) in ids.chunks(width.max(1)).enumerate() {
            let mut left = 0;
            while left < line.len() {
                let id = line[left];
                let right = left + run(id, &line[left..]);
                if id != 0 {
                    self.add(id, [left, right].map(|column| column as u32), row as u32);
                }
                left = right;
            }
        }
        self.seen.sort_unstable_by_key(|seen| seen.id);
        for seen in &mut self.seen {
            seen.class = classes.of(seen.id);
        }
        &self.seen
    }

    fn add(&mut self, id: u32, [left, right]: [u32; 2], row: u32) {
        let mask = self.slots.len() - 1;
        let mut slot = id.wrapping_mul(0x9E37_79B1) as usize >> 12 & mask;
        loop {
            let place = self.slots[slot];
            if place == FREE {
                break;
            }
            let seen = &mut self.seen[place as usize];
            if seen.id == id {
                seen.pixels += right - left;
                let [west, _, east, bottom] = &mut seen.bounds;
                (*west, *east, *bottom) = ((*west).min(left), (*east).max(right), row + 1);
                return;
            }
            slot = (slot + 1) & mask;
        }
        self.slots[slot] = self.seen.len() as u32;
        let bounds = [left, row, right, row + 1];
        self.seen.push(Seen { id, class: SemanticClass::Unknown, pixels: right - left, bounds });
        if self.seen.len() * 2 > self.slots.len() {
            self.grow();
        }
    }

    fn grow(&mut self) {
        let length = self.slots.len() * 2;
        self.slots.clear();
        self.slots.resize(length, FREE);
        for (place, seen) in self.seen.iter().enumerate() {
            let mut slot = seen.id.wrapping_mul(0x9E37_79B1) as usize >> 12 & (length - 1);
            while self.slots[slot] != FREE {
                slot = (slot + 1) & (length - 1);
            }
            self.slots[slot] = place as u32;
        }
    }
}

/// How often `id` stands at the beginning of a line.
fn run(id: u32, line: &[u32]) -> usize {
    let mut length = 0;
    // Eight at once, which a compiler makes one comparison of.
    let (eights, _) = line.as_chunks::<8>();
    for eight in eights {
        if eight.iter().fold(0, |differ, other| differ | (other ^ id)) != 0 {
            break;
        }
        length += 8;
    }
    length + line[length..].iter().take_while(|other| **other == id).count()
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::{ClassId, Color, Fluid, RoomId, StateFlags};
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    use super::*;
    use crate::room_surface_id;

    /// The same, pixel by pixel.
    fn plainly(ids: &[u32], width: usize) -> Vec<(u32, u32, [u32; 4])> {
        let mut all: BTreeMap<u32, (u32, [u32; 4])> = BTreeMap::new();
        for (place, id) in ids.iter().enumerate().filter(|(_, id)| **id != 0) {
            let (x, y) = ((place % width) as u32, (place / width) as u32);
            let (pixels, [left, top, right, bottom]) = all.entry(*id).or_insert((0, [x, y, x + 1, y + 1]));
            *pixels += 1;
            (*left, *top) = ((*left).min(x), (*top).min(y));
            (*right, *bottom) = ((*right).max(x + 1), (*bottom).max(y + 1));
        }
        all.into_iter().map(|(id, (pixels, bounds))| (id, pixels, bounds)).collect()
    }

    proptest! {
        #[test]
        fn runs_add_up_to_pixels(
            runs in prop::collection::vec((0_u32..40, 1_usize..30), 1..80),
            width in 1_usize..70,
            scattered in any::<bool>(),
        ) {
            // Scattered ids meet in the hash table, and make it grow.
            let id = |id: u32| if scattered && id > 0 { id << 12 | id } else { id };
            let ids: Vec<u32> = runs.iter().flat_map(|(own, length)| vec![id(*own); *length]).collect();
            let mut table = SeenTable::default();
            table.look(&[5; 9], 3, &Classes::default());
            let seen = table.look(&ids, width, &Classes::default());
            let found: Vec<_> = seen.iter().map(|seen| (seen.id, seen.pixels, seen.bounds)).collect();
            prop_assert_eq!(found, plainly(&ids, width));
        }
    }

    #[test]
    fn many_things_are_told_apart() {
        let ids: Vec<u32> = (1..=4096).map(|id| id * 4096 + 1).collect();
        let mut table = SeenTable::default();
        assert_eq!(table.look(&ids, 64, &Classes::default()).len(), 4096);
    }

    #[test]
    fn what_is_filled_stays_what_it_is_while_something_flows_into_it() {
        let of = |look| Instance {
            id: 7,
            look,
            position_m: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            scale: [1.0; 3],
            flags: StateFlags::default(),
            fluid: Fluid::Water,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: RoomId::BREAK_ROOM,
            visible: true,
        };
        let (mug, stream) = (of(Look::Object(ClassId(3))), of(Look::Stream { height_m: 0.2 }));
        let mut classes = Classes::default();
        for instances in [[mug.clone(), stream.clone()], [stream, mug]] {
            classes.set(&instances);
            assert_eq!((classes.of(7), classes.most(0)), (SemanticClass::Object(ClassId(3)), 1));
        }
    }

    #[test]
    fn surfaces_have_their_class_and_room() {
        let classes = Classes::default();
        for room in [0, 7, 8, 63] {
            for surface in RoomSurface::ALL {
                let id = room_surface_id(room, surface);
                assert_eq!(room_surface_of_id(id), Some((room, surface)));
                assert_eq!(classes.of(id), surface.class());
            }
        }
        assert_eq!((room_surface_of_id(7), classes.of(7)), (None, SemanticClass::Unknown));
        assert_eq!(room_surface_of_id(room_surface_id(64, RoomSurface::Floor)), None);
    }
}

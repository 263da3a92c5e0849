//! A floor plan with all that is in it, drawn step by step: which rooms, outline, rooms, doors, furniture, small things, places.

use std::sync::Arc;

use cohabit_cdf::{Catalog, RoomId, layout::OpeningKind};

use crate::{
    chance::Chance,
    fixtures,
    furniture::{FurnitureTable, Placed, Site, furnish},
    geometry::{Rect, Wall},
    kind::{Hallway, RoomTable},
    openings::{self, Entry, Floor, Gap},
    outline::{self, Size},
    places::{self, Note, View},
    program::{self, Wanted},
    rooms,
    things::{Thing, ThingTable},
};

/// Outlines that are tried for the same rooms.
const OUTLINES: usize = 400;
/// Ways in which a room is furnished before the plan is given up.
const FURNISHINGS: usize = 8;
/// Rooms of a circuit.
pub const CIRCUIT: usize = 5;

/// The tables that floor plans are drawn from.
#[derive(Clone, Debug)]
pub(crate) struct Tables {
    pub catalog: Arc<Catalog>,
    pub rooms: RoomTable,
    pub furniture: FurnitureTable,
    pub things: ThingTable,
}

/// A room with all that is in it.
#[derive(Clone, Debug)]
pub struct Room {
    /// Which.
    pub id: RoomId,
    /// Its floor.
    pub rects: Vec<Rect>,
    /// Material and colour of its floor.
    pub floor: (String, String),
    /// Colour of its walls.
    pub wall: String,
    /// The circuit that feeds it.
    pub circuit: u8,
    /// What stands on its floor and hangs on its walls.
    pub furniture: Vec<Placed>,
    /// What is on and in that.
    pub things: Vec<Thing>,
    /// Where to stand and look from.
    pub views: Vec<View>,
    /// Where notes can be stuck.
    pub notes: Vec<Note>,
}

/// A floor plan.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Its rooms.
    pub rooms: Vec<Room>,
    /// The doors, passages and windows in their walls.
    pub gaps: Vec<Gap>,
}

/// The bare floor of a building: its rooms, the hallway first if there is one, and the gaps in their walls.
struct Shell<'a> {
    floors: Vec<Floor>,
    /// What each room is; nothing for the hallway.
    wanted: Vec<Option<Wanted<'a>>>,
    gaps: Vec<Gap>,
    entry: Option<Entry>,
}

impl Draft {
    /// Draws a plan of so many rooms, without a hallway; nothing, if what was drawn does not go together.
    pub(crate) fn draw(tables: &Tables, count: usize, chance: &mut Chance) -> Option<Self> {
        let wanted = program::draw(&tables.rooms.rooms, count, chance);
        let shell = Shell::draw(tables, &wanted, chance)?;
        let boxes = fuse_boxes(&shell, chance);
        let mut drawn = Vec::new();
        for room in 0..shell.floors.len() {
            drawn.push(shell.furnished(room, boxes.contains(&room), tables, chance)?);
        }
        Some(Self { rooms: drawn, gaps: shell.gaps })
    }
}

/// The rooms with a fuse box, one of each circuit.
fn fuse_boxes(shell: &Shell<'_>, chance: &mut Chance) -> Vec<usize> {
    let count = shell.floors.len();
    let in_circuit = |circuit: usize, chance: &mut Chance| {
        let first = circuit * CIRCUIT;
        // The hallway is the first room, and where people look for it.
        let aside =
            if circuit == 0 && shell.wanted[0].is_none() { 0 } else { chance.below(CIRCUIT.min(count - first)) };
        first + aside
    };
    (0..count.div_ceil(CIRCUIT)).map(|circuit| in_circuit(circuit, chance)).collect()
}

impl<'a> Shell<'a> {
    /// Outline, rooms, doors and windows.
    fn draw(tables: &Tables, wanted: &[Wanted<'a>], chance: &mut Chance) -> Option<Self> {
        let hallway = &tables.rooms.hallway;
        let size = Size {
            rooms: wanted.len(),
            area_m2: wanted.iter().map(floor_m2).sum(),
            least: wanted.iter().map(|wanted| wanted.room.least()).max()?,
            hallway: (chance.between(hallway.width_m[0], hallway.width_m[1]) * 10.0).round() as i32,
        };
        (0..OUTLINES).find_map(|_| {
            let outline = outline::draw(size, chance);
            let rects = rooms::divide(&outline, wanted, chance)?;
            let rooms = wanted.iter().zip(rects).map(|(wanted, rects)| {
                (Some(*wanted), Floor { rects, through: wanted.room.through, openness: wanted.room.openness })
            });
            let hallway = Floor { rects: outline.hallway, through: true, openness: Hallway::OPENNESS };
            let hallway = (!hallway.rects.is_empty()).then_some((None, hallway));
            let (wanted, floors): (Vec<_>, Vec<_>) = hallway.into_iter().chain(rooms).unzip();
            Self::with_openings(tables, wanted, floors, chance)
        })
    }

    fn with_openings(
        tables: &Tables,
        wanted: Vec<Option<Wanted<'a>>>,
        floors: Vec<Floor>,
        chance: &mut Chance,
    ) -> Option<Self> {
        let mut gaps = openings::join(&floors, 0, chance)?;
        let door = &tables.rooms.entrance;
        let width_m = tables.catalog.find(&door.class).map(|class| tables.catalog.class(class).size_m[1])?;
        let width = (width_m * 10.0).round() as i32;
        let at = |id: &RoomId| wanted.iter().position(|wanted| room_id(wanted) == *id);
        let entry =
            door.rooms.iter().filter_map(at).find_map(|room| openings::entry(&floors, &gaps, room, width, chance));
        gaps.extend(openings::windows(&floors, entry, tables.rooms.window.width(), chance));
        Some(Self { floors, wanted, gaps, entry })
    }

    /// A room with its furniture and all that goes with it.
    fn furnished(&self, room: usize, has_fuse_box: bool, tables: &Tables, chance: &mut Chance) -> Option<Room> {
        let site = self.site(room, has_fuse_box, tables, chance)?;
        let id = room_id(&self.wanted[room]);
        let (floors, walls) = match &self.wanted[room] {
            Some(wanted) => (&wanted.room.floors, &wanted.room.walls),
            None => (&tables.rooms.hallway.floors, &tables.rooms.hallway.walls),
        };
        let (floor, wall) = (chance.pick(floors)?.clone(), chance.pick(walls)?.clone());
        let circuit = u8::try_from(room / CIRCUIT + 1).ok()?;
        let items = tables.furniture.of_room(id);
        let door = self.gaps.iter().find(|gap| gap.is_way() && gap.between.contains(&room));
        (0..FURNISHINGS).find_map(|_| {
            let mut site = site.clone();
            if !furnish(&mut site, items, &tables.furniture, chance) {
                return None;
            }
            let (views, notes) = (places::views(&site, door, room)?, places::notes(&site)?);
            let things = tables.things.fill(&site.placed, id, &tables.catalog, chance);
            let (floor, wall, rects) = (floor.clone(), wall.clone(), site.rects);
            Some(Room { id, rects, floor, wall, circuit, furniture: site.placed, things, views, notes })
        })
    }

    /// The room with what it has for certain.
    fn site<'t>(&self, room: usize, has_fuse_box: bool, tables: &'t Tables, chance: &mut Chance) -> Option<Site<'t>> {
        let own = self.gaps.iter().filter(|gap| gap.between.contains(&room));
        let (windows, ways): (Vec<&Gap>, Vec<&Gap>) = own.partition(|gap| gap.kind == OpeningKind::Window);
        let place = |gap: &&Gap| (gap.wall_of(room), gap.middle);
        let doors: Vec<(Wall, i32)> = ways.iter().map(place).collect();
        let kept_free = fixtures::kept_free(room, &self.gaps, self.entry);
        let mut site = Site::new(&tables.catalog, &self.floors[room].rects, &doors, kept_free);
        site.windows = windows.iter().map(place).collect();
        let entry = self.entry.filter(|entry| entry.room == room);
        let has_entry =
            entry.is_none_or(|entry| fixtures::add_entry(&mut site, &tables.rooms.entrance.class, entry, chance));
        let is_whole = has_entry
            && fixtures::add_switch(&mut site, room, &self.gaps, entry, chance)
            && (!has_fuse_box || fixtures::add_fuse_box(&mut site, chance));
        is_whole.then_some(site)
    }
}

/// The floor of a room that has some depth along a hallway.
fn floor_m2(wanted: &Wanted<'_>) -> f32 {
    /// The usual depth of rooms, m.
    const DEPTH_M: f32 = 4.2;
    wanted.area_m2.max(wanted.room.least_m * DEPTH_M)
}

/// The id of a room; that of the hallway, if it is not one of those that are wanted.
fn room_id(wanted: &Option<Wanted<'_>>) -> RoomId {
    wanted.map_or(RoomId::HALLWAY, |wanted| wanted.room.id)
}

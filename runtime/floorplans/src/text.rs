//! A floor plan as the text of its file, in the format of `cohabit-cdf`.

use std::{collections::BTreeMap, fmt::Write as _};

use cohabit_cdf::{Catalog, ClassId, layout::OpeningKind, model::Axis};

use crate::{
    draft::{Draft, Room},
    fixtures::{FUSE_BOX, LIGHT_SWITCH},
    furniture::{Placed, WALL_HEIGHT_M},
    geometry::{metres, rounded},
    openings::Gap,
    things::Thing,
};

/// The class of doors.
const DOOR: &str = "Door_01";
/// The first number of instances, as the built-in floor plans have them: lower ones are those of missions.
const FIRST: u32 = 10_000;

/// Names of instances: numbers in the order in which they are asked for.
struct Names<'a> {
    catalog: &'a Catalog,
    next: BTreeMap<ClassId, u32>,
}

impl Names<'_> {
    fn name(&mut self, class: ClassId) -> String {
        let id = &self.catalog.class(class).id;
        let first = if [LIGHT_SWITCH, FUSE_BOX].contains(&id.as_str()) { 1 } else { FIRST };
        let number = self.next.entry(class).or_insert(first);
        *number += 1;
        format!("{id}_{}", *number - 1)
    }
}

/// The text of a floor plan's file.
pub fn text(draft: &Draft, about: &str, catalog: &Catalog) -> String {
    let mut text = format!("# {about}\n\nwall_height_m = {WALL_HEIGHT_M:?}\n\nroom = [\n");
    for room in &draft.rooms {
        text.push_str(&room_entry(room));
    }
    text.push_str("]\n\nopening = [\n");
    let doors = draft.gaps.iter().filter(|gap| gap.kind == OpeningKind::Door);
    let mut numbers = 1..=doors.count();
    for gap in &draft.gaps {
        let number = (gap.kind == OpeningKind::Door).then(|| numbers.next()).flatten();
        text.push_str(&opening_entry(gap, number, &draft.rooms));
    }
    text.push_str("]\n\nplacement = [\n");
    let mut names = Names { catalog, next: BTreeMap::new() };
    for room in &draft.rooms {
        text.push_str(&placements(room, &mut names));
    }
    text.push_str("]\n\nviewpoint = [\n");
    for room in &draft.rooms {
        for (number, view) in (1..).zip(&room.views) {
            let (id, at, yaw) = (room.id, numbers_of(&view.at_m), view.yaw_deg);
            let _ = writeln!(text, "  {{ room = \"{id}\", number = {number}, at_m = {at}, yaw_deg = {yaw:?} }},");
        }
    }
    text.push_str("]\n\nnote_place = [\n");
    for room in &draft.rooms {
        for note in &room.notes {
            let (id, at, yaw) = (room.id, numbers_of(&note.at_m), note.yaw_deg);
            let _ = writeln!(text, "  {{ room = \"{id}\", at_m = {at}, yaw_deg = {yaw:?} }},");
        }
    }
    text.push_str("]\n");
    text
}

/// `[1.0, 2.5]`.
fn numbers_of(numbers: &[f32]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{:?}", plain(*number))).collect();
    format!("[{}]", numbers.join(", "))
}

/// To the millimetre, and without a sign before 0.
fn plain(number: f32) -> f32 {
    rounded(number) + 0.0
}

fn room_entry(room: &Room) -> String {
    let rects = room.rects.iter().map(|r| numbers_of(&[r.west, r.south, r.east, r.north].map(metres)));
    let rects = rects.collect::<Vec<_>>().join(", ");
    let Room { id, floor: (material, color), wall, circuit, .. } = room;
    format!(
        "  {{ id = \"{id}\", rects_m = [{rects}], floor = {{ material = \"{material}\", color = \"{color}\" }}, \
         wall = {{ material = \"plain\", color = \"{wall}\" }}, circuit = {circuit} }},\n"
    )
}

fn opening_entry(gap: &Gap, door: Option<usize>, rooms: &[Room]) -> String {
    let kind = match gap.kind {
        OpeningKind::Door => "door",
        OpeningKind::Passage => "passage",
        OpeningKind::Window => "window",
    };
    let door = door.map_or_else(String::new, |number| format!(" door = \"{DOOR}_{number}\","));
    let [one, other] = gap.between.map(|room| rooms[room].id);
    let at = numbers_of(&gap.wall.point(metres(gap.middle), 0.0));
    let runs = if gap.wall.axis() == Axis::X { "x" } else { "y" };
    let width = plain(metres(gap.width));
    format!(
        "  {{ kind = \"{kind}\",{door} between = [\"{one}\", \"{other}\"], at_m = {at}, width_m = {width:?}, \
         wall_runs = \"{runs}\" }},\n"
    )
}

/// The furniture and the things of a room, holders before what they hold.
fn placements(room: &Room, names: &mut Names<'_>) -> String {
    let furniture: Vec<String> = room.furniture.iter().map(|placed| names.name(placed.class)).collect();
    let mut text = String::new();
    for (placed, name) in room.furniture.iter().zip(&furniture) {
        text.push_str(&furniture_entry(room, placed, name, &furniture));
    }
    for thing in &room.things {
        text.push_str(&thing_entry(room, thing, &names.name(thing.class), &furniture[thing.holder]));
    }
    text
}

fn furniture_entry(room: &Room, placed: &Placed, name: &str, furniture: &[String]) -> String {
    let on = placed.on.map_or_else(String::new, |on| format!(" on = \"{}\",", furniture[on]));
    let works = placed.works.map_or_else(String::new, |works| format!(", works = \"{}\"", furniture[works]));
    let (id, at, yaw) = (room.id, numbers_of(&placed.at_m), placed.turn.yaw_deg());
    format!("  {{ instance = \"{name}\", room = \"{id}\",{on} at_m = {at}, yaw_deg = {yaw:?}{works} }},\n")
}

fn thing_entry(room: &Room, thing: &Thing, name: &str, holder: &str) -> String {
    let place = thing.at_m.map_or_else(|| "anchor = true".to_owned(), |at| format!("at_m = {}", numbers_of(&at)));
    let (id, yaw) = (room.id, plain(thing.yaw_deg));
    format!("  {{ instance = \"{name}\", room = \"{id}\", on = \"{holder}\", {place}, yaw_deg = {yaw:?} }},\n")
}

//! Doors and passages between rooms, windows to the outside, and where people come in. Knows no furniture.

use cohabit_cdf::layout::OpeningKind;

use crate::{
    chance::Chance,
    geometry::{Rect, Turn, Wall, outer_walls, shared, walls},
};

/// Width of a door, dm.
const DOOR: i32 = 10;
/// Width of a passage, dm.
const PASSAGE: i32 = 16;
/// The shortest wall that two rooms share for a passage, dm.
const PASSAGE_WALL: i32 = 26;
/// From the middle of a door or passage to the end of its wall, beside half of its width, dm.
const END: i32 = 2;
/// The middles of two doors of a room are so far apart, dm.
const APART: i32 = 14;
/// Tries to find a place for a door.
const TRIES: usize = 12;
/// The share of walls that have windows.
const WINDOWS: f64 = 0.75;

/// What doors need to know of a room.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Its rectangles.
    pub rects: Vec<Rect>,
    /// Whether other rooms may be reached through it.
    pub through: bool,
    /// How likely a passage leads to it.
    pub openness: f64,
}

/// A gap in a wall between two rooms, or to the outside.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Door, passage or window.
    pub kind: OpeningKind,
    /// The rooms on both sides, the southern or western one first; a window has the same one twice.
    pub between: [usize; 2],
    /// The wall, as the second room sees it.
    pub wall: Wall,
    /// Where along the wall its middle is, dm.
    pub middle: i32,
    /// Its width, dm.
    pub width: i32,
}

/// Where people come in: a place at an outer wall.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The room, by its place in the list.
    pub room: usize,
    /// The outer wall.
    pub wall: Wall,
    /// Where along the wall its middle is, dm.
    pub middle: i32,
    /// Its width, dm.
    pub width: i32,
}

/// A wall that two rooms share.
#[derive(Clone, Copy, Debug)]
pub struct Border {
    /// The rooms on both sides, the southern or western one first.
    pub between: [usize; 2],
    /// The wall, as the second room sees it.
    pub wall: Wall,
}

impl Gap {
    /// The same wall, as one of its rooms sees it.
    pub fn wall_of(&self, room: usize) -> Wall {
        if room == self.between[1] { self.wall } else { Wall { faces: self.wall.faces.back(), ..self.wall } }
    }

    /// Whether it is walked through.
    pub fn is_way(&self) -> bool {
        self.kind != OpeningKind::Window
    }

    fn point(&self) -> [i32; 2] {
        point(self.wall, self.middle)
    }
}

/// Where a place of a wall is, dm.
fn point(wall: Wall, along: i32) -> [i32; 2] {
    if wall.axis() == cohabit_cdf::model::Axis::X { [along, wall.at] } else { [wall.at, along] }
}

/// Joins all rooms by doors and passages, from the first one on: directly, or through rooms that may be walked through.
pub fn join(floors: &[Floor], first: usize, chance: &mut Chance) -> Option<Vec<Gap>> {
    let borders = borders(floors, DOOR + 2 * END);
    let mut gaps: Vec<Gap> = Vec::new();
    let mut joined = vec![first];
    while joined.len() < floors.len() {
        // What was joined first is tried first: the hallway, if there is one.
        let leads_on = |border: &&Border, from: usize| {
            border.between.contains(&from) && border.between.iter().any(|room| !joined.contains(room))
        };
        let from = |from: &usize| -> Vec<Border> {
            let is_open = *from == first || floors[*from].through;
            borders.iter().filter(|border| is_open && leads_on(border, *from)).copied().collect()
        };
        let options = joined.iter().map(from).find(|options| !options.is_empty())?;
        let border = *chance.pick(&options)?;
        let next = border.between.into_iter().find(|room| !joined.contains(room))?;
        gaps.push(open(&options, next, floors, &gaps, chance)?);
        joined.push(next);
    }
    gaps.extend(loops(&borders, floors, &gaps, chance));
    Some(gaps)
}

/// A door or a passage to a room, in one of the walls that lead there.
fn open(options: &[Border], to: usize, floors: &[Floor], gaps: &[Gap], chance: &mut Chance) -> Option<Gap> {
    let mut leading: Vec<Border> = options.iter().filter(|border| border.between.contains(&to)).copied().collect();
    leading.sort_by_key(|border| std::cmp::Reverse(border.wall.length()));
    leading.into_iter().find_map(|border| gap_in(border, floors, gaps, chance))
}

/// Second ways between rooms that may be walked through.
fn loops(borders: &[Border], floors: &[Floor], gaps: &[Gap], chance: &mut Chance) -> Vec<Gap> {
    let mut more: Vec<Gap> = Vec::new();
    for border in borders {
        let all: Vec<Gap> = gaps.iter().chain(&more).copied().collect();
        let is_there = all.iter().any(|gap| gap.between == border.between);
        let is_open = border.between.iter().all(|room| floors[*room].through);
        if is_open && !is_there && chance.is(0.4) {
            more.extend(gap_in(*border, floors, &all, chance));
        }
    }
    more
}

fn gap_in(border: Border, floors: &[Floor], gaps: &[Gap], chance: &mut Chance) -> Option<Gap> {
    let [one, other] = border.between.map(|room| floors[room].openness);
    let is_passage = border.wall.length() >= PASSAGE_WALL && chance.is(one * other);
    let (kind, width) = if is_passage { (OpeningKind::Passage, PASSAGE) } else { (OpeningKind::Door, DOOR) };
    let Wall { from, to, .. } = border.wall;
    let (from, to) = (from + END + width / 2, to - END - width / 2);
    for _ in 0..TRIES {
        // A door near a corner leaves the wall to furniture.
        let middle = match chance.below(4) {
            0 => from + chance.whole(0, 3),
            1 => to - chance.whole(0, 3),
            _ => chance.whole(from, to),
        };
        let gap = Gap { kind, between: border.between, wall: border.wall, middle: middle.clamp(from, to), width };
        if gaps.iter().all(|other| is_apart(&gap, other)) {
            return Some(gap);
        }
    }
    None
}

/// Whether two doors of one room leave each other room to open; those of opposite walls do.
fn is_apart(one: &Gap, other: &Gap) -> bool {
    let is_of_both = one.between.iter().any(|room| other.between.contains(room));
    let is_opposite = one.wall.axis() == other.wall.axis() && one.wall.at != other.wall.at;
    let ([x, y], [other_x, other_y]) = (one.point(), other.point());
    let reach = (one.width + other.width) / 2 - DOOR + APART;
    !is_of_both || is_opposite || (x - other_x).abs().max((y - other_y).abs()) >= reach
}

/// All walls that two rooms share, of `least` dm or more.
pub fn borders(floors: &[Floor], least: i32) -> Vec<Border> {
    let mut all = Vec::new();
    for (first, one) in floors.iter().enumerate() {
        for (second, other) in floors.iter().enumerate().filter(|(second, _)| *second != first) {
            let pairs = walls(&one.rects).into_iter().flat_map(|wall| {
                walls(&other.rects).into_iter().filter_map(move |seen| Some((seen, shared(wall, seen)?)))
            });
            // Each is found from both sides, and kept as the northern or eastern room sees it.
            let kept = pairs
                .filter(|(seen, (from, to))| [Turn::NORTH, Turn::EAST].contains(&seen.faces) && to - from >= least);
            all.extend(
                kept.map(|(seen, (from, to))| Border { between: [first, second], wall: Wall { from, to, ..seen } }),
            );
        }
    }
    all
}

/// A place for the door to the outside in a room, if it has a wall for one.
pub fn entry(floors: &[Floor], gaps: &[Gap], room: usize, width: i32, chance: &mut Chance) -> Option<Entry> {
    let long: Vec<Wall> =
        outer(floors, room).into_iter().filter(|wall| wall.length() >= width + 2 * END + DOOR / 2).collect();
    for _ in 0..TRIES {
        let wall = *chance.pick(&long)?;
        let margin = END + width / 2 + 1;
        let middle = chance.whole(wall.from + margin, wall.to - margin);
        let [x, y] = point(wall, middle);
        let own = gaps.iter().filter(|gap| gap.between.contains(&room));
        let is_free = |gap: &Gap| {
            let [other_x, other_y] = gap.point();
            (x - other_x).abs().max((y - other_y).abs()) >= (width + gap.width) / 2 + 4
        };
        if own.into_iter().all(is_free) {
            return Some(Entry { room, wall, middle, width });
        }
    }
    None
}

/// The walls of a room behind which no other one is.
pub fn outer(floors: &[Floor], room: usize) -> Vec<Wall> {
    let others = floors.iter().enumerate().filter(|(index, _)| *index != room);
    let others: Vec<Wall> = others.flat_map(|(_, floor)| walls(&floor.rects)).collect();
    outer_walls(&walls(&floors[room].rects), &others)
}

/// Windows in the outer walls of all rooms, beside where people come in.
pub fn windows(floors: &[Floor], entry: Option<Entry>, width: [i32; 2], chance: &mut Chance) -> Vec<Gap> {
    let mut all = Vec::new();
    for room in 0..floors.len() {
        for wall in outer(floors, room) {
            if chance.is(WINDOWS) {
                all.extend(
                    windows_in(wall, room, width, chance).filter(|gap| entry.is_none_or(|entry| is_beside(gap, entry))),
                );
            }
        }
    }
    all
}

/// Windows at equal distances along a wall, of an even width from and to.
fn windows_in(
    wall: Wall,
    room: usize,
    [narrowest, widest]: [i32; 2],
    chance: &mut Chance,
) -> impl Iterator<Item = Gap> + use<> {
    let width = chance.whole(narrowest / 2, widest / 2) * 2;
    let count = (wall.length() - 6) / (width + 14);
    (0..count).map(move |index| {
        let middle = wall.from + wall.length() * (2 * index + 1) / (2 * count);
        Gap { kind: OpeningKind::Window, between: [room, room], wall, middle, width }
    })
}

fn is_beside(window: &Gap, entry: Entry) -> bool {
    let is_same = window.between[0] == entry.room && window.wall == entry.wall;
    !is_same || (window.middle - entry.middle).abs() >= (window.width + entry.width) / 2 + 3
}

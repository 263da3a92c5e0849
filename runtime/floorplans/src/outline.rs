//! The outline of a building: a rectangle or an L, with a hallway where there are many rooms. Knows no rooms, but how much floor
//! they want.

use cohabit_cdf::model::Axis;

use crate::{chance::Chance, geometry::Rect};

/// From that many rooms on, they lie along a hallway.
const HALLWAY_FROM: usize = 4;
/// From that many rooms on, the hallway may have a bend.
const BEND_FROM: usize = 6;
/// The longest straight hallway, dm.
const LONGEST_HALLWAY: f32 = 260.0;

/// What a building is asked to hold.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Rooms, without a hallway.
    pub rooms: usize,
    /// Floor of all rooms, m².
    pub area_m2: f32,
    /// The shortest side of the room that needs the longest one, dm.
    pub least: i32,
    /// Width of a hallway, dm.
    pub hallway: i32,
}

/// A part of the floor that rooms share.
#[derive(Clone, Debug)]
pub struct Zone {
    /// One rectangle; two, where one room has all of it.
    pub rects: Vec<Rect>,
    /// The axis along which rooms lie side by side; either, if absent.
    pub along: Option<Axis>,
    /// Whether one room has all of it.
    pub whole: bool,
}

/// The floor of a building.
#[derive(Clone, Debug)]
pub struct Outline {
    pub zones: Vec<Zone>,
    /// The rectangles of the hallway; none, if there is no hallway.
    pub hallway: Vec<Rect>,
}

impl Zone {
    const fn of(rects: Vec<Rect>, along: Option<Axis>) -> Self {
        Self { rects, along, whole: false }
    }

    fn along_x(west: i32, south: i32, east: i32, north: i32) -> Self {
        Self::of(vec![Rect::new(west, south, east, north)], Some(Axis::X))
    }

    fn along_y(west: i32, south: i32, east: i32, north: i32) -> Self {
        Self::of(vec![Rect::new(west, south, east, north)], Some(Axis::Y))
    }
}

/// Draws an outline of about the size that is asked for.
pub fn draw(size: Size, chance: &mut Chance) -> Outline {
    let outline = match size.rooms {
        rooms if rooms < HALLWAY_FROM => without_hallway(size, chance),
        rooms if rooms >= BEND_FROM && chance.is(0.5) => with_bend(size, chance),
        _ => with_straight_hallway(size, chance),
    };
    outline.turned(chance.is(0.5), chance.is(0.5), chance.is(0.5))
}

fn without_hallway(size: Size, chance: &mut Chance) -> Outline {
    let zones = if chance.is(0.4) { wings(size, chance) } else { vec![Zone::of(vec![block(size, chance)], None)] };
    Outline { zones, hallway: Vec::new() }
}

/// One rectangle.
fn block(size: Size, chance: &mut Chance) -> Rect {
    let width = (size.area_m2 * chance.between(1.0, 1.6)).sqrt() * 10.0;
    Rect::new(0, 0, width as i32, (size.area_m2 * 100.0 / width) as i32)
}

/// Two rectangles that make an L.
fn wings(size: Size, chance: &mut Chance) -> Vec<Zone> {
    let area = size.area_m2 * 100.0;
    let first = area * chance.between(0.55, 0.7);
    let width = (first * chance.between(1.3, 1.8)).sqrt();
    let depth = first / width;
    let second = width * chance.between(0.5, 0.7);
    let [width, depth, second, top] = [width, depth, second, depth + (area - first) / second].map(|dm| dm as i32);
    let rects = [Rect::new(0, 0, width, depth), Rect::new(0, depth, second, top)];
    if size.rooms == 1 {
        return vec![Zone { rects: rects.to_vec(), along: None, whole: true }];
    }
    rects.into_iter().map(|rect| Zone::of(vec![rect], None)).collect()
}

/// Depths of the rooms on two sides of a hallway, dm: one is deep enough for each room.
fn depths(size: Size, chance: &mut Chance) -> [i32; 2] {
    let deep = size.least.max(38) + chance.whole(0, 12);
    [deep, chance.whole(36, deep.max(40))]
}

fn with_straight_hallway(size: Size, chance: &mut Chance) -> Outline {
    let (area, hall) = (size.area_m2 * 100.0, size.hallway);
    let [south, north] = depths(size, chance);
    let is_single = size.rooms < BEND_FROM && chance.is(0.3);
    let north = if is_single { 0 } else { north };
    let depth = south + hall + north;
    let has_end = !is_single && chance.is(0.4);
    let end = if has_end { size.least.max(36) + chance.whole(0, 10) } else { 0 };
    let length = (area - (end * depth) as f32) / (south + north) as f32;
    let length = length.clamp(60.0, LONGEST_HALLWAY) as i32;
    let mut zones = vec![Zone::along_x(0, 0, length, south)];
    if !is_single {
        zones.push(Zone::along_x(0, south + hall, length, depth));
    }
    if has_end {
        zones.push(Zone { whole: true, ..Zone::along_y(length, 0, length + end, depth) });
    }
    Outline { zones, hallway: vec![Rect::new(0, south, length, south + hall)] }
}

/// A hallway with a bend, in an L: a long wing, and a wing north of its western half.
fn with_bend(size: Size, chance: &mut Chance) -> Outline {
    let (area, hall) = (size.area_m2 * 100.0, size.hallway);
    let [south, east] = depths(size, chance);
    let west = if chance.is(0.4) { 0 } else { chance.whole(36, 46) };
    let north = chance.whole(36, 46);
    let wing = west + hall + east;
    let beside = if chance.is(0.3) { 0 } else { chance.whole(46, 90) };
    let rest = |beside: i32| area - (wing * south + beside * (south + north)) as f32;
    // What would make the wing too long is beside it.
    let over = (rest(beside) - LONGEST_HALLWAY * (west + east) as f32) / (south + north) as f32;
    let beside = if over > 0.0 { (beside + over as i32).max(46) } else { beside };
    let up = (rest(beside) / (west + east) as f32).clamp(46.0, LONGEST_HALLWAY) as i32;
    let length = wing + beside;
    let foot = south + hall;
    let mut zones = vec![Zone::along_x(0, 0, length, south), Zone::along_y(west + hall, foot, wing, foot + up)];
    if west > 0 {
        zones.push(Zone::along_y(0, foot, west, foot + up));
    }
    if beside > 0 {
        zones.push(Zone::along_x(wing, foot, length, foot + north));
    }
    let hallway = vec![Rect::new(0, south, length, foot), Rect::new(west, foot, west + hall, foot + up)];
    Outline { zones, hallway }
}

impl Outline {
    /// Mirrored, and with its axes exchanged; its south-western corner is at the origin again.
    fn turned(mut self, mirror_x: bool, mirror_y: bool, exchange: bool) -> Self {
        let [width, depth] = self.extent();
        let turn = |rect: &mut Rect| {
            if mirror_x {
                (rect.west, rect.east) = (width - rect.east, width - rect.west);
            }
            if mirror_y {
                (rect.south, rect.north) = (depth - rect.north, depth - rect.south);
            }
            if exchange {
                *rect = Rect::new(rect.south, rect.west, rect.north, rect.east);
            }
        };
        self.zones.iter_mut().flat_map(|zone| &mut zone.rects).chain(&mut self.hallway).for_each(turn);
        for zone in self.zones.iter_mut().filter(|_| exchange) {
            zone.along = zone.along.map(|axis| if axis == Axis::X { Axis::Y } else { Axis::X });
        }
        self
    }

    /// Its eastern and northern end, dm.
    fn extent(&self) -> [i32; 2] {
        let rects = self.zones.iter().flat_map(|zone| &zone.rects).chain(&self.hallway);
        rects.fold([0, 0], |[east, north], rect| [east.max(rect.east), north.max(rect.north)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_has_about_the_floor_that_is_asked_for() {
        let mut chance = Chance::new(1, 0);
        for rooms in 1..=12 {
            for _ in 0..50 {
                let size = Size { rooms, area_m2: rooms as f32 * 20.0, least: 40, hallway: 20 };
                let outline = draw(size, &mut chance);
                let area: f32 = outline.zones.iter().flat_map(|zone| &zone.rects).map(|rect| rect.area_m2()).sum();
                assert!(area > 0.7 * size.area_m2 && area < 1.7 * size.area_m2, "{rooms} rooms: {area} m²");
                assert_eq!(outline.hallway.is_empty(), rooms < HALLWAY_FROM);
                let all = outline.zones.iter().flat_map(|zone| &zone.rects).chain(&outline.hallway);
                assert!(all.clone().all(|rect| rect.west >= 0 && rect.south >= 0 && rect.least() > 0));
            }
        }
    }
}

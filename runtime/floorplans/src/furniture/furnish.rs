//! Furnishes a room by the table: along its walls, in its corners and in its middle.

use cohabit_cdf::model::Axis;

use super::{
    arrange::Arrangement,
    site::{Site, WALL_HEIGHT_M},
    table::{FurnitureTable, Item, Place},
};
use crate::{
    chance::Chance,
    geometry::{Block, HALF_WALL_M, Turn, Wall, bounds, metres},
};

/// Between the back of furniture and a wall, m.
const BEHIND_M: f32 = 0.02;
/// Between the back of what hangs there and a wall, m.
const HUNG_M: f32 = 0.01;
/// Between what hangs before a window and the wall, m: windows have so much free before them.
const CURTAINS_M: f32 = 0.081;
/// Between the side of furniture and a wall, m.
const BESIDE_M: f32 = 0.03;
/// Places that are tried for a thing, and for one that a room must have.
const TRIES: [usize; 2] = [12, 40];
/// The share of things at walls that go into its corners.
const SNUG: f64 = 0.4;

/// Puts all that the table says into a room; whether all that it must have is there.
pub fn furnish(site: &mut Site<'_>, items: &[Item], table: &FurnitureTable, chance: &mut Chance) -> bool {
    items.iter().all(|item| {
        if site.find(&item.unless).is_some() {
            return true;
        }
        let wanted = count(item, site, chance);
        let placed = (0..wanted).filter(|_| place(site, item, table, chance)).count();
        !item.must || placed > 0
    })
}

/// How many of an item there are to be.
fn count(item: &Item, site: &Site<'_>, chance: &mut Chance) -> usize {
    let [low, high] = item.count;
    if !chance.is(item.share.unwrap_or(1.0)) {
        return 0;
    }
    match item.each_m2 {
        Some(each_m2) => ((site.area_m2() / each_m2) as usize).clamp(low, high),
        None => low + chance.below(high + 1 - low),
    }
}

/// Puts one of an item somewhere; whether there was room for it.
fn place(site: &mut Site<'_>, item: &Item, table: &FurnitureTable, chance: &mut Chance) -> bool {
    let mut names: Vec<&String> = item.any.iter().collect();
    chance.shuffle(&mut names);
    let tries = TRIES[usize::from(item.must)];
    item.first.iter().chain(names).any(|name| {
        let set = table.set(name);
        (0..tries).any(|_| {
            let Some(arrangement) = Arrangement::draw(&set, site.catalog, chance) else { return false };
            let Some(([x, y], turn)) = spot(site, item, &arrangement, chance) else { return false };
            let is_hanging = item.place == Place::Ceiling;
            let height_m = if is_hanging { WALL_HEIGHT_M - arrangement.bounds.high[2] } else { item.height_m };
            let is_placed = site.try_place(&arrangement, [x, y, height_m], turn);
            if is_placed && item.place == Place::Opposite {
                keep_view(site, item, [x, y]);
            }
            is_placed
        })
    })
}

/// A place where an item may be: the origin of the arrangement and its turn.
fn spot(site: &Site<'_>, item: &Item, arrangement: &Arrangement, chance: &mut Chance) -> Option<([f32; 2], Turn)> {
    match item.place {
        Place::Wall => at_wall(site, arrangement, BEHIND_M, Along::Anywhere, chance),
        Place::Corner => at_wall(site, arrangement, BEHIND_M, Along::End, chance),
        Place::LeftCorner => at_wall(site, arrangement, BEHIND_M, Along::LeftEnd, chance),
        Place::Hung => at_wall(site, arrangement, HUNG_M, Along::Between, chance),
        Place::Middle => in_the_middle(site, arrangement, chance),
        Place::Window => {
            let (wall, middle) = *chance.pick(&site.windows)?;
            Some((against(wall, metres(middle), CURTAINS_M, arrangement), wall.faces))
        }
        Place::Opposite => opposite(site, arrangement, &item.of, chance),
        Place::Ceiling => {
            let largest = site.rects.iter().max_by(|one, other| one.area_m2().total_cmp(&other.area_m2()))?;
            let middle = [largest.west + largest.east, largest.south + largest.north].map(|sum| metres(sum) / 2.0);
            Some((middle, Turn::EAST))
        }
    }
}

/// Where along a wall something may be.
#[derive(Clone, Copy, Eq, PartialEq)]
enum Along {
    Anywhere,
    /// In a corner.
    End,
    /// In the corner at its left.
    LeftEnd,
    /// Between the corners.
    Between,
}

/// A place at some wall; the origin of the arrangement and its turn.
fn at_wall(
    site: &Site<'_>,
    arrangement: &Arrangement,
    behind_m: f32,
    along: Along,
    chance: &mut Chance,
) -> Option<([f32; 2], Turn)> {
    let width_m = arrangement.bounds.high[1] - arrangement.bounds.low[1];
    let is_long = |wall: &&Wall| metres(wall.length()) >= width_m + 2.0 * (HALF_WALL_M + BESIDE_M);
    let long: Vec<Wall> = site.walls.iter().filter(is_long).copied().collect();
    let wall = *long.get(chance.weighted(long.iter().map(|wall| wall.length() as f32)))?;
    let is_snug = match along {
        Along::Anywhere => chance.is(SNUG),
        Along::End | Along::LeftEnd => true,
        Along::Between => false,
    };
    let half_m = width_m / 2.0 + HALF_WALL_M + BESIDE_M;
    let [from_m, to_m] = [metres(wall.from) + half_m, metres(wall.to) - half_m];
    let is_first = if along == Along::LeftEnd { is_left_first(wall) } else { chance.is(0.5) };
    let middle_m = match (is_snug, is_first) {
        (true, true) => from_m,
        (true, false) => to_m,
        // On a lattice of 5 cm.
        (false, _) => ((chance.between(from_m, to_m) * 20.0).round() / 20.0).clamp(from_m, to_m),
    };
    Some((against(wall, middle_m, behind_m, arrangement), wall.faces))
}

/// A place at the wall that a piece of one of these classes faces, before it or a little aside.
fn opposite(
    site: &Site<'_>,
    arrangement: &Arrangement,
    of: &[String],
    chance: &mut Chance,
) -> Option<([f32; 2], Turn)> {
    /// The farthest aside, m.
    const ASIDE_M: f32 = 0.5;
    let other = site.find(of)?;
    let ahead_m = |wall: &&Wall| {
        let [x, y] = wall.point(0.0, 0.0);
        other.turn.inverse().apply([x - other.at_m[0], y - other.at_m[1]])[0]
    };
    let [x, y, _] = other.at_m;
    let is_faced = |wall: &&Wall| {
        let along_m = if wall.axis() == Axis::X { x } else { y };
        wall.faces == other.turn.back()
            && ahead_m(wall) > 0.0
            && (metres(wall.from)..metres(wall.to)).contains(&along_m)
    };
    let faced = site.walls.iter().filter(is_faced);
    let wall = *faced.min_by(|one, other| ahead_m(one).total_cmp(&ahead_m(other)))?;
    let along_m = if wall.axis() == Axis::X { x } else { y };
    let middle_m = ((along_m + chance.between(-ASIDE_M, ASIDE_M)) * 20.0).round() / 20.0;
    Some((against(wall, middle_m, BEHIND_M, arrangement), wall.faces))
}

/// Keeps the view free from the piece that an item is opposite to, to where that stands.
fn keep_view(site: &mut Site<'_>, item: &Item, [x, y]: [f32; 2]) {
    /// Half the width of what is kept free, and its heights, m: lower is a coffee table.
    const HALF_M: f32 = 0.4;
    const HEIGHTS_M: [f32; 2] = [0.6, 1.2];
    let Some(other) = site.find(&item.of) else { return };
    let front_m = other.size_m[0] / 2.0;
    let [dx, dy] = other.turn.apply([front_m, HALF_M]);
    let from = [other.at_m[0] + dx, other.at_m[1] + dy];
    let [dx, dy] = other.turn.apply([0.0, -HALF_M]);
    let block = Block::between(from, [x + dx, y + dy], HEIGHTS_M);
    site.kept_free.push(block);
}

/// Whether what has its back to a wall has the first end of that at its left.
fn is_left_first(wall: Wall) -> bool {
    let [x, y] = wall.faces.apply([0.0, 1.0]);
    x + y < 0.0
}

/// The origin of an arrangement whose back is at a wall, its middle at a place along it.
pub fn against(wall: Wall, middle_m: f32, behind_m: f32, arrangement: &Arrangement) -> [f32; 2] {
    let bounds = &arrangement.bounds;
    let aside_m = (bounds.low[1] + bounds.high[1]) / 2.0;
    let [dx, dy] = wall.faces.apply([0.0, -aside_m]);
    let [x, y] = wall.point(middle_m, HALF_WALL_M + behind_m - bounds.low[0]);
    [x + dx, y + dy]
}

/// A place away from the walls, rather in the middle of the room.
fn in_the_middle(site: &Site<'_>, arrangement: &Arrangement, chance: &mut Chance) -> Option<([f32; 2], Turn)> {
    /// The farthest from the middle, as a share of the floor.
    const ASIDE: f32 = 0.3;
    let rect = *chance.pick(&site.rects)?;
    let turn = *chance.pick(&Turn::ALL)?;
    let around = bounds(&[rect]);
    let at = |from: i32, to: i32, chance: &mut Chance| {
        let aside = chance.between(0.0, ASIDE) * chance.between(-1.0, 1.0);
        ((metres(from) + metres(to - from) * (0.5 + aside)) * 20.0).round() / 20.0
    };
    let [x, y] = [at(around.west, around.east, chance), at(around.south, around.north, chance)];
    let middle = [0, 1].map(|axis| (arrangement.bounds.low[axis] + arrangement.bounds.high[axis]) / 2.0);
    let [dx, dy] = turn.apply(middle);
    Some(([x - dx, y - dy], turn))
}

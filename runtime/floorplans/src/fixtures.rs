//! What rooms have for certain: a light switch each, a fuse box for each circuit, and the door to the outside.

use cohabit_cdf::layout::OpeningKind;

use crate::{
    chance::Chance,
    furniture::{Arrangement, Part, Set, Site, against},
    geometry::{Block, Turn, Wall, metres},
    openings::{Entry, Gap},
};

/// The class of light switches.
pub const LIGHT_SWITCH: &str = "LightSwitch_01";
/// The class of fuse boxes.
pub const FUSE_BOX: &str = "FuseBox_01";
/// The class of the levers in them.
const LEVER: &str = "FuseBox_01_Lever";
/// Heights of a light switch and of a fuse box, m.
const SWITCH_M: f32 = 1.15;
const FUSE_BOX_M: f32 = 1.0;
/// Kept free before doors and passages, and before switches, m.
const BEFORE_DOOR_M: f32 = 1.1;
const BEFORE_SWITCH_M: f32 = 0.6;
/// Kept free beside a door, m.
const BESIDE_DOOR_M: f32 = 0.08;
/// From the edge of a door to the middle of a light switch, m: the nearest first.
const SWITCH_ASIDE_M: [f32; 4] = [0.25, 0.4, 0.6, 0.9];
/// Heights of windows, m, with what is kept free of them.
const WINDOW_M: [f32; 2] = [1.0, 2.25];
/// Kept free of things in windows, from the middle of the wall, m.
const IN_WINDOW_M: f32 = 0.14;
/// From the wall to the back of what hangs there, m.
const BEHIND_M: f32 = 0.01;
/// Kept free before the door to the outside, m.
const BEFORE_ENTRY_M: f32 = 1.1;
/// Between a wall and the door to the outside, m.
const BEHIND_ENTRY_M: f32 = 0.02;

/// What must stay free in a room with these openings.
pub fn kept_free(room: usize, gaps: &[Gap], entry: Option<Entry>) -> Vec<Block> {
    let of_room = gaps.iter().filter(|gap| gap.between.contains(&room));
    let before_gaps = of_room.map(|gap| match gap.kind {
        OpeningKind::Window => before(gap.wall_of(room), gap.middle, metres(gap.width) / 2.0, IN_WINDOW_M, WINDOW_M),
        _ => {
            let half_m = metres(gap.width) / 2.0 + BESIDE_DOOR_M;
            before(gap.wall_of(room), gap.middle, half_m, BEFORE_DOOR_M, [0.0, 2.3])
        }
    });
    let before_entry = entry.filter(|entry| entry.room == room).map(|entry| {
        before(entry.wall, entry.middle, metres(entry.width) / 2.0 + BESIDE_DOOR_M, BEFORE_ENTRY_M, [0.0, 2.3])
    });
    before_gaps.chain(before_entry).collect()
}

fn before(wall: Wall, middle: i32, half_m: f32, depth_m: f32, heights_m: [f32; 2]) -> Block {
    let middle_m = metres(middle);
    Block::between(wall.point(middle_m - half_m, 0.0), wall.point(middle_m + half_m, depth_m), heights_m)
}

/// One class alone.
fn single(class: &str) -> Set {
    let part = Part { any: vec![class.to_owned()], ..Part::default() };
    Set { name: class.to_owned(), parts: vec![part] }
}

/// Stands the door to the outside in its room; whether there was room for it.
pub fn add_entry(site: &mut Site<'_>, class: &str, entry: Entry, chance: &mut Chance) -> bool {
    let Some(door) = Arrangement::draw(&single(class), site.catalog, chance) else { return false };
    let [x, y] = against(entry.wall, metres(entry.middle), BEHIND_ENTRY_M, &door);
    // It stands where nothing else may.
    let kept_free = std::mem::take(&mut site.kept_free);
    let is_placed = site.try_place(&door, [x, y, 0.0], entry.wall.faces);
    site.kept_free = kept_free;
    is_placed
}

/// Hangs a light switch beside a door, on the side of its handle if there is room; whether there was room for it.
pub fn add_switch(site: &mut Site<'_>, room: usize, gaps: &[Gap], entry: Option<Entry>, chance: &mut Chance) -> bool {
    let ways = gaps.iter().filter(|gap| gap.is_way() && gap.between.contains(&room));
    let ways = ways.map(|gap| (gap.wall_of(room), gap.middle, gap.width));
    let entry = entry.filter(|entry| entry.room == room).map(|entry| (entry.wall, entry.middle, entry.width));
    let beside = |(wall, middle, width): (Wall, i32, i32)| {
        SWITCH_ASIDE_M.into_iter().flat_map(move |aside_m| {
            let aside_m = metres(width) / 2.0 + aside_m;
            // Doors have their handles in the west or in the north.
            let side = if wall.faces == Turn::NORTH || wall.faces == Turn::SOUTH { -1.0 } else { 1.0 };
            [side, -side].map(|side| (wall, metres(middle) + side * aside_m))
        })
    };
    let mut spots: Vec<(Wall, f32)> = ways.chain(entry).flat_map(beside).collect();
    if spots.is_empty() {
        spots = anywhere(site);
    }
    let Some(switch) = Arrangement::draw(&single(LIGHT_SWITCH), site.catalog, chance) else { return false };
    hang(site, &switch, &spots, SWITCH_M)
}

/// Hangs a fuse box with its lever on some wall; whether there was room for it.
pub fn add_fuse_box(site: &mut Site<'_>, chance: &mut Chance) -> bool {
    let mut set = single(FUSE_BOX);
    set.parts.push(Part { any: vec![LEVER.to_owned()], on: Some(0), ..Part::default() });
    let Some(mut fuse_box) = Arrangement::draw(&set, site.catalog, chance) else { return false };
    let foot = site.catalog.class(fuse_box.pieces[0].class).receptacle.as_ref();
    let foot_m = foot.and_then(|receptacle| receptacle.surfaces.first()).map_or(0.0, |surface| surface.center_m[2]);
    fuse_box.pieces[1].at_m = [0.0, 0.0, foot_m];
    let mut spots = anywhere(site);
    chance.shuffle(&mut spots);
    hang(site, &fuse_box, &spots, FUSE_BOX_M)
}

/// Places along all walls.
fn anywhere(site: &Site<'_>) -> Vec<(Wall, f32)> {
    const STEP: usize = 4;
    let along = |wall: &Wall| (wall.from..wall.to).step_by(STEP).map(|at| (*wall, metres(at))).collect::<Vec<_>>();
    site.walls.iter().flat_map(along).collect()
}

/// Hangs something at the first of some places where there is room for it, and keeps the floor before it free.
fn hang(site: &mut Site<'_>, arrangement: &Arrangement, spots: &[(Wall, f32)], height_m: f32) -> bool {
    let half_m = (arrangement.bounds.high[1] - arrangement.bounds.low[1]) / 2.0;
    let has_wall = |site: &Site<'_>, wall: Wall, at_m: f32| {
        site.walls.iter().any(|own| {
            own.faces == wall.faces
                && own.at == wall.at
                && metres(own.from) + 0.1 <= at_m - half_m
                && at_m + half_m <= metres(own.to) - 0.1
        })
    };
    for (wall, at_m) in spots {
        let [x, y] = against(*wall, *at_m, BEHIND_M, arrangement);
        if has_wall(site, *wall, *at_m) && site.try_place(arrangement, [x, y, height_m], wall.faces) {
            let before = [wall.point(at_m - half_m - 0.1, 0.0), wall.point(at_m + half_m + 0.1, BEFORE_SWITCH_M)];
            site.kept_free.push(Block::between(before[0], before[1], [0.0, height_m + 0.7]));
            return true;
        }
    }
    false
}

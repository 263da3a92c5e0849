//! Where to stand and look from in a furnished room, and where notes can be stuck.

use crate::{
    furniture::Site,
    geometry::{Block, HALF_WALL_M, Wall, metres, rounded},
    openings::Gap,
};

/// Viewpoints of a room.
const VIEWPOINTS: usize = 8;
/// Places for notes of a room, from and to.
const NOTES: [usize; 2] = [4, 6];
/// The first viewpoint is so far from the wall of a door, m.
const FROM_DOOR_M: f32 = 0.85;
/// Half of what is seen to the left and right, degrees.
const HALF_VIEW_DEG: f32 = 35.0;
/// Nearest and farthest of what is looked at, m.
const SHOWN_M: std::ops::Range<f32> = 0.8..9.0;
/// A step of headings, degrees.
const STEP_DEG: u16 = 15;
/// Where a note hangs: its height, and how far from the middle of the wall, m.
const NOTE_M: f32 = 1.4;
const NOTE_FROM_WALL_M: f32 = 0.072;
/// What is kept free around a note, m.
const AROUND_NOTE_M: f32 = 0.09;
/// Between places for notes that are looked at, dm.
const NOTE_STEP: usize = 3;
/// The farthest that one may stand from a note, m.
const NOTE_REACH_M: f32 = 0.9;

/// A place to stand, and where to look from it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Where to stand, m.
    pub at_m: [f32; 2],
    /// Where to look, degrees.
    pub yaw_deg: f32,
}

/// A place for a note.
#[derive(Clone, Copy, Debug)]
pub struct Note {
    /// Its origin, m.
    pub at_m: [f32; 3],
    /// The way that it faces, degrees.
    pub yaw_deg: f32,
}

/// Viewpoints far from each other, the first one at a door; nothing, if there is too little free floor.
pub fn views(site: &Site<'_>, door: Option<&Gap>, room: usize) -> Option<Vec<View>> {
    let free: Vec<[f32; 2]> = site.ground.walkable().collect();
    let start = door.map(|gap| gap.wall_of(room).point(metres(gap.middle), FROM_DOOR_M));
    let first = match start {
        Some(start) => {
            (0..free.len()).min_by(|one, other| apart(free[*one], start).total_cmp(&apart(free[*other], start)))
        }
        None => (!free.is_empty()).then_some(0),
    }?;
    let chosen = spread(&free, first, VIEWPOINTS, apart);
    let seen: Vec<[f32; 2]> = seen(site);
    let view = |index: &usize| View { at_m: free[*index].map(rounded), yaw_deg: heading(free[*index], &seen) };
    (chosen.len() == VIEWPOINTS).then(|| chosen.iter().map(view).collect())
}

/// Where all is that can be looked at.
fn seen(site: &Site<'_>) -> Vec<[f32; 2]> {
    let holder = |mut index: usize| {
        while let Some(on) = site.placed[index].on {
            index = on;
        }
        site.placed[index].at_m
    };
    (0..site.placed.len()).map(holder).map(|[x, y, _]| [x, y]).collect()
}

/// The heading that shows the most, degrees.
fn heading(at: [f32; 2], seen: &[[f32; 2]]) -> f32 {
    let near = seen.iter().filter(|other| SHOWN_M.contains(&apart(at, **other)));
    let bearings: Vec<f32> = near.map(|other| libm::atan2f(other[1] - at[1], other[0] - at[0]).to_degrees()).collect();
    let headings = (1..=360 / STEP_DEG).map(|step| f32::from(step * STEP_DEG) - 180.0);
    let shown = |heading: f32| {
        let aside = bearings.iter().map(|bearing| ((bearing - heading + 180.0).rem_euclid(360.0) - 180.0).abs());
        // What is in the middle counts more.
        aside.filter(|aside| *aside < HALF_VIEW_DEG).map(|aside| 2.0 - aside / HALF_VIEW_DEG).sum::<f32>()
    };
    headings.max_by(|one, other| shown(*one).total_cmp(&shown(*other))).unwrap_or(0.0)
}

/// Places for notes on the walls, far from each other and in reach; nothing, if there are too few.
pub fn notes(site: &Site<'_>) -> Option<Vec<Note>> {
    let free: Vec<[f32; 2]> = site.ground.walkable().collect();
    let blocks: Vec<Block> = site.filled().collect();
    let along = |wall: &Wall| {
        (wall.from + NOTE_STEP as i32..wall.to - 2).step_by(NOTE_STEP).map(|at| (*wall, metres(at))).collect::<Vec<_>>()
    };
    let is_free = |(wall, at_m): &(Wall, f32)| {
        let low = wall.point(at_m - AROUND_NOTE_M, HALF_WALL_M);
        let high = wall.point(at_m + AROUND_NOTE_M, HALF_WALL_M + 0.04);
        let block = Block::between(low, high, [NOTE_M - 0.05, NOTE_M + 0.15]);
        let on_wall = wall.point(*at_m, 0.0);
        !blocks.iter().chain(&site.kept_free).any(|other| other.overlaps(&block))
            && free.iter().any(|point| apart(*point, on_wall) < NOTE_REACH_M)
    };
    let spots: Vec<(Wall, f32)> = site.walls.iter().flat_map(along).filter(is_free).collect();
    let from_each_other =
        |one: (Wall, f32), other: (Wall, f32)| apart(one.0.point(one.1, 0.0), other.0.point(other.1, 0.0));
    let chosen = spread(&spots, 0, NOTES[1], from_each_other);
    let note = |index: &usize| {
        let (wall, at_m) = spots[*index];
        let [x, y] = wall.point(at_m, NOTE_FROM_WALL_M).map(rounded);
        Note { at_m: [x, y, NOTE_M], yaw_deg: wall.faces.yaw_deg() }
    };
    (chosen.len() >= NOTES[0]).then(|| chosen.iter().map(note).collect())
}

/// The indices of some that are far from each other: from the first on, always the one that is farthest from all before.
fn spread<T: Copy>(all: &[T], first: usize, count: usize, distance: impl Fn(T, T) -> f32) -> Vec<usize> {
    if all.is_empty() {
        return Vec::new();
    }
    let mut chosen = vec![first];
    let mut nearest = vec![f32::INFINITY; all.len()];
    while chosen.len() < count {
        let last = all[chosen[chosen.len() - 1]];
        for (nearest, one) in nearest.iter_mut().zip(all) {
            *nearest = nearest.min(distance(*one, last));
        }
        let next = (0..all.len()).max_by(|one, other| nearest[*one].total_cmp(&nearest[*other]));
        match next.filter(|next| nearest[*next] > 0.0) {
            Some(next) => chosen.push(next),
            None => break,
        }
    }
    chosen
}

fn apart(one: [f32; 2], other: [f32; 2]) -> f32 {
    let [x, y] = [one[0] - other[0], one[1] - other[1]];
    (x * x + y * y).sqrt()
}

//! The floor of an outline divided into rooms. Knows no doors.

use cohabit_cdf::model::Axis;

use crate::{
    chance::Chance,
    geometry::{Rect, metres},
    outline::{Outline, Zone},
    program::Wanted,
};

/// The longest side of a room, in lengths of its shortest.
const LONGEST: f32 = 2.5;
/// A room has that share of the floor that it would like to have, from and to.
const SHARE: [f32; 2] = [0.7, 1.6];

/// The rectangles of each room, in the order in which they are wanted; nothing, if they do not go together.
pub fn divide(outline: &Outline, wanted: &[Wanted<'_>], chance: &mut Chance) -> Option<Vec<Vec<Rect>>> {
    let mut rooms = vec![Vec::new(); wanted.len()];
    for (zone, indices) in outline.zones.iter().zip(assign(outline, wanted, chance)?) {
        if zone.whole {
            rooms[*indices.first()?].clone_from(&zone.rects);
        } else {
            cut(*zone.rects.first()?, zone.along, &indices, wanted, chance, &mut rooms);
        }
    }
    rooms.iter().zip(wanted).all(|(rects, wanted)| is_fit(rects, wanted)).then_some(rooms)
}

/// Which rooms each zone has: each room goes where the most floor is left, and each zone has one at least.
fn assign(outline: &Outline, wanted: &[Wanted<'_>], chance: &mut Chance) -> Option<Vec<Vec<usize>>> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    chance.shuffle(&mut order);
    // Those that need a long side have the first choice.
    order.sort_by_key(|index| std::cmp::Reverse(wanted[*index].room.least() / 8));
    let mut zones = vec![Vec::new(); outline.zones.len()];
    for index in order {
        let left = |(place, zone): (usize, &Zone)| {
            let depth = zone.rects.iter().map(|rect| rect.least()).min()?;
            let taken: f32 = zones[place].iter().map(|index: &usize| floor_m2(&wanted[*index], depth)).sum();
            let is_shut = zone.whole && !zones[place].is_empty();
            let is_fit = zone.rects.iter().all(|rect| rect.least() >= wanted[index].room.least());
            (!is_shut && is_fit).then(|| (place, area_m2(&zone.rects) - taken))
        };
        let best = outline.zones.iter().enumerate().filter_map(left).max_by(|one, other| one.1.total_cmp(&other.1));
        zones[best?.0].push(index);
    }
    for zone in &mut zones {
        chance.shuffle(zone);
    }
    zones.iter().all(|zone| !zone.is_empty()).then_some(zones)
}

/// Cuts a rectangle into two by the floor that rooms want, and those parts again.
fn cut(
    rect: Rect,
    along: Option<Axis>,
    indices: &[usize],
    wanted: &[Wanted<'_>],
    chance: &mut Chance,
    rooms: &mut [Vec<Rect>],
) {
    if let [only] = indices {
        rooms[*only] = vec![rect];
        return;
    }
    let (first, second) = indices.split_at(indices.len() / 2 + usize::from(indices.len() % 2 == 1 && chance.is(0.5)));
    let longer = if rect.length(Axis::X) >= rect.length(Axis::Y) { Axis::X } else { Axis::Y };
    let axis = along.unwrap_or(longer);
    let depth = rect.length(if axis == Axis::X { Axis::Y } else { Axis::X });
    let area = |indices: &[usize]| indices.iter().map(|index| floor_m2(&wanted[*index], depth)).sum::<f32>();
    let share = area(first) / area(indices);
    let at = rect.start(axis) + (rect.length(axis) as f32 * share).round() as i32;
    let [before, behind] = rect.cut(axis, at);
    cut(before, along, first, wanted, chance, rooms);
    cut(behind, along, second, wanted, chance, rooms);
}

/// The floor that a room gets in a strip of some depth: a small one gets more than it would like to have, or it would be too narrow.
fn floor_m2(wanted: &Wanted<'_>, depth: i32) -> f32 {
    wanted.area_m2.max(metres(wanted.room.least()) * metres(depth))
}

fn is_fit(rects: &[Rect], wanted: &Wanted<'_>) -> bool {
    let share = area_m2(rects) / wanted.area_m2;
    let is_fit = |rect: &Rect| {
        let longest = rect.length(Axis::X).max(rect.length(Axis::Y));
        rect.least() >= wanted.room.least() && longest as f32 <= LONGEST * rect.least() as f32
    };
    (SHARE[0]..=SHARE[1]).contains(&share) && rects.iter().all(is_fit)
}

fn area_m2(rects: &[Rect]) -> f32 {
    rects.iter().map(|rect| rect.area_m2()).sum()
}

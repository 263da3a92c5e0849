//! How rooms are joined: by doors and passages, whatever stands in them.

use std::collections::BTreeSet;

use super::fault::{LayoutFault, NoWay};
use super::floor::start;
use super::{Layout, OpeningKind, Room, RoomId};
use crate::{catalog::Catalog, model::Axis};

/// Width of a door that is proposed, m.
const DOOR_M: f32 = 1.0;
/// Kept free of it at each end of a wall, m.
const END_M: f32 = 0.1;
/// Rounding in plan files, m.
const SLACK_M: f32 = 0.002;
/// The ids of doors begin so.
const DOOR: &str = "Door_01";

/// The rooms of a plan, and which of them are joined with the room where all ways begin.
pub(super) struct Ways<'a> {
    layout: &'a Layout,
    /// The room where all ways begin.
    start: Option<RoomId>,
    joined: BTreeSet<RoomId>,
}

impl<'a> Ways<'a> {
    pub fn of(layout: &'a Layout, catalog: &Catalog) -> Self {
        let mut ways = Self { layout, start: start(layout, catalog), joined: BTreeSet::new() };
        let mut open: Vec<RoomId> = ways.start.into_iter().collect();
        while let Some(room) = open.pop() {
            if ways.joined.insert(room) {
                open.extend(ways.neighbours(room));
            }
        }
        ways
    }

    /// The rooms that a room has a door or a passage to.
    fn neighbours(&self, room: RoomId) -> Vec<RoomId> {
        let walked = self.layout.openings.iter().filter(|opening| opening.kind != OpeningKind::Window);
        let others = walked.filter_map(|opening| match opening.between {
            [one, other] if one == room && other != room => Some(other),
            [one, other] if other == room && one != room => Some(one),
            _ => None,
        });
        others.collect()
    }

    /// Why no doors and passages lead into a room; nothing, if they do.
    pub fn no_way_into(&self, room: RoomId) -> Option<NoWay> {
        if self.joined.contains(&room) {
            return None;
        }
        let (rooms, entry) = (self.neighbours(room), self.entry(room));
        Some(if rooms.is_empty() { NoWay::NoDoor { entry } } else { NoWay::Elsewhere { rooms, entry } })
    }

    /// An entry of the plan's file: a door between a room and one that is joined already, rather where all ways begin, in the
    /// longest wall that they share.
    fn entry(&self, room: RoomId) -> Option<String> {
        let own = self.layout.room(room)?;
        let others = self.layout.rooms.iter().filter(|other| self.joined.contains(&other.id));
        let walls = others.flat_map(|other| shared_walls(own, other));
        let rank = |wall: &Wall| (self.start.is_some_and(|start| wall.between.contains(&start)), wall.length_m);
        let wall = walls.max_by(|one, other| {
            let ((one_starts, one_m), (other_starts, other_m)) = (rank(one), rank(other));
            one_starts.cmp(&other_starts).then(one_m.total_cmp(&other_m))
        })?;
        let number = (1..).find(|number| self.layout.placement(&format!("{DOOR}_{number}")).is_none())?;
        let ([first, second], [x, y]) = (wall.between, wall.middle_m);
        let runs = if wall.runs == Axis::X { "x" } else { "y" };
        Some(format!(
            "{{ kind = \"door\", door = \"{DOOR}_{number}\", between = [\"{}\", \"{}\"], \
             at_m = [{x:.2}, {y:.2}], width_m = {DOOR_M:.1}, wall_runs = \"{runs}\" }}",
            first.id(),
            second.id()
        ))
    }
}

impl Layout {
    /// The rooms that no doors and passages lead into, whatever stands in them, each with why and what to write.
    #[must_use]
    pub fn rooms_without_a_way(&self, catalog: &Catalog) -> Vec<LayoutFault> {
        let ways = Ways::of(self, catalog);
        let without = self.rooms.iter().filter_map(|room| Some((room.id, ways.no_way_into(room.id)?)));
        without.map(|(room, why)| LayoutFault::OutOfReach { room, why }).collect()
    }
}

/// A stretch of wall between two rooms, long enough for a door.
struct Wall {
    /// The southern or western room first.
    between: [RoomId; 2],
    middle_m: [f32; 2],
    length_m: f32,
    runs: Axis,
}

/// All that two rooms share.
fn shared_walls(one: &Room, other: &Room) -> Vec<Wall> {
    let mut walls = Vec::new();
    for first in &one.rects_m {
        for second in &other.rects_m {
            for (across, along, runs) in [(1, 0, Axis::X), (0, 1, Axis::Y)] {
                let (from, to) = (first[along].max(second[along]), first[along + 2].min(second[along + 2]));
                let length_m = to - from;
                if length_m < DOOR_M + 2.0 * END_M {
                    continue;
                }
                let is_low = (first[across + 2] - second[across]).abs() < SLACK_M;
                let is_high = (second[across + 2] - first[across]).abs() < SLACK_M;
                let (between, at) = match (is_low, is_high) {
                    (true, _) => ([one.id, other.id], first[across + 2]),
                    (_, true) => ([other.id, one.id], first[across]),
                    _ => continue,
                };
                let mut middle_m = [0.0; 2];
                middle_m[along] = (from + to) / 2.0;
                middle_m[across] = at;
                walls.push(Wall { between, middle_m, length_m, runs });
            }
        }
    }
    walls
}

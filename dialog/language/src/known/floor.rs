//! The floor as the robot knows it: its plan, and how closely it has looked at each part of it.

use std::sync::Arc;

use cohabit_cdf::{Layout, RoomId, layout::OpeningKind};

/// The side of a cell of floor, m: no finer than furniture is apart.
const CELL_M: f32 = 0.5;
/// How finely a straight line is followed when it is asked whether it leaves a room, m.
const LINE_M: f32 = 0.25;
/// No plan that is worth walking has more.
const MOST_CELLS: usize = 8192;

/// What a floor plan tells: rooms, what joins them, and named places to look from.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlan {
    rooms: Vec<(RoomId, Vec<[f32; 4]>)>,
    /// Doors and passages: the rooms they join, and their middle, m.
    gates: Vec<([RoomId; 2], [f32; 2])>,
    pub(crate) viewpoints: Vec<Vantage>,
    pub(crate) cells: Vec<Cell>,
    /// The instance ids of its doors, and the rooms that each joins.
    doors: Vec<(String, [RoomId; 2])>,
}

/// A named viewpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Vantage {
    pub(crate) room: RoomId,
    pub(crate) number: u8,
    pub(crate) at_m: [f32; 2],
}

/// A square of floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) room: RoomId,
    pub(crate) at_m: [f32; 2],
}

/// A plan, and how closely each cell of it was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    pub(crate) plan: Arc<FloorPlan>,
    /// By cell: from how near it was seen, m; infinite where it was not.
    pub(crate) nearest_m: Arc<Vec<f32>>,
    /// The same of what lies low there: a look straight ahead misses what is at its feet.
    pub(crate) nearest_low_m: Arc<Vec<f32>>,
}

impl FloorPlan {
    /// What a layout tells whoever has seen its plan.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        let rooms: Vec<_> = layout.rooms.iter().map(|room| (room.id, room.rects_m.clone())).collect();
        let is_gate = |kind| matches!(kind, OpeningKind::Door | OpeningKind::Passage);
        let gates = layout.openings.iter().filter(|opening| is_gate(opening.kind));
        let viewpoints = layout.viewpoints.iter();
        let mut cells: Vec<Cell> = rooms.iter().flat_map(|(room, rects)| cells(*room, rects)).collect();
        cells.truncate(MOST_CELLS);
        Self {
            gates: gates.map(|gate| (gate.between, gate.at_m)).collect(),
            viewpoints: viewpoints.map(|v| Vantage { room: v.room, number: v.number, at_m: v.at_m }).collect(),
            cells,
            doors: layout.openings.iter().filter_map(|one| Some((one.door.clone()?, one.between))).collect(),
            rooms,
        }
    }

    /// Its rooms.
    pub(crate) fn rooms(&self) -> impl Iterator<Item = RoomId> {
        self.rooms.iter().map(|(room, _)| *room)
    }

    /// Whether it shows this door.
    pub(crate) fn has_door(&self, instance: &str) -> bool {
        self.doors.iter().any(|(door, _)| door == instance)
    }

    /// The room on the other side of a door, seen from one of the two that it joins.
    pub(crate) fn beyond(&self, instance: &str, room: RoomId) -> Option<RoomId> {
        let (_, [one, other]) = self.doors.iter().find(|(door, _)| door == instance)?;
        match room {
            room if room == *one => Some(*other),
            room if room == *other => Some(*one),
            _ => None,
        }
    }

    /// Whether the straight line between two places of a room stays in it.
    pub(crate) fn is_straight(&self, room: RoomId, from: [f32; 2], to: [f32; 2]) -> bool {
        let Some((_, rects)) = self.rooms.iter().find(|(id, _)| *id == room) else { return false };
        if rects.len() == 1 {
            return true;
        }
        let steps = (distance(from, to) / LINE_M).ceil().max(1.0);
        let count = steps as u32;
        (1..count).all(|step| {
            let share = step as f32 / steps;
            let (x, y) = (from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share);
            rects.iter().any(|r| x >= r[0] && x <= r[2] && y >= r[1] && y <= r[3])
        })
    }

    /// About how far it is to walk, through doors, m; infinite where no way leads.
    pub(crate) fn way_m(&self, from: (RoomId, [f32; 2]), to: (RoomId, [f32; 2])) -> f32 {
        if from.0 == to.0 {
            return distance(from.1, to.1);
        }
        // From gate to gate, as often as there are gates: no shortest way passes one twice.
        let start = |(between, at): &([RoomId; 2], [f32; 2])| {
            if between.contains(&from.0) { distance(from.1, *at) } else { f32::INFINITY }
        };
        let mut way: Vec<f32> = self.gates.iter().map(start).collect();
        for _ in 0..self.gates.len() {
            let before = way.clone();
            for (index, (between, at)) in self.gates.iter().enumerate() {
                let joined = self
                    .gates
                    .iter()
                    .zip(&before)
                    .filter(|((other, _), _)| other.iter().any(|room| between.contains(room)));
                let best = joined.map(|((_, other), so_far)| so_far + distance(*other, *at));
                way[index] = best.fold(way[index], f32::min);
            }
        }
        let last = self.gates.iter().zip(&way).filter(|((between, _), _)| between.contains(&to.0));
        last.map(|((_, at), so_far)| so_far + distance(*at, to.1)).fold(f32::INFINITY, f32::min)
    }

    /// The cells that a look all around from a place takes in, for things that show up to `reach_m`.
    pub(crate) fn around(&self, room: RoomId, at_m: [f32; 2], reach_m: f32) -> impl Iterator<Item = usize> {
        let cells = self.cells.iter().enumerate();
        cells.filter_map(move |(index, cell)| {
            let is_near = cell.room == room && distance(cell.at_m, at_m) <= reach_m;
            (is_near && self.is_straight(room, at_m, cell.at_m)).then_some(index)
        })
    }

    /// How many cells a room has.
    pub(crate) fn count(&self, room: RoomId) -> usize {
        self.cells.iter().filter(|cell| cell.room == room).count()
    }
}

impl Floor {
    /// The plan, of which nothing was looked at yet.
    #[must_use]
    pub fn new(plan: Arc<FloorPlan>) -> Self {
        let nearest_m = Arc::new(vec![f32::INFINITY; plan.cells.len()]);
        Self { plan, nearest_low_m: Arc::clone(&nearest_m), nearest_m }
    }

    /// The share of a room that was looked at from near enough for things that show up to `reach_m`.
    pub(crate) fn share_looked_at(&self, room: RoomId, reach_m: f32) -> f32 {
        let cells = self.plan.cells.iter().enumerate().filter(|(_, cell)| cell.room == room);
        let seen = cells.filter(|(cell, _)| self.is_looked_at(*cell, reach_m)).count();
        seen as f32 / self.plan.count(room).max(1) as f32
    }

    /// Whether a cell was looked at from near enough for things that show up to `reach_m`.
    pub(crate) fn is_looked_at(&self, cell: usize, reach_m: f32) -> bool {
        self.nearest_m.get(cell).is_some_and(|nearest| *nearest <= reach_m)
    }

    /// Whether that holds of what lies low there, too.
    pub(crate) fn is_looked_at_low(&self, cell: usize, reach_m: f32) -> bool {
        self.nearest_low_m.get(cell).is_some_and(|nearest| *nearest <= reach_m)
    }
}

fn distance(one: [f32; 2], other: [f32; 2]) -> f32 {
    distance_m([one[0], one[1], 0.0], [other[0], other[1], 0.0])
}

/// The cells of a room's rectangles.
fn cells(room: RoomId, rects: &[[f32; 4]]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for [west, south, east, north] in rects {
        let (columns, rows) = (((east - west) / CELL_M) as u16, ((north - south) / CELL_M) as u16);
        for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
            let middle = |start: f32, count: u16| start + (f32::from(count) + 0.5) * CELL_M;
            cells.push(Cell { room, at_m: [middle(*west, column), middle(*south, row)] });
        }
    }
    cells
}

/// The horizontal distance of two points, m.
pub(crate) fn distance_m(one: [f32; 3], other: [f32; 3]) -> f32 {
    let (dx, dy) = (one[0] - other[0], one[1] - other[1]);
    (dx * dx + dy * dy).sqrt()
}

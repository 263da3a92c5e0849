//! The floor that is free to walk on, as a grid: for checking plans, not for finding ways.

use std::collections::VecDeque;

use super::footprint::{Footprint, is_clear_of_walls};
use super::{Layout, OpeningKind, RoomId};
use crate::catalog::Catalog;
use crate::model::Axis;

/// Side of a cell, m.
const CELL_M: f32 = 0.1;
/// Half the thickness of walls, m.
const HALF_WALL_M: f32 = 0.06;
/// What lies lower does not block, m: cords, puddles, mats.
const STEP_M: f32 = 0.07;
/// What begins higher does not block, m: the robot is lower.
const HEADROOM_M: f32 = 1.4;

/// The room from which all others are reached: a plan's first corridor, or its first room if it has no corridor.
pub(super) fn start(layout: &Layout, catalog: &Catalog) -> Option<RoomId> {
    let mut rooms = layout.rooms.iter().map(|room| room.id);
    rooms.clone().find(|room| catalog.rooms().is_corridor(*room)).or_else(|| rooms.next())
}

/// The cells of floor where a disc of some radius can stand, and that can be reached from the room where all ways begin.
#[derive(Clone, Debug)]
pub struct FreeFloor {
    west_south_m: [f32; 2],
    columns: usize,
    /// Row by row from the south: the room, where a disc can stand and be reached.
    cells: Vec<Option<RoomId>>,
}

impl FreeFloor {
    /// Where a disc of `radius_m` can go, all doors open.
    #[must_use]
    pub fn new(layout: &Layout, catalog: &Catalog, radius_m: f32) -> Self {
        let [west, south, east, north] = layout.bounds_m();
        let columns = cells_along(east - west);
        let mut floor =
            Self { west_south_m: [west, south], columns, cells: vec![None; columns * cells_along(north - south)] };
        let mut is_blocked = vec![false; floor.cells.len()];
        for obstacle in obstacles(layout, catalog) {
            for index in floor.cells_around(&obstacle, radius_m) {
                is_blocked[index] |= obstacle.distance_m(floor.point_m(index)) < radius_m;
            }
        }
        for (index, is_blocked) in is_blocked.into_iter().enumerate() {
            let is_free = |_: &RoomId| !is_blocked;
            floor.cells[index] = standing_room(layout, floor.point_m(index), radius_m).filter(is_free);
        }
        floor.keep_reachable(start(layout, catalog));
        floor
    }

    /// Its area, m².
    #[must_use]
    pub fn area_m2(&self) -> f32 {
        let free = self.cells.iter().flatten().count();
        u16::try_from(free).map_or(f32::INFINITY, f32::from) * CELL_M * CELL_M
    }

    /// The middles of all free cells with their rooms, m.
    pub fn points_m(&self) -> impl Iterator<Item = (RoomId, [f32; 2])> + '_ {
        let free = |(index, cell): (usize, &Option<RoomId>)| cell.map(|room| (room, self.point_m(index)));
        self.cells.iter().enumerate().filter_map(free)
    }

    /// Whether the disc can stand here, give or take a cell.
    #[must_use]
    pub fn has(&self, at_m: [f32; 2]) -> bool {
        let rows = self.cells.len() / self.columns.max(1);
        // Some more on both sides: rounding leaves none out.
        let around = |axis: usize, count: usize| {
            let first = cells_along(at_m[axis] - self.west_south_m[axis]).saturating_sub(4);
            first..(first + 8).min(count)
        };
        let is_free_here = |index: usize| {
            let [x, y] = self.point_m(index);
            self.cells[index].is_some() && (x - at_m[0]).abs() <= CELL_M && (y - at_m[1]).abs() <= CELL_M
        };
        around(1, rows).any(|row| around(0, self.columns).any(|column| is_free_here(row * self.columns + column)))
    }

    fn point_m(&self, index: usize) -> [f32; 2] {
        let [column, row] = [index % self.columns, index / self.columns];
        let middle =
            |start_m: f32, steps: usize| start_m + (u16::try_from(steps).map_or(0.0, f32::from) + 0.5) * CELL_M;
        [middle(self.west_south_m[0], column), middle(self.west_south_m[1], row)]
    }

    /// The cells that may be nearer than `within_m` to an obstacle, and some beside them.
    fn cells_around(&self, obstacle: &Footprint, within_m: f32) -> impl Iterator<Item = usize> + use<> {
        let corners = obstacle.corners_m();
        let rows = self.cells.len() / self.columns.max(1);
        let span = |axis: usize, count: usize| {
            let along = corners.iter().map(|corner| corner[axis] - self.west_south_m[axis]);
            let (least, most) =
                along.fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), at| (least.min(at), most.max(at)));
            // One more on both sides: rounding leaves none out.
            let first = cells_along(least - within_m).saturating_sub(2);
            first..(cells_along(most + within_m) + 1).min(count)
        };
        let (columns, all) = (self.columns, span(0, self.columns));
        span(1, rows).flat_map(move |row| all.clone().map(move |column| row * columns + column))
    }

    /// Forgets what cannot be walked to from the first free cell of a room.
    fn keep_reachable(&mut self, first: Option<RoomId>) {
        let mut reached = vec![false; self.cells.len()];
        let start = self.cells.iter().position(|cell| cell.is_some() && *cell == first);
        let mut open: VecDeque<usize> = start.into_iter().collect();
        while let Some(index) = open.pop_front() {
            if reached[index] {
                continue;
            }
            reached[index] = true;
            let column = index % self.columns;
            let east = (column + 1 < self.columns).then_some(index + 1);
            let west = (column > 0).then(|| index - 1);
            let neighbours = [east, west, index.checked_add(self.columns), index.checked_sub(self.columns)];
            let is_open = |next: &usize| self.cells.get(*next).is_some_and(Option::is_some) && !reached[*next];
            open.extend(neighbours.into_iter().flatten().filter(is_open));
        }
        for (cell, reached) in self.cells.iter_mut().zip(reached) {
            *cell = cell.filter(|_| reached);
        }
    }
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "plans are small and lengths positive")]
fn cells_along(length_m: f32) -> usize {
    (length_m / CELL_M).max(0.0) as usize + 1
}

fn obstacles(layout: &Layout, catalog: &Catalog) -> Vec<Footprint> {
    let on_floor = layout.placements.iter().filter(|placement| placement.on.is_none() && !layout.is_door(placement));
    let prints = on_floor.filter_map(|placement| {
        let class = catalog.class(catalog.class_of_instance(&placement.instance)?);
        Some(Footprint::of(layout, placement, class))
    });
    prints.filter(is_obstacle).collect()
}

/// Whether a robot does not pass what stands on the floor, over it or below.
pub(super) fn is_obstacle(print: &Footprint) -> bool {
    print.height_m[0] < HEADROOM_M && print.height_m[1] > STEP_M
}

/// The room in which a disc can stand here, walls alone considered; in an opening, the first that it joins.
fn standing_room(layout: &Layout, point_m: [f32; 2], radius_m: f32) -> Option<RoomId> {
    let margin_m = HALF_WALL_M + radius_m;
    let room = layout.rooms.iter().find(|room| is_clear_of_walls(room, point_m, margin_m)).map(|room| room.id);
    room.or_else(|| {
        let walked = layout.openings.iter().filter(|opening| opening.kind != OpeningKind::Window);
        let mut around = walked.filter(|opening| {
            let [x, y] = [point_m[0] - opening.at_m[0], point_m[1] - opening.at_m[1]];
            let [along, across] = if opening.wall_runs == Axis::X { [x, y] } else { [y, x] };
            along.abs() <= opening.width_m / 2.0 - radius_m && across.abs() <= margin_m + CELL_M
        });
        around.next().map(|opening| layout.room_at(point_m[0], point_m[1]).unwrap_or(opening.between[0]))
    })
}

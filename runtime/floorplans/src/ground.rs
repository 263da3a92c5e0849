//! The floor of a room where somebody can walk, as a grid: the same cells as those by which `cohabit-cdf` checks floor plans.

use crate::geometry::{Block, HALF_WALL_M, Rect, Turn, Wall, bounds, is_clear};

/// Side of a cell, m.
const CELL_M: f32 = 0.1;
/// Half the width of a walkway, m.
const WALKWAY_M: f32 = 0.4;
/// Kept free of things besides, m: rounding decides nothing.
const SPARE_M: f32 = 0.003;
/// The farthest that a walkway may end from what is used from it, m; a little less than what is checked.
const REACH_M: f32 = 0.8;
/// The same for what is worked over furniture, m.
const REACH_OVER_M: f32 = 1.2;
/// What lies lower does not block, m.
const STEP_M: f32 = 0.07;
/// What begins higher does not block, m.
const HEADROOM_M: f32 = 1.4;
/// The first cells within a room from which walkways go on, from the middle of a wall, dm.
const FIRST: i32 = 5;

/// Something that is used from a walkway.
#[derive(Clone, Copy, Debug)]
pub struct Usable {
    pub block: Block,
    /// Where one has to stand before it; anywhere around it, if absent.
    pub front: Option<Turn>,
    /// Whether a hand works it over what stands below.
    pub is_over: bool,
}

/// The grid of a room.
#[derive(Clone, Debug)]
pub struct Ground {
    area: Rect,
    /// Where the walls leave room for a walkway.
    clear: Vec<bool>,
    /// How many things are too near.
    blocked: Vec<u8>,
    /// The cells behind each door, of which one is walked on.
    doors: Vec<[usize; 2]>,
    /// The cells from which each thing is used, of which one is walked on.
    usables: Vec<Vec<usize>>,
    /// What can be walked on, as of the last look.
    reached: Vec<bool>,
}

impl Ground {
    /// The bare floor of a room with doors at these places of its walls.
    pub fn new(rects: &[Rect], doors: &[(Wall, i32)]) -> Self {
        let area = bounds(rects);
        let mut ground = Self {
            area,
            clear: Vec::new(),
            blocked: Vec::new(),
            doors: Vec::new(),
            usables: Vec::new(),
            reached: Vec::new(),
        };
        let count = ground.columns() * ground.rows();
        ground.clear = (0..count).map(|index| is_clear(rects, ground.point(index), HALF_WALL_M + WALKWAY_M)).collect();
        ground.blocked = vec![0; count];
        ground.doors = doors.iter().map(|(wall, middle)| ground.cells_behind(*wall, *middle)).collect();
        ground.reached = ground.flood();
        ground
    }

    fn columns(&self) -> usize {
        usize::try_from(self.area.east - self.area.west).unwrap_or(0)
    }

    fn rows(&self) -> usize {
        usize::try_from(self.area.north - self.area.south).unwrap_or(0)
    }

    /// The middle of a cell, m.
    fn point(&self, index: usize) -> [f32; 2] {
        let middle = |start: i32, steps: usize| (start as f32 + steps as f32 + 0.5) * CELL_M;
        [middle(self.area.west, index % self.columns()), middle(self.area.south, index / self.columns())]
    }

    fn cells_behind(&self, wall: Wall, middle: i32) -> [usize; 2] {
        let into = if [Turn::NORTH, Turn::EAST].contains(&wall.faces) { FIRST } else { -FIRST - 1 };
        [middle - 1, middle].map(|along| {
            let [x, y] = if wall.faces == Turn::NORTH || wall.faces == Turn::SOUTH {
                [along, wall.at + into]
            } else {
                [wall.at + into, along]
            };
            let [column, row] = [x - self.area.west, y - self.area.south].map(|n| usize::try_from(n).unwrap_or(0));
            row * self.columns() + column
        })
    }

    /// The cells nearer than `within_m` to a box.
    fn near(&self, block: &Block, within_m: f32) -> Vec<usize> {
        let span = |axis: usize, start: i32, count: usize| {
            let first = ((block.low[axis] - within_m) / CELL_M - start as f32).floor().max(0.0) as usize;
            let last = ((block.high[axis] + within_m) / CELL_M - start as f32).ceil().max(0.0) as usize;
            first..last.min(count)
        };
        let columns = span(0, self.area.west, self.columns());
        let rows = span(1, self.area.south, self.rows());
        let all = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
        let cells = all.map(|(row, column)| row * self.columns() + column);
        cells.filter(|cell| block.distance_m(self.point(*cell)) < within_m).collect()
    }

    /// Puts things down and what is used of them, if then all doors and all that is used can still be walked to.
    pub fn try_add(&mut self, things: &[Block], usables: &[Usable]) -> bool {
        let cells: Vec<usize> = things
            .iter()
            .filter(|block| blocks(block))
            .flat_map(|block| self.near(block, WALKWAY_M + SPARE_M))
            .collect();
        for cell in &cells {
            self.blocked[*cell] = self.blocked[*cell].saturating_add(1);
        }
        let used_from: Vec<Vec<usize>> = usables.iter().map(|usable| self.cells_before(usable)).collect();
        self.usables.extend(used_from);
        let reached = self.flood();
        if self.is_sound(&reached) {
            self.reached = reached;
            return true;
        }
        for cell in &cells {
            self.blocked[*cell] = self.blocked[*cell].saturating_sub(1);
        }
        self.usables.truncate(self.usables.len() - usables.len());
        false
    }

    fn is_free(&self, cell: usize) -> bool {
        self.clear[cell] && self.blocked[cell] == 0
    }

    /// What can be walked to from the first door; from the first free cell, where there is no door.
    fn flood(&self) -> Vec<bool> {
        let mut reached = vec![false; self.clear.len()];
        let mut open: Vec<usize> = match self.doors.first() {
            Some(cells) => cells.iter().copied().filter(|cell| self.is_free(*cell)).collect(),
            None => self.first_free().into_iter().collect(),
        };
        let columns = self.columns();
        while let Some(cell) = open.pop() {
            if std::mem::replace(&mut reached[cell], true) {
                continue;
            }
            let column = cell % columns;
            let east = (column + 1 < columns).then_some(cell + 1);
            let west = (column > 0).then(|| cell - 1);
            let around = [east, west, Some(cell + columns), cell.checked_sub(columns)];
            let is_open = |next: &usize| *next < reached.len() && !reached[*next] && self.is_free(*next);
            open.extend(around.into_iter().flatten().filter(is_open));
        }
        reached
    }

    fn first_free(&self) -> Option<usize> {
        (0..self.clear.len()).find(|cell| self.is_free(*cell))
    }

    /// Whether all doors lead into the same floor, and all that is used is near it. The first free cell, where checks of whole plans
    /// begin, is part of it.
    fn is_sound(&self, reached: &[bool]) -> bool {
        let is_door_reached = |cells: &[usize; 2]| cells.iter().any(|cell| reached[*cell]);
        self.doors.iter().all(is_door_reached)
            && self.first_free().is_some_and(|cell| reached[cell])
            && self.usables.iter().all(|cells| cells.iter().any(|cell| reached[*cell]))
    }

    /// The cells from which something is used.
    fn cells_before(&self, usable: &Usable) -> Vec<usize> {
        let is_before =
            |cell: &usize| usable.front.is_none_or(|front| is_before(&usable.block, front, self.point(*cell)));
        let within_m = if usable.is_over { REACH_OVER_M } else { REACH_M };
        self.near(&usable.block, within_m).into_iter().filter(is_before).collect()
    }

    /// The middles of the cells that can be walked on, m, row by row from the south.
    pub fn walkable(&self) -> impl Iterator<Item = [f32; 2]> + '_ {
        self.reached.iter().enumerate().filter(|(_, reached)| **reached).map(|(cell, _)| self.point(cell))
    }
}

/// Whether nobody passes over or below it.
fn blocks(block: &Block) -> bool {
    block.low[2] < HEADROOM_M && block.high[2] > STEP_M
}

/// Whether a point is before the front of a box, give or take a little to both sides.
fn is_before(block: &Block, front: Turn, point: [f32; 2]) -> bool {
    const BESIDE_M: f32 = 0.15;
    let middle = [0, 1].map(|axis| (block.low[axis] + block.high[axis]) / 2.0);
    let half = [0, 1].map(|axis| (block.high[axis] - block.low[axis]) / 2.0);
    let [x, y] = front.inverse().apply([point[0] - middle[0], point[1] - middle[1]]);
    let [depth, width] = front.size(half);
    x >= depth && y.abs() <= width + BESIDE_M
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of 4 m by 3 m with a door in the middle of its southern wall, and a thing in it.
    fn takes(low: [f32; 2], high: [f32; 2], usables: &[Usable]) -> bool {
        let south = Wall { faces: Turn::NORTH, at: 0, from: 0, to: 40 };
        let mut ground = Ground::new(&[Rect::new(0, 0, 40, 30)], &[(south, 20)]);
        ground.try_add(&[Block::between(low, high, [0.0, 1.0])], usables)
    }

    #[test]
    fn what_is_used_has_a_walkway_before_it() {
        let block = Block::between([0.1, 1.0], [0.6, 2.0], [0.0, 1.0]);
        let usable = |front| Usable { block, front: Some(front), is_over: false };
        assert!(takes([0.1, 1.0], [0.6, 2.0], &[usable(Turn::EAST)]));
        assert!(!takes([0.1, 1.0], [0.6, 2.0], &[usable(Turn::WEST)]));
    }

    #[test]
    fn what_hangs_is_worked_over_what_stands_below() {
        let block = Block::between([0.06, 1.0], [0.18, 2.0], [1.0, 2.5]);
        let usable = |is_over| Usable { block, front: None, is_over };
        assert!(takes([0.1, 0.06], [0.9, 2.94], &[usable(true)]));
        assert!(!takes([0.1, 0.06], [0.9, 2.94], &[usable(false)]));
    }

    #[test]
    fn a_door_is_not_shut_off() {
        assert!(takes([0.1, 1.0], [1.0, 1.5], &[]));
        assert!(!takes([0.1, 0.3], [3.9, 0.6], &[]));
    }
}

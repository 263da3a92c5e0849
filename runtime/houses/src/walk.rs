//! Whether the place in a room where the check of floor plans begins to walk is on the floor from which all else is walked to: behind
//! furniture there may be places where a robot can stand, and none can go.

use cohabit_floorplans::parts::{Block, HALF_WALL_M, Placed, Rect, Site, is_clear, metres};

/// Side of a cell, m.
const CELL_M: f32 = 0.1;
/// Radii that are walked with: a robot's, and half the width of a walkway, m; each a little less and a little more, so that rounding
/// decides nothing.
const RADII_M: [[f32; 2]; 2] = [[0.248, 0.252], [0.398, 0.404]];
/// What lies lower, or begins higher, does not block, m.
const BLOCKS_M: [f32; 2] = [0.07, 1.4];

/// The cells of a room where a disc can stand.
struct Cells {
    columns: usize,
    is_free: Vec<bool>,
    west: i32,
    south: i32,
}

/// Whether the first free places of a room and of its mirror image are on the floor that is walked on.
pub fn begins_on_its_floor(site: &Site<'_>) -> bool {
    let Some(goal_m) = site.walkable_m().next() else { return false };
    RADII_M.into_iter().all(|[less_m, more_m]| {
        let (all, certain) = (Cells::of(site, less_m), Cells::of(site, more_m));
        let reached = certain.from(certain.at(goal_m));
        [false, true].into_iter().all(|is_mirrored| {
            for cell in all.in_order(is_mirrored) {
                let is_joined = || all.around(cell).any(|next| reached.get(next).copied().unwrap_or(false));
                match (certain.is_free[cell], all.is_free[cell]) {
                    (true, _) => return reached[cell],
                    // Whether it is free is a matter of rounding: it is if it leads on.
                    (false, true) if !is_joined() => return false,
                    _ => {}
                }
            }
            false
        })
    })
}

impl Cells {
    fn of(site: &Site<'_>, radius_m: f32) -> Self {
        let ends = |of: fn(&Rect) -> i32| site.rects.iter().map(of);
        let west = ends(|rect| rect.west).min().unwrap_or(0);
        let south = ends(|rect| rect.south).min().unwrap_or(0);
        let east = ends(|rect| rect.east).max().unwrap_or(0);
        let north = ends(|rect| rect.north).max().unwrap_or(0);
        let [columns, rows] = [east - west, north - south].map(|count| usize::try_from(count).unwrap_or(0));
        let mut cells = Self { columns, is_free: Vec::new(), west, south };
        let is_clear = |cell: usize| is_clear(&site.rects, cells.point_m(cell), HALF_WALL_M + radius_m);
        cells.is_free = (0..columns * rows).map(is_clear).collect();
        let blocks = |block: &Block| block.high[2] > BLOCKS_M[0] && block.low[2] < BLOCKS_M[1];
        for block in site.placed.iter().filter_map(Placed::block).filter(blocks) {
            cells.take(&block, radius_m);
        }
        cells
    }

    /// Takes what is nearer to something than a radius.
    fn take(&mut self, block: &Block, radius_m: f32) {
        let rows = self.is_free.len() / self.columns.max(1);
        let span = |axis: usize, start: i32, count: usize| {
            let steps = |at_m: f32| ((at_m - metres(start)) / CELL_M).max(0.0) as usize;
            steps(block.low[axis] - radius_m)..(steps(block.high[axis] + radius_m) + 2).min(count)
        };
        for row in span(1, self.south, rows) {
            for column in span(0, self.west, self.columns) {
                let cell = row * self.columns + column;
                self.is_free[cell] &= block.distance_m(self.point_m(cell)) >= radius_m;
            }
        }
    }

    fn point_m(&self, cell: usize) -> [f32; 2] {
        let middle = |start: i32, steps: usize| metres(start) + (steps as f32 + 0.5) * CELL_M;
        [middle(self.west, cell % self.columns), middle(self.south, cell / self.columns)]
    }

    fn at(&self, [x, y]: [f32; 2]) -> usize {
        let steps = |at: f32, start: i32| ((at - metres(start)) / CELL_M) as usize;
        steps(y, self.south) * self.columns + steps(x, self.west)
    }

    /// All cells row by row from the south, each row from the west, or from the east.
    fn in_order(&self, is_mirrored: bool) -> impl Iterator<Item = usize> {
        let columns = self.columns;
        let mirrored = move |cell: usize| cell / columns * columns + columns - 1 - cell % columns;
        (0..self.is_free.len()).map(move |cell| if is_mirrored { mirrored(cell) } else { cell })
    }

    /// The cells beside one; some may be beyond the last.
    fn around(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (column, columns) = (cell % self.columns, self.columns);
        let east = (column + 1 < columns).then_some(cell + 1);
        let west = (column > 0).then(|| cell - 1);
        [east, west, Some(cell + columns), cell.checked_sub(columns)].into_iter().flatten()
    }

    /// What can be walked to from a cell.
    fn from(&self, start: usize) -> Vec<bool> {
        let mut reached = vec![false; self.is_free.len()];
        let mut open = vec![start];
        while let Some(cell) = open.pop() {
            let is_free = self.is_free.get(cell).copied().unwrap_or(false);
            if is_free && !std::mem::replace(&mut reached[cell], true) {
                open.extend(self.around(cell));
            }
        }
        reached
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;
    use cohabit_floorplans::parts::{Arrangement, Turn};

    use super::*;

    #[test]
    fn a_place_behind_furniture_that_nobody_gets_to_is_no_beginning() {
        let catalog = Catalog::builtin();
        let check = |along: [f32; 2], expected: bool| {
            let mut site = Site::new(&catalog, &[Rect::new(0, 0, 40, 40)], &[], Vec::new());
            // Of 1.6 m by 0.8 m: with 0.6 m behind it, a robot has a place there, and a walkway has none.
            let desk = Arrangement::of(catalog.find("Desk_01").unwrap(), &catalog);
            for x in along {
                assert!(site.try_place(&desk, [x, 1.1, 0.0], Turn::NORTH));
            }
            assert_eq!(begins_on_its_floor(&site), expected, "{along:?}");
        };
        // Beside them a way of 0.6 m is left, and one of 0.5 m, which is too narrow.
        check([0.9, 2.54], true);
        check([0.9, 2.64], false);
    }
}

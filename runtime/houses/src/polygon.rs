//! Rectilinear polygons on a lattice: whether one is the outline of a floor, and the rectangles that it is made of.

use cohabit_cdf::model::Axis;
use cohabit_floorplans::parts::Rect;

/// Why a polygon is no outline of a floor.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum PolygonFault {
    /// The side that begins at a corner is along no axis.
    Slanted(usize),
    /// The side that begins at a corner meets another one.
    Crossing(usize),
    /// It has no inside.
    Empty,
}

/// A corner, and which of the points that were given it is.
#[derive(Clone, Copy, Debug)]
struct Corner {
    point: [i32; 2],
    index: usize,
}

/// A floor without holes whose sides are along the axes.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Outline(Vec<[i32; 2]>);

impl Outline {
    /// The outline through these points; those within a straight side count for nothing.
    pub fn of(points: &[[i32; 2]]) -> Result<Self, PolygonFault> {
        let corners = points.iter().enumerate().map(|(index, point)| Corner { point: *point, index }).collect();
        let corners = simplified(corners)?;
        if corners.len() < 4 {
            return Err(PolygonFault::Empty);
        }
        let count = corners.len();
        for first in 0..count {
            // Sides that follow each other share a corner and nothing else: they are at right angles.
            for second in first + 2..count {
                let is_next = first == 0 && second == count - 1;
                if !is_next && meet(side(&corners, first), side(&corners, second)) {
                    return Err(PolygonFault::Crossing(corners[second].index));
                }
            }
        }
        Ok(Self(corners.into_iter().map(|corner| corner.point).collect()))
    }

    /// Rectangles that fill it without gap or overlap, each as long along an axis as the outline allows.
    pub fn rects(&self, along: Axis) -> Vec<Rect> {
        if along == Axis::X {
            return slabs(&self.0);
        }
        let exchanged: Vec<[i32; 2]> = self.0.iter().map(|[x, y]| [*y, *x]).collect();
        slabs(&exchanged).into_iter().map(|rect| Rect::new(rect.south, rect.west, rect.north, rect.east)).collect()
    }
}

/// The ends of a side.
fn side(corners: &[Corner], index: usize) -> [[i32; 2]; 2] {
    [corners[index].point, corners[(index + 1) % corners.len()].point]
}

/// Whether two sides along the axes have a point in common.
fn meet([a, b]: [[i32; 2]; 2], [c, d]: [[i32; 2]; 2]) -> bool {
    (0..2).all(|axis| {
        let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
        c[axis].min(d[axis]) <= high && low <= c[axis].max(d[axis])
    })
}

/// Without points that are no corners.
fn simplified(mut corners: Vec<Corner>) -> Result<Vec<Corner>, PolygonFault> {
    for index in 0..corners.len() {
        let [from, to] = side(&corners, index);
        if from[0] != to[0] && from[1] != to[1] {
            return Err(PolygonFault::Slanted(corners[index].index));
        }
    }
    loop {
        let count = corners.len();
        let is_none = |index: &usize| {
            let [before, at, behind] = [index + count - 1, *index, index + 1].map(|index| corners[index % count].point);
            (0..2).any(|axis| before[axis] == at[axis] && at[axis] == behind[axis])
        };
        let Some(index) = (0..count).find(is_none) else { return Ok(corners) };
        let [before, at, behind] = [index + count - 1, index, index + 1].map(|index| corners[index % count].point);
        let turns_back = (0..2).any(|axis| (at[axis] - before[axis]).signum() * (behind[axis] - at[axis]).signum() < 0);
        if turns_back {
            return Err(PolygonFault::Crossing(corners[index].index));
        }
        corners.remove(index);
    }
}

/// Rectangles as long along x as the outline allows.
fn slabs(corners: &[[i32; 2]]) -> Vec<Rect> {
    let mut heights: Vec<i32> = corners.iter().map(|[_, y]| *y).collect();
    heights.sort_unstable();
    heights.dedup();
    let mut rects: Vec<Rect> = Vec::new();
    for heights in heights.windows(2) {
        let [south, north] = [heights[0], heights[1]];
        let mut walls: Vec<i32> = (0..corners.len())
            .map(|index| [corners[index], corners[(index + 1) % corners.len()]])
            .filter(|[from, to]| from[1].min(to[1]) <= south && north <= from[1].max(to[1]))
            .map(|[from, _]| from[0])
            .collect();
        walls.sort_unstable();
        for pair in walls.chunks_exact(2) {
            let [west, east] = [pair[0], pair[1]];
            let below = |rect: &&mut Rect| rect.north == south && rect.west == west && rect.east == east;
            match rects.iter_mut().find(below) {
                Some(rect) => rect.north = north,
                None => rects.push(Rect::new(west, south, east, north)),
            }
        }
    }
    rects
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const L: [[i32; 2]; 6] = [[0, 0], [60, 0], [60, 30], [20, 30], [20, 50], [0, 50]];

    #[test]
    fn an_l_is_cut_along_either_axis() {
        let outline = Outline::of(&L).unwrap();
        assert_eq!(outline.rects(Axis::X), [Rect::new(0, 0, 60, 30), Rect::new(0, 30, 20, 50)]);
        assert_eq!(outline.rects(Axis::Y), [Rect::new(0, 0, 20, 50), Rect::new(20, 0, 60, 30)]);
    }

    #[test]
    fn points_within_a_side_are_no_corners() {
        let square = [[0, 0], [10, 0], [20, 0], [20, 20], [20, 20], [0, 20], [0, 10]];
        assert_eq!(Outline::of(&square).unwrap().rects(Axis::X), [Rect::new(0, 0, 20, 20)]);
    }

    #[test]
    fn what_is_no_outline_is_refused_at_its_corner() {
        let check = |points: &[[i32; 2]], expected| assert_eq!(Outline::of(points), Err(expected), "{points:?}");
        check(&[[0, 0], [10, 0], [15, 10], [0, 10]], PolygonFault::Slanted(1));
        check(&[[0, 0], [10, 0], [5, 0], [5, 10], [0, 10]], PolygonFault::Crossing(1));
        // A figure of eight.
        check(&[[0, 0], [20, 0], [20, 20], [10, 20], [10, -10], [0, -10]], PolygonFault::Crossing(3));
        check(&[[0, 0], [10, 0]], PolygonFault::Crossing(0));
        check(&[[3, 3]], PolygonFault::Empty);
        check(&[], PolygonFault::Empty);
    }

    #[test]
    fn the_way_round_does_not_matter() {
        let mut backwards = L;
        backwards.reverse();
        assert_eq!(Outline::of(&backwards).unwrap().rects(Axis::X), Outline::of(&L).unwrap().rects(Axis::X));
    }

    /// Columns of floor side by side, each with some in common with the next: width, how far its south is from the one before, depth.
    fn columns() -> impl Strategy<Value = Vec<[i32; 4]>> {
        let column = (1..9, -6..=6, 1..12).prop_map(|(width, step, depth): (i32, i32, i32)| [width, step, depth]);
        prop::collection::vec(column, 1..9).prop_map(|columns| {
            let (mut west, mut before): (i32, Option<[i32; 2]>) = (-5, None);
            let place = |[width, step, depth]: [i32; 3]| {
                let south = before.map_or(step, |[south, north]| (south + step).clamp(south + 1 - depth, north - 1));
                before = Some([south, south + depth]);
                west += width;
                [west - width, south, west, south + depth]
            };
            columns.into_iter().map(place).collect()
        })
    }

    /// The corners round all columns.
    fn around(columns: &[[i32; 4]]) -> Vec<[i32; 2]> {
        let along_south = columns.iter().flat_map(|[west, south, east, _]| [[*west, *south], [*east, *south]]);
        let along_north = columns.iter().rev().flat_map(|[west, _, east, north]| [[*east, *north], [*west, *north]]);
        along_south.chain(along_north).collect()
    }

    proptest! {
        #[test]
        fn rectangles_fill_an_outline_without_gap_or_overlap(columns in columns(), is_turned: bool, first in 0_usize..40) {
            let turned = |[x, y]: [i32; 2]| if is_turned { [y, x] } else { [x, y] };
            let mut corners: Vec<[i32; 2]> = around(&columns).into_iter().map(turned).collect();
            let count = corners.len();
            corners.rotate_left(first % count);
            let outline = Outline::of(&corners).unwrap();
            let is_floor = |x: i32, y: i32| {
                let [x, y] = turned([x, y]);
                columns.iter().any(|[west, south, east, north]| (*west..*east).contains(&x) && (*south..*north).contains(&y))
            };
            for axis in [Axis::X, Axis::Y] {
                let rects = outline.rects(axis);
                prop_assert!(rects.iter().all(|rect| rect.west < rect.east && rect.south < rect.north));
                // Each square of the lattice is in one rectangle, or in none if it is no floor.
                for (x, y) in (-80..80).flat_map(|x| (-80..80).map(move |y| (x, y))) {
                    let has = |rect: &&Rect| (rect.west..rect.east).contains(&x) && (rect.south..rect.north).contains(&y);
                    prop_assert_eq!(rects.iter().filter(has).count(), usize::from(is_floor(x, y)), "{} {}", x, y);
                }
            }
        }
    }
}

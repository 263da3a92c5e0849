//! The lattice of 0.1 m that rooms lie on, in the positive quadrant: each wall of a house goes to the nearest line, and what is between
//! two walls stays between them.

use crate::house::HouseRoom;

/// Walls that are nearer to each other are one, m.
const SAME_M: f64 = 0.03;

/// The lines of the walls along both axes.
#[derive(Clone, Debug)]
pub struct Lattice {
    axes: [Vec<Line>; 2],
}

/// The walls at one place across an axis.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Where they begin and end in the house, m.
    from_m: f64,
    to_m: f64,
    /// Where they are in the floor plan, dm.
    dm: i32,
}

impl Lattice {
    /// For the walls of some rooms.
    pub fn of(rooms: &[HouseRoom]) -> Self {
        let axis = |axis: usize| lines(rooms.iter().flat_map(|room| &room.corners_m).map(|corner| corner[axis]));
        Self { axes: [axis(0), axis(1)] }
    }

    /// The place of a corner of a room, dm.
    pub fn corner(&self, corner_m: [f64; 2]) -> [i32; 2] {
        [0, 1].map(|axis| {
            let line = self.axes[axis].iter().find(|line| (line.from_m..=line.to_m).contains(&corner_m[axis]));
            line.map_or(0, |line| line.dm)
        })
    }

    /// The place of any other point, m.
    pub fn point_m(&self, point_m: [f64; 2]) -> [f32; 2] {
        [0, 1].map(|axis| place(&self.axes[axis], point_m[axis]) as f32)
    }
}

fn lines(walls_m: impl Iterator<Item = f64>) -> Vec<Line> {
    let mut walls: Vec<f64> = walls_m.collect();
    walls.sort_by(f64::total_cmp);
    let mut lines: Vec<Line> = Vec::new();
    let first_m = walls.first().copied().unwrap_or_default();
    for at_m in walls {
        match lines.last_mut().filter(|line| at_m - line.from_m <= SAME_M) {
            Some(line) => line.to_m = at_m,
            None => lines.push(Line { from_m: at_m, to_m: at_m, dm: ((at_m - first_m) * 10.0).round() as i32 }),
        }
    }
    lines
}

/// Where a point is in the floor plan, m: between two walls in proportion, beyond all of them at its distance.
fn place(lines: &[Line], at_m: f64) -> f64 {
    let middle = |line: &Line| (line.from_m + line.to_m) / 2.0;
    let metres = |line: &Line| f64::from(line.dm) / 10.0;
    let next = lines.iter().position(|line| middle(line) > at_m).unwrap_or(lines.len());
    match (next.checked_sub(1).and_then(|index| lines.get(index)), lines.get(next)) {
        (Some(low), Some(high)) => {
            let share = (at_m - middle(low)) / (middle(high) - middle(low));
            metres(low) + share * (metres(high) - metres(low))
        }
        (Some(line), None) | (None, Some(line)) => metres(line) + at_m - middle(line),
        (None, None) => at_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(corners_m: &[[f64; 2]]) -> Lattice {
        let room = |corners_m: Vec<[f64; 2]>| HouseRoom {
            at: String::new(),
            id: String::new(),
            kind: String::new(),
            corners_m,
            floor: String::new(),
        };
        Lattice::of(&[room(corners_m.to_vec())])
    }

    #[test]
    fn a_house_goes_to_the_positive_quadrant() {
        let lattice = lattice(&[[-2.04, 1.0], [1.93, 1.001], [1.94, 4.48], [-2.04, 4.48]]);
        assert_eq!(lattice.corner([-2.04, 1.001]), [0, 0]);
        assert_eq!(lattice.corner([1.93, 4.48]), lattice.corner([1.94, 4.48]));
        assert_eq!(lattice.corner([1.94, 4.48]), [40, 35]);
    }

    #[test]
    fn what_is_between_walls_stays_between_them() {
        let lattice = lattice(&[[0.0, 0.0], [3.96, 0.0], [3.96, 3.0], [0.0, 3.0]]);
        let [x, y] = lattice.point_m([1.98, 1.5]);
        assert!((x - 2.0).abs() < 1e-6 && (y - 1.5).abs() < 1e-6, "{x} {y}");
        assert!((lattice.point_m([4.96, 0.0])[0] - 5.0).abs() < 1e-6);
    }
}

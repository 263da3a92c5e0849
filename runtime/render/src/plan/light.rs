//! How much of its room's lamplight reaches a place on a floor, wall or ceiling: baked once a corner.

use glam::{Vec2, Vec3};

/// Ceiling tiles, and so lamps, lie on a grid of this size, m.
pub(super) const GRID_M: f32 = 0.6;

/// Where a rectangle's lamps hang: the least corner of each, all of 0.6 m by 1.2 m, along y if `along_y`.
pub(super) struct Lamps {
    pub corners: Vec<Vec2>,
    pub along_y: bool,
}

impl Lamps {
    pub(super) fn new([west, south, east, north]: [f32; 4]) -> Self {
        let along_y = north - south >= east - west;
        let (step_x, step_y) = if along_y { (2.4, 3.0) } else { (3.0, 2.4) };
        let size = if along_y { [GRID_M, 2.0 * GRID_M] } else { [2.0 * GRID_M, GRID_M] };
        let row = |low: f32, high: f32, step: f32, size: f32| -> Vec<f32> {
            let count = ((high - low) / step).round().max(1.0);
            (0..count as u32)
                .map(|i| {
                    let middle = low + (high - low) * (i as f32 + 0.5) / count;
                    ((middle - size * 0.5) / GRID_M).round() * GRID_M
                })
                .filter(|at| *at > low + 0.1 && *at + size < high - 0.1)
                .collect()
        };
        let (xs, ys) = (row(west, east, step_x, size[0]), row(south, north, step_y, size[1]));
        let corners = xs.iter().flat_map(|x| ys.iter().map(|y| Vec2::new(*x, *y))).collect();
        Self { corners, along_y }
    }

    fn centers(&self) -> impl Iterator<Item = Vec2> {
        let half = if self.along_y { Vec2::new(GRID_M * 0.5, GRID_M) } else { Vec2::new(GRID_M, GRID_M * 0.5) };
        self.corners.iter().map(move |corner| *corner + half)
    }
}

/// A room as its lamps see it.
pub(super) struct RoomLight<'a> {
    pub rects: &'a [[f32; 4]],
    pub lamps: &'a [Lamps],
    pub height_m: f32,
}

impl RoomLight<'_> {
    /// The light at a place of a surface with this normal; around 1.
    pub(super) fn at(&self, position: Vec3, normal: Vec3) -> f32 {
        let mut direct = 0.0;
        for lamp in self.lamps.iter().flat_map(Lamps::centers) {
            let towards = lamp.extend(self.height_m) - position;
            let squared = towards.length_squared().max(0.3);
            let (down, facing) = (towards.z, towards.dot(normal));
            if facing > 0.0 && down > 0.0 {
                direct += facing * down / (squared * squared);
            }
        }
        // A ceiling gets what the floor throws back.
        let direct = if normal.z < -0.5 { 0.35 } else { (direct * 1.5).min(1.3) };
        (0.60 + 0.42 * direct) * self.corners(position, normal)
    }

    /// Darker in the corners of the room.
    fn corners(&self, position: Vec3, normal: Vec3) -> f32 {
        let mut open = 1.0;
        let mut near = |distance: f32, strength: f32| {
            let t = (distance.max(0.0) / 0.55).min(1.0);
            open *= 1.0 - strength * (1.0 - t) * (1.0 - t);
        };
        if normal.z.abs() < 0.5 {
            near(position.z, 0.30);
            near(self.height_m - position.z, 0.16);
        }
        for side in 0..4 {
            let (axis, sign) = (side % 2, if side < 2 { 1.0 } else { -1.0 });
            if normal[axis].abs() < 0.5 {
                near(self.to_wall(position, axis, sign), 0.24);
            }
        }
        open
    }

    /// How far it is to the next wall along an axis, over all rectangles that hold the place.
    fn to_wall(&self, position: Vec3, axis: usize, sign: f32) -> f32 {
        let holds = |rect: &&[f32; 4]| {
            let slack = 0.07;
            rect[0] - slack <= position.x
                && position.x <= rect[2] + slack
                && rect[1] - slack <= position.y
                && position.y <= rect[3] + slack
        };
        let reach =
            |rect: &[f32; 4]| if sign > 0.0 { rect[axis + 2] - position[axis] } else { position[axis] - rect[axis] };
        self.rects.iter().filter(holds).map(reach).fold(0.0, f32::max) - super::HALF_WALL_M
    }
}

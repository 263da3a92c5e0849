//! The rectangle of floor under an object, and the height it fills.

use super::{Layout, Placement, Room};
use crate::catalog::ObjectClass;

/// An upright box: a turned rectangle seen from above, from a height to a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Footprint {
    center_m: [f32; 2],
    half_m: [f32; 2],
    /// Direction of its front.
    front: [f32; 2],
    /// From and to, m above the floor.
    pub height_m: [f32; 2],
}

impl Footprint {
    /// What `placement`, an object of `class`, fills in the world.
    pub fn of(layout: &Layout, placement: &Placement, class: &ObjectClass) -> Self {
        let [x, y, z] = layout.origin_in_world_m(placement);
        let yaw = placement.yaw_deg.to_radians();
        let [depth, width, height] = [0, 1, 2].map(|axis| class.size_m[axis] * placement.scale[axis]);
        Self {
            center_m: [x, y],
            half_m: [depth / 2.0, width / 2.0],
            front: [libm::cosf(yaw), libm::sinf(yaw)],
            height_m: [z, z + height],
        }
    }

    /// An upright box along the world's axes, from floor to `height_m`.
    pub fn upright(center_m: [f32; 2], half_m: [f32; 2], height_m: f32) -> Self {
        Self { center_m, half_m, front: [1.0, 0.0], height_m: [0.0, height_m] }
    }

    /// A point in its own frame.
    fn local(&self, point_m: [f32; 2]) -> [f32; 2] {
        let [x, y] = [point_m[0] - self.center_m[0], point_m[1] - self.center_m[1]];
        [x * self.front[0] + y * self.front[1], y * self.front[0] - x * self.front[1]]
    }

    /// Its corners.
    pub fn corners_m(&self) -> [[f32; 2]; 4] {
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[along, across]| {
            let [x, y] = [along * self.half_m[0], across * self.half_m[1]];
            [
                self.center_m[0] + x * self.front[0] - y * self.front[1],
                self.center_m[1] + x * self.front[1] + y * self.front[0],
            ]
        })
    }

    /// How far a point is from it on the floor, m; 0 inside.
    pub fn distance_m(&self, point_m: [f32; 2]) -> f32 {
        let [x, y] = self.local(point_m);
        libm::hypotf((x.abs() - self.half_m[0]).max(0.0), (y.abs() - self.half_m[1]).max(0.0))
    }

    /// Whether the two boxes share more than `slack_m` in every direction.
    pub fn overlaps(&self, other: &Self, slack_m: f32) -> bool {
        let low = self.height_m[0].max(other.height_m[0]);
        let high = self.height_m[1].min(other.height_m[1]);
        high - low > slack_m && self.covers_side_of(other, slack_m) && other.covers_side_of(self, slack_m)
    }

    /// Whether `other` reaches over this one's sides: half of the separating axis test.
    fn covers_side_of(&self, other: &Self, slack_m: f32) -> bool {
        let corners = other.corners_m().map(|corner| self.local(corner));
        (0..2).all(|axis| {
            let least = corners.iter().map(|corner| corner[axis]).fold(f32::INFINITY, f32::min);
            let most = corners.iter().map(|corner| corner[axis]).fold(f32::NEG_INFINITY, f32::max);
            least < self.half_m[axis] - slack_m && most > slack_m - self.half_m[axis]
        })
    }

    /// Whether it stays on the floor of `room`, `margin_m` clear of the middle of the walls.
    pub fn fits(&self, room: &Room, margin_m: f32) -> bool {
        self.corners_m().into_iter().all(|corner| is_clear_of_walls(room, corner, margin_m))
    }
}

/// Whether a point lies on a room's floor, at least `margin_m` from the middle of its walls.
pub(super) fn is_clear_of_walls(room: &Room, [x_m, y_m]: [f32; 2], margin_m: f32) -> bool {
    [[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].into_iter().all(|[x, y]| {
        room.rects_m.iter().any(|rect| {
            let [x, y] = [x_m + x * margin_m, y_m + y * margin_m];
            x >= rect[0] && x <= rect[2] && y >= rect[1] && y <= rect[3]
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x_m: f32, y_m: f32, yaw_deg: f32) -> Footprint {
        let yaw = yaw_deg.to_radians();
        Footprint { center_m: [x_m, y_m], half_m: [0.5, 0.5], front: [yaw.cos(), yaw.sin()], height_m: [0.0, 1.0] }
    }

    #[test]
    fn squares_overlap_as_they_look() {
        let cases = [
            (square(0.0, 0.0, 0.0), square(0.9, 0.0, 0.0), true),
            (square(0.0, 0.0, 0.0), square(1.1, 0.0, 0.0), false),
            (square(0.0, 0.0, 0.0), square(1.1, 0.0, 45.0), true),
            (square(0.0, 0.0, 0.0), square(1.15, 1.15, 45.0), false),
        ];
        for (a, b, expected) in cases {
            assert_eq!(a.overlaps(&b, 0.001), expected, "{a:?} {b:?}");
            assert_eq!(b.overlaps(&a, 0.001), expected, "{b:?} {a:?}");
        }
    }

    #[test]
    fn distance_is_to_the_nearest_side() {
        assert!((square(0.0, 0.0, 90.0).distance_m([2.0, 0.0]) - 1.5).abs() < 1e-5);
        assert_eq!(square(0.0, 0.0, 30.0).distance_m([0.1, 0.2]), 0.0);
    }
}

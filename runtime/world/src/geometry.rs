//! Flat geometry: oriented rectangles, segments, angles. Never knows what they stand for.

use glam::{Quat, Vec2, Vec3};
use serde::{Deserialize, Serialize};

/// The grid of inflated outlines, m: a power of two, so that its points are exact.
pub(crate) const GRID_M: f32 = 1.0 / 512.0;

/// Where something is, and which way it is turned.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Pose {
    /// Its origin in the world, m.
    pub position: Vec3,
    /// World from object.
    pub rotation: Quat,
}

impl Pose {
    /// A pose turned about `z` alone.
    pub fn level(position: Vec3, yaw_rad: f32) -> Self {
        Self { position, rotation: turn(yaw_rad) }
    }

    /// A point given in this frame, in the world.
    pub fn point(&self, local: Vec3) -> Vec3 {
        self.position + self.rotation * local
    }

    /// The heading of its `x` axis, rad.
    pub fn yaw_rad(&self) -> f32 {
        heading((self.rotation * Vec3::X).truncate())
    }
}

/// The rotation about `z` by this yaw.
pub(crate) fn turn(yaw_rad: f32) -> Quat {
    Quat::from_xyzw(0.0, 0.0, libm::sinf(yaw_rad * 0.5), libm::cosf(yaw_rad * 0.5))
}

/// The unit vector of a heading.
pub(crate) fn direction(yaw_rad: f32) -> Vec2 {
    Vec2::new(libm::cosf(yaw_rad), libm::sinf(yaw_rad))
}

/// The heading of a vector, rad.
pub(crate) fn heading(vector: Vec2) -> f32 {
    libm::atan2f(vector.y, vector.x)
}

/// The same angle in `(-π, π]`.
pub(crate) fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let angle = libm::fmodf(angle_rad, TAU);
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}

/// A rectangle on the floor, turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Footprint {
    /// Its middle, m.
    pub center: Vec2,
    /// Half its extent along its own axes, m.
    pub half: Vec2,
    /// The direction of its own `x`.
    pub axis: Vec2,
}

impl Footprint {
    /// A rectangle at `center`, turned by `yaw_rad`.
    pub fn new(center: Vec2, half: Vec2, yaw_rad: f32) -> Self {
        Self { center, half, axis: direction(yaw_rad) }
    }

    /// A point of the floor in its own frame.
    pub fn local(&self, point: Vec2) -> Vec2 {
        let from = point - self.center;
        Vec2::new(from.dot(self.axis), from.dot(self.axis.perp()))
    }

    /// A point of its own frame on the floor.
    pub fn world(&self, local: Vec2) -> Vec2 {
        self.center + self.axis * local.x + self.axis.perp() * local.y
    }

    /// The point of the rectangle nearest to `point`.
    pub fn closest(&self, point: Vec2) -> Vec2 {
        self.world(self.local(point).clamp(-self.half, self.half))
    }

    /// How far outside it `point` is; 0 inside.
    pub fn distance(&self, point: Vec2) -> f32 {
        (self.local(point).abs() - self.half).max(Vec2::ZERO).length()
    }

    /// How far the segment from `a` to `b` is from it.
    pub fn distance_to(&self, a: Vec2, b: Vec2) -> f32 {
        if self.cut_by(a, b) {
            return 0.0;
        }
        let corners = self.corners().map(|corner| nearest_on(a, b, corner).distance(corner));
        corners.into_iter().fold(self.distance(a).min(self.distance(b)), f32::min)
    }

    /// The corners, counter-clockwise.
    pub fn corners(&self) -> [Vec2; 4] {
        let Vec2 { x, y } = self.half;
        [Vec2::new(-x, -y), Vec2::new(x, -y), Vec2::new(x, y), Vec2::new(-x, y)].map(|corner| self.world(corner))
    }

    /// An outline around all points within `radius`, counter-clockwise, whose edges run level, upright or diagonal
    /// and whose corners lie on a grid.
    ///
    /// Edges of such outlines meet in points that floating point numbers hold exactly, however many outlines
    /// overlap: a triangulation of them cannot go wrong by rounding.
    pub fn inflated(&self, radius: f32) -> Vec<Vec2> {
        let corners = self.corners();
        let side = |axis: Vec2, reach: f32| {
            let (low, high) = extent(&corners, axis);
            (((low - reach) / GRID_M).floor() * GRID_M, ((high + reach) / GRID_M).ceil() * GRID_M)
        };
        let (west, east) = side(Vec2::X, radius);
        let (south, north) = side(Vec2::Y, radius);
        let (sum_low, sum_high) = side(Vec2::ONE, radius * std::f32::consts::SQRT_2);
        let (difference_low, difference_high) = side(Vec2::new(1.0, -1.0), radius * std::f32::consts::SQRT_2);
        let outline = [
            (east, east - difference_high),
            (east, sum_high - east),
            (sum_high - north, north),
            (north + difference_low, north),
            (west, west - difference_low),
            (west, sum_low - west),
            (sum_low - south, south),
            (south + difference_high, south),
        ];
        let mut points: Vec<Vec2> = outline.map(|(x, y)| Vec2::new(x, y)).to_vec();
        points.dedup();
        points
    }

    /// Whether it overlaps another, by their separating axes.
    pub fn overlaps(&self, other: &Self) -> bool {
        let (mine, theirs) = (self.corners(), other.corners());
        [self.axis, self.axis.perp(), other.axis, other.axis.perp()].into_iter().all(|axis| {
            let (low, high) = extent(&mine, axis);
            let (other_low, other_high) = extent(&theirs, axis);
            low < other_high && other_low < high
        })
    }

    /// How far it reaches into another, along the axis where that is least, m; 0 if they are apart.
    pub fn penetration(&self, other: &Self) -> f32 {
        let (mine, theirs) = (self.corners(), other.corners());
        let shared = [self.axis, self.axis.perp(), other.axis, other.axis.perp()].into_iter().map(|axis| {
            let (low, high) = extent(&mine, axis);
            let (other_low, other_high) = extent(&theirs, axis);
            (high - other_low).min(other_high - low)
        });
        shared.fold(f32::MAX, f32::min).max(0.0)
    }

    /// The same rectangle, larger by `margin` on every side.
    pub fn grown(&self, margin: f32) -> Self {
        Self { half: self.half + margin, ..*self }
    }

    /// Whether the segment from `a` to `b` touches it.
    pub fn cut_by(&self, a: Vec2, b: Vec2) -> bool {
        let (a, b) = (self.local(a), self.local(b));
        let along = b - a;
        let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
        for axis in 0..2 {
            if along[axis].abs() < 1e-9 {
                if a[axis].abs() > self.half[axis] {
                    return false;
                }
                continue;
            }
            let one = (-self.half[axis] - a[axis]) / along[axis];
            let two = (self.half[axis] - a[axis]) / along[axis];
            enter = enter.max(one.min(two));
            leave = leave.min(one.max(two));
        }
        enter <= leave
    }
}

/// The point of the segment from `a` to `b` nearest to `point`.
pub(crate) fn nearest_on(a: Vec2, b: Vec2, point: Vec2) -> Vec2 {
    let along = b - a;
    let length = along.length_squared();
    if length == 0.0 { a } else { a + along * ((point - a).dot(along) / length).clamp(0.0, 1.0) }
}

fn extent(points: &[Vec2], axis: Vec2) -> (f32, f32) {
    points
        .iter()
        .map(|point| point.dot(axis))
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_wrap_into_one_turn() {
        for (angle, expected) in [(0.0, 0.0), (4.0, 4.0 - std::f32::consts::TAU), (-4.0, std::f32::consts::TAU - 4.0)] {
            assert!((wrap(angle) - expected).abs() < 1e-5, "{angle}");
        }
    }

    #[test]
    fn a_turned_rectangle_measures_in_its_own_frame() {
        let print = Footprint::new(Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.5), std::f32::consts::FRAC_PI_2);
        assert!(print.distance(Vec2::new(1.0, 1.9)) < 1e-6);
        assert!((print.distance(Vec2::new(2.0, 1.0)) - 0.5).abs() < 1e-6);
        assert!(print.cut_by(Vec2::new(-5.0, 1.0), Vec2::new(5.0, 1.0)));
        assert!(!print.cut_by(Vec2::new(-5.0, 2.5), Vec2::new(5.0, 2.5)));
    }

    #[test]
    fn the_outline_keeps_the_radius_everywhere() {
        for (half, yaw) in
            [((0.4, 0.3), 0.3), ((1.0, 0.01), 0.0), ((0.3, 0.3), std::f32::consts::FRAC_PI_4), ((2.0, 0.1), 2.0)]
        {
            let print = Footprint::new(Vec2::new(3.3, -1.7), half.into(), yaw);
            let outline = print.inflated(0.25);
            for at in 0..outline.len() {
                let (a, b) = (outline[at], outline[(at + 1) % outline.len()]);
                for step in 0..=10 {
                    let distance = print.distance(a.lerp(b, step as f32 / 10.0));
                    assert!(distance > 0.2499, "{half:?} {yaw}: {distance}");
                }
                assert!((b - a).perp_dot(outline[(at + 2) % outline.len()] - b) >= 0.0, "not convex: {outline:?}");
            }
        }
    }
}

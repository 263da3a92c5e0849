//! Paths with fewer points.

use core::ops::Sub;

use glam::{Vec2, Vec3};

/// A point of a path, in a plane or in space.
pub(super) trait Point: Copy + PartialEq + Sub<Output = Self> {
    fn dot(self, other: Self) -> f32;
    fn scaled(self, by: f32) -> Self;
}

impl Point for Vec2 {
    fn dot(self, other: Self) -> f32 {
        Self::dot(self, other)
    }

    fn scaled(self, by: f32) -> Self {
        self * by
    }
}

impl Point for Vec3 {
    fn dot(self, other: Self) -> f32 {
        Self::dot(self, other)
    }

    fn scaled(self, by: f32) -> Self {
        self * by
    }
}

/// The path from its first to its last point, without points from which it is no farther than `slack`
/// (Ramer, Douglas and Peucker).
pub(super) fn simplified<P: Point>(points: &[P], slack: f32) -> Vec<P> {
    let mut out = Vec::with_capacity(points.len());
    out.extend(points.first());
    between(points, slack * slack, &mut out);
    out
}

/// The same for a path whose last point joins the first; at least a triangle.
pub(super) fn simplified_ring<P: Point>(points: &[P], slack: f32) -> Vec<P> {
    if points.len() <= 3 {
        return points.to_vec();
    }
    let from_first = |index: &usize| points[*index] - points[0];
    let far = (1..points.len()).max_by(|a, b| {
        let (a, b) = (from_first(a), from_first(b));
        a.dot(a).total_cmp(&b.dot(b))
    });
    let far = far.unwrap_or(1);
    let mut out = simplified(&points[..=far], slack);
    let back: Vec<P> = points[far..].iter().chain(points.first()).copied().collect();
    between(&back, slack * slack, &mut out);
    out.pop();
    if out.len() < 3 { points.to_vec() } else { out }
}

/// Adds the points to keep after the first.
fn between<P: Point>(points: &[P], slack_squared: f32, out: &mut Vec<P>) {
    let [first, .., last] = points else { return };
    let inner = 1..points.len() - 1;
    let farthest = inner
        .map(|index| (index, from_segment_squared(points[index], *first, *last)))
        .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    match farthest {
        Some((index, squared)) if squared > slack_squared => {
            between(&points[..=index], slack_squared, out);
            between(&points[index..], slack_squared, out);
        }
        _ => out.push(*last),
    }
}

fn from_segment_squared<P: Point>(point: P, a: P, b: P) -> f32 {
    let (along, to) = (b - a, point - a);
    let length_squared = along.dot(along);
    let share = if length_squared > 0.0 { (to.dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let off = to - along.scaled(share);
    off.dot(off)
}

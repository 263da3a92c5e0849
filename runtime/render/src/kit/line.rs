//! Drawn lines: flat strokes of a pen on a board.

use glam::{Vec2, Vec3};

use super::path::{simplified, simplified_ring};
use super::text::RAISE_M;
use super::{Precision, Solid};

/// A corner is drawn out to a tip up to this many half widths long; sharper ones are cut off.
const MOST_MITRE: f32 = 2.0;

/// A line of `width` through the points `[y, z]`, facing `+x`.
pub(super) fn build(path: &[[f32; 2]], width: f32, closed: bool, precision: &Precision) -> Solid {
    let mut points: Vec<Vec2> = Vec::with_capacity(path.len());
    for point in path.iter().copied().map(Vec2::from_array) {
        if points.last().is_none_or(|last| last.distance_squared(point) > 1e-10) {
            points.push(point);
        }
    }
    if closed && points.len() > 1 && points[0].distance_squared(points[points.len() - 1]) < 1e-10 {
        points.pop();
    }
    let closed = closed && points.len() > 2;
    let slack = precision.tolerance_m * 0.4;
    let points = if closed { simplified_ring(&points, slack) } else { simplified(&points, slack) };
    ribbon(&points, width * 0.5, closed)
}

/// Two triangles a segment, joined at the corners.
fn ribbon(points: &[Vec2], half: f32, closed: bool) -> Solid {
    let mut solid = Solid::default();
    let count = points.len();
    if count < 2 {
        return solid;
    }
    let along = |index: usize| (points[(index + 1) % count] - points[index % count]).normalize_or(Vec2::X);
    let mut sides = Vec::with_capacity(count + 1);
    for (index, at) in points.iter().copied().enumerate() {
        let first = !closed && index == 0;
        let last = !closed && index + 1 == count;
        let before = if first { along(0) } else { along(index + count - 1) };
        let after = if last { before } else { along(index) };
        let left = (before + after).normalize_or(after).perp();
        let reach = half / left.dot(after.perp()).max(1.0 / MOST_MITRE);
        // As if by a round tip, an end goes on for half its width.
        let end = if first { -after * half } else { before * if last { half } else { 0.0 } };
        let corner = |side: f32| (at + end + left * (reach * side)).extend(RAISE_M);
        sides.push([-1.0, 1.0].map(|side| {
            let flat = corner(side);
            solid.corner(Vec3::new(flat.z, flat.x, flat.y), Vec3::X)
        }));
    }
    if closed {
        sides.push(sides[0]);
    }
    for pair in sides.windows(2) {
        let [[right, left], [next_right, next_left]] = [pair[0], pair[1]];
        solid.quad([right, next_right, next_left, left]);
    }
    solid
}

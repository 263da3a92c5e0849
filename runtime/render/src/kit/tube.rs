//! Round tubes along a path.

use core::f32::consts::TAU;

use glam::Vec3;

use super::path::{simplified, simplified_ring};
use super::{Detail, Precision, Solid};

/// A tube through the points, its corners a little rounded, its ends capped.
pub(super) fn build(path: &[[f32; 3]], radius: f32, closed: bool, precision: &Precision) -> Solid {
    let points = distinct(path, closed);
    let closed = closed && points.len() > 2;
    let slack = precision.tolerance_m * 0.9;
    let points = if closed { simplified_ring(&points, slack) } else { simplified(&points, slack) };
    let centers = fillet(&points, radius, closed, precision);
    sweep(&centers, radius, closed, sides(radius, precision))
}

fn sides(radius: f32, precision: &Precision) -> u32 {
    let (least, most) = match precision.detail {
        Detail::Fine => (4, 10),
        Detail::Medium => (4, 8),
        Detail::Coarse => (3, 5),
    };
    let wanted = core::f32::consts::PI * (radius / (2.0 * precision.tolerance_m)).sqrt();
    ((wanted + 0.25) as u32).clamp(least, most)
}

fn distinct(path: &[[f32; 3]], closed: bool) -> Vec<Vec3> {
    let mut points: Vec<Vec3> = Vec::with_capacity(path.len());
    for point in path.iter().copied().map(Vec3::from_array) {
        if points.last().is_none_or(|last| last.distance_squared(point) > 1e-10) {
            points.push(point);
        }
    }
    if closed && points.len() > 1 && points[0].distance_squared(points[points.len() - 1]) < 1e-10 {
        points.pop();
    }
    points
}

/// Replaces every sharp corner by a short curve.
fn fillet(points: &[Vec3], radius: f32, closed: bool, precision: &Precision) -> Vec<Vec3> {
    let count = points.len();
    let mut out = Vec::with_capacity(count * 4);
    for (index, at) in points.iter().copied().enumerate() {
        if !closed && (index == 0 || index + 1 == count) {
            out.push(at);
            continue;
        }
        let (before, after) = (points[(index + count - 1) % count], points[(index + 1) % count]);
        let (to_before, to_after) = (before - at, after - at);
        let (back, forth) = (to_before.normalize_or_zero(), to_after.normalize_or_zero());
        let reach = (2.0 * radius).min(0.35 * to_before.length()).min(0.35 * to_after.length());
        // By how much the curve cuts the corner.
        let cut = 0.25 * reach * (back + forth).length();
        // What turns this little is one of the many corners of a curve already.
        let straightness = -back.dot(forth);
        if straightness > 0.85 || cut < precision.tolerance_m {
            out.push(at);
            continue;
        }
        let (start, end) = (at + back * reach, at + forth * reach);
        let steps = ((cut / precision.tolerance_m).sqrt() as u32).clamp(1, 3);
        for step in 0..=steps {
            let t = step as f32 / steps as f32;
            out.push(start.lerp(at, t).lerp(at.lerp(end, t), t));
        }
    }
    out
}

fn sweep(centers: &[Vec3], radius: f32, closed: bool, sides: u32) -> Solid {
    let mut solid = Solid::default();
    let count = centers.len();
    if count < 2 {
        return solid;
    }
    let direction = |index: usize| -> Vec3 {
        let next = if index + 1 < count { centers[index + 1] } else { centers[(index + 1) % count] };
        (next - centers[index]).normalize_or(Vec3::Z)
    };
    let mut across = direction(0).any_orthonormal_vector();
    for (index, center) in centers.iter().copied().enumerate() {
        let incoming = if index > 0 {
            direction(index - 1)
        } else if closed {
            direction(count - 1)
        } else {
            direction(0)
        };
        let outgoing = if closed || index + 1 < count { direction(index) } else { incoming };
        let tangent = (incoming + outgoing).normalize_or(outgoing);
        across = (across - tangent * across.dot(tangent)).normalize_or(tangent.any_orthonormal_vector());
        let up = tangent.cross(across);
        for side in 0..sides {
            let (sin, cos) = libm::sincosf(TAU * side as f32 / sides as f32);
            let normal = across * cos + up * sin;
            solid.corner(center + normal * radius, normal);
        }
    }
    let rows = if closed { count } else { count - 1 };
    // The frame that was carried round a closed path may come back turned: join where the seam is least twisted.
    let twist = if closed { seam(&solid, count, sides) } else { 0 };
    for row in 0..rows {
        let (low, high) = (row as u32 * sides, ((row + 1) % count) as u32 * sides);
        let shift = if closed && row + 1 == count { twist } else { 0 };
        for side in 0..sides {
            let next = (side + 1) % sides;
            solid.quad([low + side, low + next, high + (next + shift) % sides, high + (side + shift) % sides]);
        }
    }
    if !closed {
        cap(&mut solid, 0, centers[0], -direction(0), sides, radius);
        cap(&mut solid, (count as u32 - 1) * sides, centers[count - 1], direction(count - 2), sides, radius);
    }
    solid
}

/// By how many corners the first ring is turned against the last.
fn seam(solid: &Solid, count: usize, sides: u32) -> u32 {
    let last = (count as u32 - 1) * sides;
    let distance = |shift: u32| solid.normals[last as usize].dot(solid.normals[shift as usize]);
    (0..sides).max_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0)
}

/// A low dome over an end.
fn cap(solid: &mut Solid, ring: u32, center: Vec3, outward: Vec3, sides: u32, radius: f32) {
    let tip = solid.corner(center + outward * (radius * 0.5), outward);
    for side in 0..sides {
        let next = (side + 1) % sides;
        let (a, b) = (ring + side, ring + next);
        let facing = (solid.positions[b as usize] - solid.positions[a as usize])
            .cross(solid.positions[tip as usize] - solid.positions[a as usize]);
        let middle = (solid.positions[a as usize] + solid.positions[b as usize]) * 0.5 - center;
        if facing.dot(outward + middle) >= 0.0 {
            solid.triangle([a, b, tip]);
        } else {
            solid.triangle([b, a, tip]);
        }
    }
}

//! Polygons pulled up along z.

use glam::{Vec2, Vec3};

use super::path::simplified_ring;
use super::{Precision, ShapeError, Solid};

/// Sides that meet at a smaller angle than this look like one curved side: cos 32°.
const SMOOTH_COS: f32 = 0.848;

/// The prism over `outline`, with chamfered top and bottom edges.
pub(super) fn build(
    outline: &[[f32; 2]],
    height: f32,
    bevel: Option<f32>,
    precision: &Precision,
) -> Result<Solid, ShapeError> {
    let mut points: Vec<Vec2> = Vec::with_capacity(outline.len());
    for point in outline.iter().copied().map(Vec2::from_array) {
        if points.last().is_none_or(|last| last.distance_squared(point) > 1e-12) {
            points.push(point);
        }
    }
    if points.len() > 1 && points[0].distance_squared(points[points.len() - 1]) < 1e-12 {
        points.pop();
    }
    if signed_area(&points) < 0.0 {
        points.reverse();
    }
    let mut ears = clip_ears(&points).ok_or(ShapeError::Crossed)?;
    let fewer = simplified_ring(&points, precision.tolerance_m * 0.5);
    if fewer.len() < points.len()
        && let Some(found) = clip_ears(&fewer).filter(|_| signed_area(&fewer) > 0.0)
    {
        (points, ears) = (fewer, found);
    }
    let narrowest = (0..points.len()).map(|i| points[i].distance(points[(i + 1) % points.len()])).fold(1.0, f32::min);
    let wanted = bevel.unwrap_or((height * 0.15).min(0.006));
    let cut = wanted.clamp(0.0, (height * 0.45).min(narrowest * 0.4));
    let chamfer = if precision.rounds(cut) { cut } else { 0.0 };
    let lid = if chamfer > 0.0 { inset(&points, chamfer) } else { points.clone() };
    let mut solid = Solid::default();
    lids(&mut solid, &lid, &ears, height);
    sides(&mut solid, &points, &lid, height, chamfer);
    Ok(solid)
}

fn signed_area(points: &[Vec2]) -> f32 {
    (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum::<f32>() * 0.5
}

fn lids(solid: &mut Solid, lid: &[Vec2], ears: &[[usize; 3]], height: f32) {
    let bottom: Vec<u32> = lid.iter().map(|p| solid.corner(p.extend(0.0), Vec3::NEG_Z)).collect();
    let top: Vec<u32> = lid.iter().map(|p| solid.corner(p.extend(height), Vec3::Z)).collect();
    for [a, b, c] in ears.iter().copied() {
        solid.triangle([top[a], top[b], top[c]]);
        solid.triangle([bottom[a], bottom[c], bottom[b]]);
    }
}

fn sides(solid: &mut Solid, points: &[Vec2], lid: &[Vec2], height: f32, chamfer: f32) {
    let count = points.len();
    let normal = |i: usize| {
        let along = points[(i + 1) % count] - points[i % count];
        Vec2::new(along.y, -along.x).normalize_or(Vec2::X)
    };
    for i in 0..count {
        let (own, before, after) = (normal(i), normal(i + count - 1), normal(i + 1));
        let smooth = |other: Vec2| if own.dot(other) > SMOOTH_COS { (own + other).normalize_or(own) } else { own };
        let ends = [(i, smooth(before)), ((i + 1) % count, smooth(after))];
        let mut ring = |lids: bool, z: f32, up: f32| {
            ends.map(|(at, side)| {
                let position = if lids { lid[at] } else { points[at] };
                solid.corner(position.extend(z), if lids { Vec3::Z * up } else { side.extend(0.0) })
            })
        };
        let low = ring(false, chamfer, 0.0);
        let high = ring(false, height - chamfer, 0.0);
        let edges = (chamfer > 0.0).then(|| (ring(true, 0.0, -1.0), ring(true, height, 1.0)));
        solid.quad([low[0], low[1], high[1], high[0]]);
        if let Some((base, top)) = edges {
            solid.quad([base[0], base[1], low[1], low[0]]);
            solid.quad([high[0], high[1], top[1], top[0]]);
        }
    }
}

/// The outline moved inwards by `by`.
fn inset(points: &[Vec2], by: f32) -> Vec<Vec2> {
    let count = points.len();
    (0..count)
        .map(|i| {
            let (before, at, after) = (points[(i + count - 1) % count], points[i], points[(i + 1) % count]);
            let (a, b) = ((at - before).normalize_or(Vec2::X).perp(), (after - at).normalize_or(Vec2::X).perp());
            let middle = (a + b).normalize_or(a);
            at + middle * (by / middle.dot(a).max(0.5))
        })
        .collect()
}

/// Cuts a simple counter-clockwise polygon into triangles, ear by ear.
fn clip_ears(points: &[Vec2]) -> Option<Vec<[usize; 3]>> {
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut ears = Vec::with_capacity(points.len().saturating_sub(2));
    if rest.len() < 3 || signed_area(points).abs() < 1e-10 {
        return None;
    }
    while rest.len() > 3 {
        let count = rest.len();
        let ear = (0..count).find(|i| {
            let corners = [rest[(i + count - 1) % count], rest[*i], rest[(i + 1) % count]];
            is_ear(points, corners, &rest)
        })?;
        ears.push([rest[(ear + count - 1) % count], rest[ear], rest[(ear + 1) % count]]);
        rest.remove(ear);
    }
    ears.push([rest[0], rest[1], rest[2]]);
    Some(ears)
}

fn is_ear(points: &[Vec2], corners: [usize; 3], rest: &[usize]) -> bool {
    let [a, b, c] = corners.map(|i| points[i]);
    let turn = (b - a).perp_dot(c - b);
    if turn < -1e-12 {
        return false;
    }
    rest.iter().filter(|i| !corners.contains(i)).all(|i| {
        let p = points[*i];
        let outside = (b - a).perp_dot(p - a) < 0.0 || (c - b).perp_dot(p - b) < 0.0 || (a - c).perp_dot(p - c) < 0.0;
        outside || p == a || p == b || p == c
    })
}

//! Surfaces of revolution about z: lathed profiles, cylinders, ellipsoids.

use core::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::path::simplified;
use super::{Precision, Solid};

/// Where two pieces of a profile meet at a larger angle than this, there is an edge: cos 40°.
const EDGE_COS: f32 = 0.766;

/// What is narrower than this comes to a point, in metres.
const POINT_M: f32 = 0.000_5;

fn to_point(radius: f32) -> f32 {
    if radius < POINT_M { 0.0 } else { radius }
}

/// A point of a profile: radius and height, and the normal there in the same plane.
#[derive(Clone, Copy)]
struct Ring {
    at: Vec2,
    normal: Vec2,
}

/// Turns a profile of `[radius, z]`; ends away from the axis are closed with flat discs.
pub(super) fn turn(profile: &[[f32; 2]], precision: &Precision) -> Solid {
    let mut points: Vec<Vec2> = Vec::with_capacity(profile.len() + 2);
    for point in profile {
        let point = Vec2::new(to_point(point[0]), point[1]);
        if points.last().is_none_or(|last| last.distance_squared(point) > 1e-12) {
            points.push(point);
        }
    }
    let mut points = simplified(&points, precision.tolerance_m * 0.4);
    let ring_shaped = points.len() > 2 && points[0].distance_squared(points[points.len() - 1]) < 1e-12;
    if !ring_shaped && !points.is_empty() {
        let (first, last) = (points[0], points[points.len() - 1]);
        if first.x > 0.0 {
            points.insert(0, Vec2::new(0.0, first.y));
        }
        if last.x > 0.0 {
            points.push(Vec2::new(0.0, last.y));
        }
    }
    revolve(&rings(&points, ring_shaped), precision)
}

/// A cylinder or cone frustum from z = 0, with rounded rims.
pub(super) fn cylinder(radii: [f32; 2], height: f32, bevel: Option<f32>, precision: &Precision) -> Solid {
    let [base, top] = [radii[0], to_point(radii[1])];
    let smallest = base.max(top).min(height);
    let wanted = bevel.unwrap_or((smallest * 0.12).min(0.006));
    let round = |radius: f32| {
        let cut = wanted.clamp(0.0, radius.min(height) * 0.5);
        if precision.rounds(cut) { cut } else { 0.0 }
    };
    let side = Vec2::new(height, base - top).normalize();
    let (low, high) = (round(base), round(top));
    let along = Vec2::new(top - base, height).normalize();
    let mut rings = vec![Ring { at: Vec2::ZERO, normal: Vec2::NEG_Y }];
    rings.push(Ring { at: Vec2::new(base - low, 0.0), normal: Vec2::NEG_Y });
    rings.push(Ring { at: Vec2::new(base, 0.0) + along * low, normal: side });
    rings.push(Ring { at: Vec2::new(top, height) - along * high, normal: side });
    if top > 0.0 {
        rings.push(Ring { at: Vec2::new(top - high, height), normal: Vec2::Y });
        rings.push(Ring { at: Vec2::new(0.0, height), normal: Vec2::Y });
    }
    revolve(&rings, precision)
}

/// An ellipsoid about the origin.
pub(super) fn ellipsoid(radii: Vec3, precision: &Precision) -> Solid {
    // Between the radii of the outline that is seen of it most often.
    let middling = radii.x + radii.y + radii.z - radii.max_element() - radii.min_element();
    let sides = precision.sides((radii.max_element() * middling).sqrt());
    let rows = ((sides * 2 + 2) / 5).max(3);
    let rings: Vec<Ring> = (0..=rows)
        .map(|row| {
            let (sin, cos) = libm::sincosf(PI * (row as f32 / rows as f32 - 0.5));
            let normal = if row == 0 || row == rows { Vec2::new(0.0, sin) } else { Vec2::new(cos, sin) };
            Ring { at: normal, normal }
        })
        .collect();
    let mut solid = revolve_sides(&rings, sides);
    for position in &mut solid.positions {
        *position *= radii;
    }
    for normal in &mut solid.normals {
        *normal = (*normal / radii).normalize_or(Vec3::Z);
    }
    solid
}

/// Gives every point its normals: one where the profile is smooth, two where it has an edge.
fn rings(points: &[Vec2], ring_shaped: bool) -> Vec<Ring> {
    let normal = |a: Vec2, b: Vec2| Vec2::new(b.y - a.y, a.x - b.x).normalize_or(Vec2::X);
    let count = points.len();
    let mut rings = Vec::with_capacity(count * 2);
    for (index, at) in points.iter().copied().enumerate() {
        let before = match index {
            0 if ring_shaped => Some(normal(points[count - 2], at)),
            0 => None,
            _ => Some(normal(points[index - 1], at)),
        };
        let after = match index + 1 {
            next if next < count => Some(normal(at, points[next])),
            _ if ring_shaped => Some(normal(at, points[1])),
            _ => None,
        };
        match (before, after) {
            (Some(a), Some(b)) if a.dot(b) > EDGE_COS => {
                rings.push(Ring { at, normal: (a + b).normalize_or(a) });
            }
            (Some(a), Some(b)) => rings.extend([Ring { at, normal: a }, Ring { at, normal: b }]),
            (Some(only), None) | (None, Some(only)) => rings.push(Ring { at, normal: only }),
            (None, None) => {}
        }
    }
    rings
}

fn revolve(rings: &[Ring], precision: &Precision) -> Solid {
    let widest = rings.iter().map(|ring| ring.at.x).fold(0.0, f32::max);
    revolve_sides(rings, precision.sides(widest))
}

fn revolve_sides(rings: &[Ring], sides: u32) -> Solid {
    let mut solid = Solid::default();
    for ring in rings {
        for side in 0..sides {
            let (sin, cos) = libm::sincosf(TAU * side as f32 / sides as f32);
            let position = Vec3::new(ring.at.x * cos, ring.at.x * sin, ring.at.y);
            solid.corner(position, Vec3::new(ring.normal.x * cos, ring.normal.x * sin, ring.normal.y));
        }
    }
    for row in 1..rings.len() as u32 {
        let (low, high) = ((row - 1) * sides, row * sides);
        if solid.positions[low as usize].distance_squared(solid.positions[high as usize]) < 1e-12 {
            continue;
        }
        for side in 0..sides {
            let next = (side + 1) % sides;
            solid.quad([low + side, low + next, high + next, high + side]);
        }
    }
    solid
}

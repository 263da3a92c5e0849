//! Boxes with rounded edges.

use glam::Vec3;

use super::{Detail, Precision, Solid};

/// A box of `size` with its base at zero. The rounded edges carry smooth normals, so that they catch the light.
pub(super) fn build(size: Vec3, bevel: Option<f32>, precision: &Precision) -> Solid {
    let smallest = size.min_element();
    let radius = bevel.unwrap_or((smallest * 0.15).min(0.012)).clamp(0.0, smallest * 0.5);
    let steps = steps(radius, precision);
    let mut solid = if steps == 0 { sharp(size) } else { rounded(size, radius, steps) };
    for position in &mut solid.positions {
        position.z += size.z * 0.5;
    }
    solid
}

/// How many flat strips make one rounded edge.
fn steps(radius: f32, precision: &Precision) -> u32 {
    if !precision.rounds(radius) {
        return 0;
    }
    let most = match precision.detail {
        Detail::Fine => 3,
        Detail::Medium => 2,
        Detail::Coarse => 1,
    };
    // A quarter of a circle of `steps` strips misses the true one by radius / 3.24 steps²; smooth normals hide half
    // of that.
    let wanted = (radius / (3.24 * precision.tolerance_m)).sqrt();
    ((wanted + 0.5) as u32).clamp(1, most)
}

fn sharp(size: Vec3) -> Solid {
    let mut solid = Solid::default();
    let half = size * 0.5;
    for axis in 0..3 {
        for sign in [-1.0_f32, 1.0] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let at = |a: f32, b: f32| {
                let mut point = Vec3::ZERO;
                point[axis] = sign * half[axis];
                point[u] = a * sign * half[u];
                point[v] = b * half[v];
                point
            };
            solid.face([at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]);
        }
    }
    solid
}

/// A sphere pulled apart along its three planes of symmetry: its eighths become the corners.
fn rounded(size: Vec3, radius: f32, steps: u32) -> Solid {
    let mut solid = Solid::default();
    let inner = size * 0.5 - Vec3::splat(radius);
    let quarter = core::f32::consts::FRAC_PI_2;
    let columns = 4 * (steps + 1);
    for half in [-1.0_f32, 1.0] {
        for row in 0..=steps {
            let ratio = row as f32 / steps as f32;
            let latitude = quarter * if half < 0.0 { ratio - 1.0 } else { ratio };
            for column in 0..columns {
                let (sector, step) = (column / (steps + 1), column % (steps + 1));
                let longitude = quarter * (sector as f32 + step as f32 / steps as f32);
                let (sin_lat, cos_lat) = libm::sincosf(latitude);
                let (sin_lon, cos_lon) = libm::sincosf(longitude);
                let normal = Vec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
                let sign = Vec3::new(
                    if sector == 0 || sector == 3 { 1.0 } else { -1.0 },
                    if sector < 2 { 1.0 } else { -1.0 },
                    half,
                );
                solid.corner(sign * inner + normal * radius, normal);
            }
        }
    }
    for row in 0..2 * steps + 1 {
        for column in 0..columns {
            let next = (column + 1) % columns;
            let (low, high) = (row * columns, (row + 1) * columns);
            solid.quad([low + column, low + next, high + next, high + column]);
        }
    }
    // The poles' rows have one point a corner; the caps join them.
    let corner = |sector: u32| sector * (steps + 1);
    let top = (2 * steps + 1) * columns;
    solid.quad([top + corner(0), top + corner(1), top + corner(2), top + corner(3)]);
    solid.quad([corner(3), corner(2), corner(1), corner(0)]);
    solid
}

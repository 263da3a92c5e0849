//! From triangles in space to triangles on the screen: projected, cut at the picture's surroundings, back sides dropped.

use glam::Vec3;

use super::draw::Draw;
use crate::camera::{NEAR_M, View};

/// Bits of a pixel's fraction.
pub(super) const SUB_BITS: u32 = 6;
/// Steps of a pixel's fraction.
pub(super) const SUB: i32 = 1 << SUB_BITS;
/// Triangles are cut when they reach farther than this from the picture's corner, in pixels.
const GUARD_PX: f32 = 6000.0;

/// A triangle on the screen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Corners in fractions of pixels, with the inside to the right of each side in a picture whose y runs down.
    pub at: [[i32; 2]; 3],
    /// One over depth, a plane: its value at the picture's origin and its growth a pixel.
    pub nearness: [f32; 3],
    /// Least and greatest value of the same at the corners.
    pub bounds: [f32; 2],
    /// Pixels whose centres may lie inside: left, top, right, bottom, all inclusive.
    pub rect: [i16; 4],
    /// Which draw it belongs to.
    pub draw: u32,
    /// Which triangle of the draw's mesh it is, or is cut from.
    pub index: u32,
}

/// A corner on its way to the screen.
#[derive(Clone, Copy)]
struct Corner {
    in_camera: Vec3,
    at: [i32; 2],
    nearness: f32,
    /// Whether it lies before the near plane and within the guard band, so that `at` holds.
    simple: bool,
}

/// Sets up all triangles of some draws, of which the first has the number `first`.
pub(super) fn all(out: &mut Vec<Triangle>, draws: &[Draw<'_>], first: u32, view: &View) {
    let mut corners = Vec::new();
    for (index, draw) in draws.iter().enumerate() {
        one(out, draw, first + index as u32, view, &mut corners);
    }
}

fn one(out: &mut Vec<Triangle>, draw: &Draw<'_>, number: u32, view: &View, corners: &mut Vec<Corner>) {
    let (turn, offset) = draw.to_camera;
    let base = draw.piece.corners.start;
    let positions = &draw.mesh.positions[base as usize..draw.piece.corners.end as usize];
    corners.clear();
    corners.extend(positions.iter().map(|position| project(turn * *position + offset, view)));
    let size = [view.size[0] as i32, view.size[1] as i32];
    for index in draw.piece.triangles.clone() {
        let [a, b, c] = draw.mesh.triangles[index as usize].map(|corner| corners[(corner - base) as usize]);
        if a.simple && b.simple && c.simple {
            push(out, [a, b, c], size, number, index);
        } else {
            clip(out, [a.in_camera, b.in_camera, c.in_camera], view, number, index);
        }
    }
}

#[inline]
fn project(in_camera: Vec3, view: &View) -> Corner {
    let ahead = in_camera.z >= NEAR_M;
    let nearness = 1.0 / in_camera.z;
    let scale = view.focal * nearness;
    let (x, y) = (in_camera.x * scale + view.center[0], in_camera.y * scale + view.center[1]);
    let simple = ahead && x.abs() < GUARD_PX && y.abs() < GUARD_PX;
    let fixed = |v: f32| (v * SUB as f32 + 524_288.5) as i32 - 524_288;
    Corner { in_camera, at: if simple { [fixed(x), fixed(y)] } else { [0, 0] }, nearness, simple }
}

#[inline]
fn push(out: &mut Vec<Triangle>, [a, b, c]: [Corner; 3], size: [i32; 2], draw: u32, index: u32) {
    let area = i64::from(b.at[0] - a.at[0]) * i64::from(c.at[1] - a.at[1])
        - i64::from(b.at[1] - a.at[1]) * i64::from(c.at[0] - a.at[0]);
    // Counter-clockwise from outside is clockwise where y runs down.
    if area >= 0 {
        return;
    }
    let (b, c) = (c, b);
    let bound = |axis: usize| {
        let low = a.at[axis].min(b.at[axis]).min(c.at[axis]);
        let high = a.at[axis].max(b.at[axis]).max(c.at[axis]);
        // The centres of pixels lie half a pixel in.
        ((low + SUB / 2 - 1) >> SUB_BITS, (high - SUB / 2) >> SUB_BITS)
    };
    let ((left, right), (top, bottom)) = (bound(0), bound(1));
    let (left, top) = (left.max(0), top.max(0));
    let (right, bottom) = (right.min(size[0] - 1), bottom.min(size[1] - 1));
    if left > right || top > bottom {
        return;
    }
    out.push(Triangle {
        at: [a.at, b.at, c.at],
        nearness: plane([a, b, c], -area),
        bounds: [a.nearness.min(b.nearness).min(c.nearness), a.nearness.max(b.nearness).max(c.nearness)],
        rect: [left as i16, top as i16, right as i16, bottom as i16],
        draw,
        index,
    });
}

/// The plane through three corners' nearness; in double precision, for slivers.
fn plane([a, b, c]: [Corner; 3], area: i64) -> [f32; 3] {
    let scale = f64::from(SUB) / area as f64;
    let (bx, by) = (f64::from(b.at[0] - a.at[0]), f64::from(b.at[1] - a.at[1]));
    let (cx, cy) = (f64::from(c.at[0] - a.at[0]), f64::from(c.at[1] - a.at[1]));
    let (b1, c1) = (f64::from(b.nearness - a.nearness), f64::from(c.nearness - a.nearness));
    let per_x = (b1 * cy - c1 * by) * scale;
    let per_y = (c1 * bx - b1 * cx) * scale;
    let pixel = |v: i32| f64::from(v) / f64::from(SUB) - 0.5;
    let at_origin = f64::from(a.nearness) - per_x * pixel(a.at[0]) - per_y * pixel(a.at[1]);
    [at_origin as f32, per_x as f32, per_y as f32]
}

/// Cuts a triangle at the near plane and at the guard band, and sets up what is left.
fn clip(out: &mut Vec<Triangle>, corners: [Vec3; 3], view: &View, draw: u32, index: u32) {
    let slope = (GUARD_PX * 0.45) / view.focal;
    let planes = [
        (Vec3::Z, NEAR_M * 1.001),
        (Vec3::new(-1.0, 0.0, slope), 0.0),
        (Vec3::new(1.0, 0.0, slope), 0.0),
        (Vec3::new(0.0, -1.0, slope), 0.0),
        (Vec3::new(0.0, 1.0, slope), 0.0),
    ];
    let mut polygon: Vec<Vec3> = corners.to_vec();
    let mut next = Vec::with_capacity(8);
    for (normal, least) in planes {
        next.clear();
        for (i, to) in polygon.iter().enumerate() {
            let from = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (before, after) = (from.dot(normal) - least, to.dot(normal) - least);
            if (before >= 0.0) != (after >= 0.0) {
                // Always from the inner end, so that both triangles at a side are cut at the same place.
                let (inner, outer, d, e) =
                    if before >= 0.0 { (from, *to, before, after) } else { (*to, from, after, before) };
                next.push(inner + (outer - inner) * (d / (d - e)));
            }
            if after >= 0.0 {
                next.push(*to);
            }
        }
        core::mem::swap(&mut polygon, &mut next);
        if polygon.len() < 3 {
            return;
        }
    }
    let size = [view.size[0] as i32, view.size[1] as i32];
    let projected: Vec<Corner> = polygon.iter().map(|corner| project(*corner, view)).collect();
    for i in 1..projected.len() - 1 {
        let fan = [projected[0], projected[i], projected[i + 1]];
        if fan.iter().all(|corner| corner.simple) {
            push(out, fan, size, draw, index);
        }
    }
}

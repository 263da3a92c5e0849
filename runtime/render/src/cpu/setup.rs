//! From triangles in space to triangles on the screen: projected, cut at the picture's surroundings, back sides dropped.

use glam::{Mat3, Vec3};

use super::draw::Draw;
use crate::camera::{NEAR_M, View};

/// Bits of a pixel's fraction.
pub(super) const SUB_BITS: u32 = 6;
/// Steps of a pixel's fraction.
pub const SUB: i32 = 1 << SUB_BITS;
/// Triangles are cut when they reach farther than this from the picture's corner, in pixels.
pub const GUARD_PX: f32 = 6000.0;

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
    /// Beyond which sides of the picture it lies, a bit each; with [`AWKWARD`], `at` does not hold.
    beyond: u32,
}

/// The corner lies before the near plane or beyond the guard band.
const AWKWARD: u32 = 1 << 8;
/// Corners that are worked out at a time.
const LANES: usize = 8;

/// Sets up all triangles of some draws, of which the first has the number `first`. `wide` may be true only where the
/// processor has AVX2; the bits are the same.
pub(super) fn all(wide: bool, out: &mut Vec<Triangle>, draws: &[Draw<'_>], first: u32, view: &View) {
    #[cfg(target_arch = "x86_64")]
    if wide {
        // SAFETY: the caller says that the processor has AVX2.
        unsafe { all_avx2(out, draws, first, view) };
        return;
    }
    let _ = wide;
    all_draws(out, draws, first, view);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn all_avx2(out: &mut Vec<Triangle>, draws: &[Draw<'_>], first: u32, view: &View) {
    all_draws(out, draws, first, view);
}

#[inline(always)]
fn all_draws(out: &mut Vec<Triangle>, draws: &[Draw<'_>], first: u32, view: &View) {
    let mut corners = Vec::new();
    for (index, draw) in draws.iter().enumerate() {
        one(out, draw, first + index as u32, view, &mut corners);
    }
}

#[inline(always)]
fn one(out: &mut Vec<Triangle>, draw: &Draw<'_>, number: u32, view: &View, corners: &mut Vec<Corner>) {
    let base = draw.piece.corners.start;
    let positions = &draw.mesh.positions[base as usize..draw.piece.corners.end as usize];
    corners.clear();
    corners.reserve(positions.len() + LANES);
    let (eights, rest) = positions.as_chunks::<LANES>();
    for eight in eights {
        project(draw.to_camera, eight, view, corners);
    }
    if !rest.is_empty() {
        let mut eight = [rest[0]; LANES];
        eight[..rest.len()].copy_from_slice(rest);
        project(draw.to_camera, &eight, view, corners);
    }
    let size = [view.size[0] as i32, view.size[1] as i32];
    let triangles = draw.piece.triangles.clone();
    let all = &draw.mesh.triangles[triangles.start as usize..triangles.end as usize];
    for (index, triangle) in triangles.zip(all) {
        let [a, b, c] = triangle.map(|corner| &corners[(corner - base) as usize]);
        // Wholly on the far side of one of the picture's sides, or of the near plane.
        if a.beyond & b.beyond & c.beyond & !AWKWARD != 0 {
            continue;
        }
        if (a.beyond | b.beyond | c.beyond) & AWKWARD == 0 {
            push(out, [a, b, c], size, number, index);
        } else {
            clip(out, [a.in_camera, b.in_camera, c.in_camera], view, number, index);
        }
    }
}

/// Brings eight corners to the screen.
#[inline(always)]
fn project((turn, offset): (Mat3, Vec3), positions: &[Vec3; LANES], view: &View, out: &mut Vec<Corner>) {
    let [c0, c1, c2] = [turn.x_axis, turn.y_axis, turn.z_axis];
    let (mut xs, mut ys, mut zs) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for (i, place) in positions.iter().enumerate() {
        (xs[i], ys[i], zs[i]) = (place.x, place.y, place.z);
    }
    let (mut cx, mut cy, mut cz, mut near) = ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
    let (mut left, mut top, mut beyond) = ([0; LANES], [0; LANES], [0_u32; LANES]);
    let (width, height) = (view.size[0] as f32, view.size[1] as f32);
    for i in 0..LANES {
        let (x, y, z) = (xs[i], ys[i], zs[i]);
        cx[i] = c0.x * x + c1.x * y + c2.x * z + offset.x;
        cy[i] = c0.y * x + c1.y * y + c2.y * z + offset.y;
        cz[i] = c0.z * x + c1.z * y + c2.z * z + offset.z;
        near[i] = 1.0 / cz[i];
        let scale = view.focal * near[i];
        let (px, py) = (cx[i] * scale + view.center[0], cy[i] * scale + view.center[1]);
        let ahead = cz[i] >= NEAR_M;
        let simple = ahead & (px.abs() < GUARD_PX) & (py.abs() < GUARD_PX);
        left[i] = fixed(if simple { px } else { 0.0 });
        top[i] = fixed(if simple { py } else { 0.0 });
        // With a pixel to spare.
        beyond[i] = if ahead {
            u32::from(px < -1.0)
                | u32::from(px > width + 1.0) << 1
                | u32::from(py < -1.0) << 2
                | u32::from(py > height + 1.0) << 3
        } else {
            1 << 4
        } | if simple { 0 } else { AWKWARD };
    }
    for i in 0..LANES {
        let in_camera = Vec3::new(cx[i], cy[i], cz[i]);
        out.push(Corner { in_camera, at: [left[i], top[i]], nearness: near[i], beyond: beyond[i] });
    }
}

/// A place within the guard band in fractions of pixels.
#[inline(always)]
fn fixed(place: f32) -> i32 {
    (place * SUB as f32 + 524_288.5) as i32 - 524_288
}

#[inline(always)]
fn push(out: &mut Vec<Triangle>, [a, b, c]: [&Corner; 3], size: [i32; 2], draw: u32, index: u32) {
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
#[inline(always)]
fn plane([a, b, c]: [&Corner; 3], area: i64) -> [f32; 3] {
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
#[inline(never)]
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
    let mut projected = Vec::with_capacity(LANES);
    let mut eight = [polygon[0]; LANES];
    let count = polygon.len().min(LANES);
    eight[..count].copy_from_slice(&polygon[..count]);
    project((Mat3::IDENTITY, Vec3::ZERO), &eight, view, &mut projected);
    for i in 1..count - 1 {
        let fan = [&projected[0], &projected[i], &projected[i + 1]];
        if fan.iter().all(|corner| corner.beyond & AWKWARD == 0) {
            push(out, fan, size, draw, index);
        }
    }
}

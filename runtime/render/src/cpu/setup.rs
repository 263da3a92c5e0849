//! From triangles in space to triangles on the screen: projected, cut at the picture's surroundings, back sides dropped.

use core::ops::Range;

use glam::{Mat3, Vec3};

use super::draw::Draw;
use super::vectors::{Avx2, Vectors, widest};
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

/// A corner on the screen.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(16))]
pub(super) struct Corner {
    pub at: [i32; 2],
    pub nearness: f32,
    /// Beyond which sides of the picture it lies, a bit each; with [`AWKWARD`], `at` does not hold.
    pub beyond: u32,
}

/// The corner lies before the near plane or beyond the guard band.
pub(super) const AWKWARD: u32 = 1 << 8;
/// Corners that are worked out at a time.
pub(super) const LANES: usize = 8;

/// What takes triangles. A trait, so that what takes them is compiled for the same vectors as what hands them on.
pub(super) trait Sink {
    fn take(&mut self, triangle: &Triangle);
}

impl Sink for Vec<Triangle> {
    #[inline(always)]
    fn take(&mut self, triangle: &Triangle) {
        self.push(*triangle);
    }
}

/// What is drawn of a picture: all of it, or some of its rows.
#[derive(Clone, Copy)]
pub(super) struct Frame<'a> {
    view: &'a View,
    /// Where what is drawn begins and ends, with a pixel to spare.
    top: f32,
    bottom: f32,
}

impl<'a> Frame<'a> {
    /// So many rows, from a first one on.
    pub(super) fn rows(view: &'a View, first: usize, count: usize) -> Self {
        Self { view, top: first as f32 - 1.0, bottom: (first + count) as f32 + 1.0 }
    }
}

/// Sets up all triangles of some draws. The bits are the same with and without AVX2.
pub(super) fn all(wide: Option<Avx2>, out: &mut Vec<Triangle>, draws: &[Draw<'_>], view: &View) {
    widest!(wide, all_draws(out: &mut Vec<Triangle>, draws: &[Draw<'_>], view: &View));
}

#[inline(always)]
fn all_draws(_: impl Vectors, out: &mut Vec<Triangle>, draws: &[Draw<'_>], view: &View) {
    let frame = Frame::rows(view, 0, view.size[1] as usize);
    let mut corners = Vec::new();
    for (index, draw) in draws.iter().enumerate() {
        one(draw, &draw.piece.corners, &draw.piece.triangles, index as u32, frame, &mut corners, out);
    }
}

/// Sets up the triangles of one draw that may be seen, and hands each on.
#[inline(always)]
pub(super) fn one(
    draw: &Draw<'_>,
    own: &Range<u32>,
    triangles: &Range<u32>,
    number: u32,
    frame: Frame<'_>,
    corners: &mut Vec<Corner>,
    sink: &mut impl Sink,
) {
    let base = own.start;
    let positions = &draw.mesh.positions[base as usize..own.end as usize];
    let padded = positions.len().next_multiple_of(LANES);
    if corners.len() < padded {
        corners.resize(padded, Corner::default());
    }
    let (eights, rest) = positions.as_chunks::<LANES>();
    let (out, _) = corners[..padded].as_chunks_mut::<LANES>();
    for (eight, out) in eights.iter().zip(&mut *out) {
        *out = project(draw.to_camera, eight, frame);
    }
    if let (false, Some(out)) = (rest.is_empty(), out.last_mut()) {
        let mut eight = [rest[0]; LANES];
        eight[..rest.len()].copy_from_slice(rest);
        *out = project(draw.to_camera, &eight, frame);
    }
    let size = [frame.view.size[0] as i32, frame.view.size[1] as i32];
    let all = &draw.mesh.triangles[triangles.start as usize..triangles.end as usize];
    for (index, triangle) in triangles.clone().zip(all) {
        let [a, b, c] = triangle.map(|corner| corners[(corner - base) as usize]);
        // Wholly on the far side of one of the picture's sides, or of the near plane.
        if a.beyond & b.beyond & c.beyond & !AWKWARD != 0 {
            continue;
        }
        let (whole, cut);
        let polygon = if (a.beyond | b.beyond | c.beyond) & AWKWARD == 0 {
            whole = [a, b, c];
            &whole[..]
        } else {
            let (turn, offset) = draw.to_camera;
            cut = clip(triangle.map(|corner| turn * draw.mesh.positions[corner as usize] + offset), frame.view);
            &cut.0[..cut.1]
        };
        for i in 2..polygon.len() {
            if let Some(triangle) = triangle_of([polygon[0], polygon[i - 1], polygon[i]], size, number, index) {
                sink.take(&triangle);
            }
        }
    }
}

/// Brings eight corners to the screen.
#[inline(always)]
pub(super) fn project(
    (turn, offset): (Mat3, Vec3),
    positions: &[Vec3; LANES],
    Frame { view, top, bottom }: Frame<'_>,
) -> [Corner; LANES] {
    let [c0, c1, c2] = [turn.x_axis, turn.y_axis, turn.z_axis];
    let (mut xs, mut ys, mut zs) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for (i, place) in positions.iter().enumerate() {
        (xs[i], ys[i], zs[i]) = (place.x, place.y, place.z);
    }
    let mut near = [0.0; LANES];
    let (mut px, mut py, mut beyond) = ([0.0; LANES], [0.0; LANES], [0_u32; LANES]);
    let [center_x, center_y] = view.center;
    // How far the picture's sides lie from its middle, with a pixel to spare. Planes through the eye, they also tell of
    // what is behind it.
    let (west, east) = (-1.0 - center_x, view.size[0] as f32 + 1.0 - center_x);
    let (north, south) = (top - center_y, bottom - center_y);
    for i in 0..LANES {
        let (x, y, z) = (xs[i], ys[i], zs[i]);
        let cx = (c0.x * x + c1.x * y + c2.x * z + offset.x) * view.focal;
        let cy = (c0.y * x + c1.y * y + c2.y * z + offset.y) * view.focal;
        let cz = c0.z * x + c1.z * y + c2.z * z + offset.z;
        near[i] = 1.0 / cz;
        let (x, y) = (cx * near[i] + center_x, cy * near[i] + center_y);
        let ahead = cz >= NEAR_M;
        let simple = ahead & (x.abs() < GUARD_PX) & (y.abs() < GUARD_PX);
        beyond[i] = u32::from(cx < west * cz)
            | u32::from(cx > east * cz) << 1
            | u32::from(cy < north * cz) << 2
            | u32::from(cy > south * cz) << 3
            | if ahead { 0 } else { 1 << 4 }
            | if simple { 0 } else { AWKWARD };
        (px[i], py[i]) = (if simple { x } else { 0.0 }, if simple { y } else { 0.0 });
    }
    let (mut left, mut down) = ([0; LANES], [0; LANES]);
    for i in 0..LANES {
        (left[i], down[i]) = (fixed(px[i]), fixed(py[i]));
    }
    core::array::from_fn(|i| Corner { at: [left[i], down[i]], nearness: near[i], beyond: beyond[i] })
}

/// A place within the guard band in fractions of pixels.
#[inline(always)]
fn fixed(place: f32) -> i32 {
    // Beside this large number the last bits of a float are its whole part: much cheaper than a conversion.
    const LARGE: f32 = 12_582_912.0;
    (place * SUB as f32 + LARGE).to_bits().wrapping_sub(LARGE.to_bits()) as i32
}

#[inline(always)]
fn triangle_of([a, b, c]: [Corner; 3], size: [i32; 2], draw: u32, index: u32) -> Option<Triangle> {
    let area = i64::from(b.at[0] - a.at[0]) * i64::from(c.at[1] - a.at[1])
        - i64::from(b.at[1] - a.at[1]) * i64::from(c.at[0] - a.at[0]);
    // Counter-clockwise from outside is clockwise where y runs down.
    if area >= 0 {
        return None;
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
        return None;
    }
    Some(Triangle {
        at: [a.at, b.at, c.at],
        nearness: plane([&a, &b, &c], -area),
        bounds: [a.nearness.min(b.nearness).min(c.nearness), a.nearness.max(b.nearness).max(c.nearness)],
        rect: [left as i16, top as i16, right as i16, bottom as i16],
        draw,
        index,
    })
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

/// Cuts a triangle at the near plane and at the guard band: the corners of what is left, and how many they are.
#[inline(never)]
fn clip(corners: [Vec3; 3], view: &View) -> ([Corner; LANES], usize) {
    let slope = (GUARD_PX * 0.45) / view.focal;
    let planes = [
        (Vec3::Z, NEAR_M * 1.001),
        (Vec3::new(-1.0, 0.0, slope), 0.0),
        (Vec3::new(1.0, 0.0, slope), 0.0),
        (Vec3::new(0.0, -1.0, slope), 0.0),
        (Vec3::new(0.0, 1.0, slope), 0.0),
    ];
    // Every plane adds one corner at most.
    let (mut polygon, mut count) = ([Vec3::ZERO; LANES], 3);
    polygon[..3].copy_from_slice(&corners);
    for (normal, least) in planes {
        let (mut next, mut kept) = ([Vec3::ZERO; LANES], 0);
        let mut keep = |corner: Vec3| {
            if let Some(place) = next.get_mut(kept) {
                *place = corner;
                kept += 1;
            }
        };
        for i in 0..count {
            let (from, to) = (polygon[(i + count - 1) % count], polygon[i]);
            let (before, after) = (from.dot(normal) - least, to.dot(normal) - least);
            if (before >= 0.0) != (after >= 0.0) {
                // Always from the inner end, so that both triangles at a side are cut at the same place.
                let (inner, outer, d, e) =
                    if before >= 0.0 { (from, to, before, after) } else { (to, from, after, before) };
                keep(inner + (outer - inner) * (d / (d - e)));
            }
            if after >= 0.0 {
                keep(to);
            }
        }
        (polygon, count) = (next, kept);
        if count < 3 {
            return ([Corner::default(); LANES], 0);
        }
    }
    let frame = Frame::rows(view, 0, view.size[1] as usize);
    let projected = project((Mat3::IDENTITY, Vec3::ZERO), &polygon, frame);
    let whole = projected[..count].iter().all(|corner| corner.beyond & AWKWARD == 0);
    (projected, if whole { count } else { 0 })
}

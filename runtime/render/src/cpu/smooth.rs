//! Smooth edges for people. Where neighbours see different triangles and differ in brightness, the edge between them is
//! followed both ways to its ends; where a pixel lies along it says how much of the other side covers the pixel (after
//! Lottes, "FXAA", 2009). Patterns within a triangle stay as sharp as they are.

use super::band_rows;
use super::crew::Crew;
use super::vectors::{Avx2, Vectors, widest};

/// Less contrast than this is no edge, in steps of brightness.
const LEAST_CONTRAST: u8 = 10;
/// Pixels an edge is followed each way.
const REACH: usize = 12;
/// How far the brightness is known beyond the picture: there it is as at the nearest place inside.
const MARGIN: usize = REACH + 1;

/// A picture's brightness, a byte a pixel, with a margin all around.
#[derive(Debug, Default)]
struct Brightness {
    values: Vec<u8>,
    stride: usize,
}

impl Brightness {
    /// Takes over that of a picture.
    fn set(&mut self, pixels: &[[u8; 4]], width: usize) {
        let height = pixels.len() / width;
        self.stride = width + 2 * MARGIN;
        self.values.resize(self.stride * (height + 2 * MARGIN), 0);
        let luma = |[r, g, b, _]: [u8; 4]| ((u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29) >> 8) as u8;
        let rows = self.values.chunks_exact_mut(self.stride).enumerate();
        for (row, values) in rows {
            let y = row.saturating_sub(MARGIN).min(height - 1);
            let pixels = &pixels[y * width..(y + 1) * width];
            let (before, rest) = values.split_at_mut(MARGIN);
            let (own, after) = rest.split_at_mut(width);
            for (value, pixel) in own.iter_mut().zip(pixels) {
                *value = luma(*pixel);
            }
            before.fill(own[0]);
            after.fill(own[width - 1]);
        }
    }

    /// Where a pixel's value stands.
    #[inline]
    fn place(&self, x: usize, y: usize) -> usize {
        (y + MARGIN) * self.stride + x + MARGIN
    }

    /// So many values from a place on.
    #[inline(always)]
    fn row(&self, place: usize, length: usize) -> &[u8] {
        &self.values[place..place + length]
    }

    #[inline]
    fn at(&self, place: usize) -> i32 {
        i32::from(self.values[place])
    }
}

/// Buffers kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    original: Vec<[u8; 4]>,
    brightness: Brightness,
}

/// Blends pixels at edges with the neighbour across. The bits are the same with and without AVX2.
pub(crate) fn run(
    wide: Option<Avx2>,
    (crew, threads): (&Crew, usize),
    color: &mut [u8],
    buffers: &mut Buffers,
    seen: &[u32],
    width: usize,
) {
    let pixels = color.as_chunks_mut::<4>().0;
    buffers.original.clear();
    buffers.original.extend_from_slice(pixels);
    buffers.brightness.set(pixels, width);
    let Buffers { original, brightness } = &*buffers;
    let height = seen.len() / width;
    let band_rows = band_rows(threads, height);
    let bands: Vec<_> = pixels.chunks_mut(band_rows * width).enumerate().collect();
    crew.share_out(threads, bands, |(band, out)| {
        let mut edges = vec![0; width.next_multiple_of(8)];
        for (row, out) in out.chunks_mut(width).enumerate() {
            let y = band * band_rows + row;
            find_edges(wide, brightness, seen, y, &mut edges[..width]);
            // Most pixels lie at no edge: passed over in eights.
            for (eight, marks) in edges.as_chunks::<8>().0.iter().enumerate().filter(|(_, marks)| **marks != [0; 8]) {
                for x in (0..8).filter(|i| marks[*i] != 0).map(|i| eight * 8 + i) {
                    if let Some((across, share)) = edge(brightness, (x, y), (width, height)) {
                        let own = y * width + x;
                        let other = own.wrapping_add_signed(across.y * width as isize + across.x);
                        out[x] = mix(original[own], original[other], share);
                    }
                }
            }
        }
    });
}

/// Marks the pixels of a row that see another triangle than a neighbour, and differ from one in brightness.
fn find_edges(wide: Option<Avx2>, brightness: &Brightness, seen: &[u32], y: usize, edges: &mut [u8]) {
    widest!(wide, find_edges_in(brightness: &Brightness, seen: &[u32], y: usize, edges: &mut [u8]));
}

#[inline(always)]
fn find_edges_in(_: impl Vectors, brightness: &Brightness, seen: &[u32], y: usize, edges: &mut [u8]) {
    let width = edges.len();
    let height = seen.len() / width;
    let row = |y: usize| &seen[y * width..][..width];
    let (own, above, below) = (row(y), row(y.saturating_sub(1)), row((y + 1).min(height - 1)));
    for x in 0..width {
        edges[x] = u8::from((own[x] ^ above[x]) | (own[x] ^ below[x]) != 0);
    }
    let (west, east) = (&own[..width - 1], &own[1..]);
    for (edge, (west, east)) in edges[1..].iter_mut().zip(west.iter().zip(east)) {
        *edge |= u8::from(west != east);
    }
    for (edge, (west, east)) in edges.iter_mut().zip(west.iter().zip(east)) {
        *edge |= u8::from(west != east);
    }
    let place = brightness.place(0, y);
    let [own, north, south, west, east] =
        [place, place - brightness.stride, place + brightness.stride, place - 1, place + 1]
            .map(|place| brightness.row(place, width));
    for x in 0..width {
        let most = own[x].max(north[x]).max(south[x]).max(west[x]).max(east[x]);
        let least = own[x].min(north[x]).min(south[x]).min(west[x]).min(east[x]);
        edges[x] &= u8::from(most - least >= LEAST_CONTRAST.max(most / 10));
    }
}

fn mix(a: [u8; 4], b: [u8; 4], share: f32) -> [u8; 4] {
    core::array::from_fn(|c| (f32::from(a[c]) + (f32::from(b[c]) - f32::from(a[c])) * share + 0.5) as u8)
}

/// A step from a pixel to one beside it.
#[derive(Clone, Copy)]
struct Step {
    x: isize,
    y: isize,
}

/// The neighbour across the edge at a pixel, and how much of the pixel it covers.
fn edge(brightness: &Brightness, (x, y): (usize, usize), size: (usize, usize)) -> Option<(Step, f32)> {
    let (place, stride) = (brightness.place(x, y), brightness.stride);
    let (up, down) = (place - stride, place + stride);
    let at = |place: usize| brightness.at(place);
    let (own, north, south, west, east) = (at(place), at(up), at(down), at(place - 1), at(place + 1));
    let (nw, ne, sw, se) = (at(up - 1), at(up + 1), at(down - 1), at(down + 1));
    let curve = |a: i32, b: i32, c: i32| (a + c - 2 * b).abs();
    let level = curve(north, own, south) * 2 + curve(nw, west, sw) + curve(ne, east, se);
    let upright = curve(west, own, east) * 2 + curve(nw, north, ne) + curve(sw, south, se);
    let lies_flat = level >= upright;
    let (before, after) = if lies_flat { (north, south) } else { (west, east) };
    let side = if (before - own).abs() >= (after - own).abs() { -1 } else { 1 };
    let across = if lies_flat { Step { x: 0, y: side } } else { Step { x: side, y: 0 } };
    if x.checked_add_signed(across.x)? >= size.0 || y.checked_add_signed(across.y)? >= size.1 {
        return None;
    }
    let (along, over) = if lies_flat { (1, side * stride as isize) } else { (stride, side) };
    let other = if side < 0 { before } else { after };
    let share = follow(brightness, place, along, over, own + other, (other - own).abs().max(4));
    // A pixel that stands alone against all around it gives some of itself away too.
    let most = own.max(north).max(south).max(west).max(east);
    let least = own.min(north).min(south).min(west).min(east);
    let around = (2 * (north + south + west + east) + nw + ne + sw + se) / 12;
    let alone = ((around - own).abs() as f32 / (most - least) as f32).min(1.0);
    let share = share.max(alone * alone * 0.45);
    (share > 0.0).then_some((across, share))
}

/// Follows an edge both ways from a place, `along` it, with the other side `over` there; `pair` is the sum of the two
/// sides' brightness at the place. Gives how much of the pixel the other side covers.
fn follow(brightness: &Brightness, place: usize, along: usize, over: isize, pair: i32, jump: i32) -> f32 {
    let beside = place.wrapping_add_signed(over);
    let end = |back: bool| {
        let mut step = 0;
        for length in 1..=REACH {
            step += along;
            let (own, other) = if back { (place - step, beside - step) } else { (place + step, beside + step) };
            let here = brightness.at(own) + brightness.at(other) - pair;
            if here.abs() * 2 >= jump {
                return (length, here);
            }
        }
        (REACH, 0)
    };
    let ((back, at_back), (ahead, at_ahead)) = (end(true), end(false));
    let (near, at_near) = if back < ahead { (back, at_back) } else { (ahead, at_ahead) };
    // The edge bends towards this pixel only if, at its nearer end, the pair changes away from this pixel's side.
    let own_is_darker = 2 * brightness.at(place) < pair;
    if at_near == 0 || (at_near < 0) == own_is_darker {
        return 0.0;
    }
    let length = (back + ahead - 1).max(1) as f32;
    (0.5 - (near as f32 - 0.5) / length).clamp(0.0, 0.5)
}

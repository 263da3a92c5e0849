//! Smooth edges for people. Where neighbours see different triangles and differ in brightness, the edge between them is
//! followed both ways to its ends; where a pixel lies along it says how much of the other side covers the pixel (after
//! Lottes, "FXAA", 2009). Patterns within a triangle stay as sharp as they are.

use super::{band_rows, share_out};

/// Less contrast than this is no edge, in steps of brightness.
const LEAST_CONTRAST: i32 = 10;
/// Pixels an edge is followed each way.
const REACH: isize = 12;

/// A picture's brightness, a byte a pixel.
struct Brightness<'a> {
    values: &'a [u8],
    width: isize,
    height: isize,
}

impl Brightness<'_> {
    /// At a place, or at the nearest place inside the picture.
    #[inline]
    fn at(&self, x: isize, y: isize) -> i32 {
        let (x, y) = (x.clamp(0, self.width - 1), y.clamp(0, self.height - 1));
        i32::from(self.values[(y * self.width + x) as usize])
    }
}

/// Buffers kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    original: Vec<[u8; 4]>,
    brightness: Vec<u8>,
}

/// Blends pixels at edges with the neighbour across.
pub(crate) fn run(threads: usize, color: &mut [u8], buffers: &mut Buffers, seen: &[u32], width: usize) {
    let pixels = color.as_chunks_mut::<4>().0;
    buffers.original.clear();
    buffers.original.extend_from_slice(pixels);
    buffers.brightness.clear();
    let luma = |[r, g, b, _]: &[u8; 4]| ((u32::from(*r) * 77 + u32::from(*g) * 150 + u32::from(*b) * 29) >> 8) as u8;
    buffers.brightness.extend(pixels.iter().map(luma));
    let (original, height) = (&buffers.original, seen.len() / width);
    let brightness = Brightness { values: &buffers.brightness, width: width as isize, height: height as isize };
    let band_rows = band_rows(threads, height);
    let bands: Vec<_> = pixels.chunks_mut(band_rows * width).enumerate().collect();
    share_out(threads, bands, |(band, out)| {
        for (row, out) in out.chunks_mut(width).enumerate() {
            let y = band * band_rows + row;
            let own = &seen[y * width..(y + 1) * width];
            let above = &seen[y.saturating_sub(1) * width..][..width];
            let below = &seen[(y + 1).min(height - 1) * width..][..width];
            for x in 0..width {
                let beside = (own[x.saturating_sub(1)], own[(x + 1).min(width - 1)]);
                let same = beside.0 == own[x] && beside.1 == own[x] && above[x] == own[x] && below[x] == own[x];
                if same {
                    continue;
                }
                if let Some((dx, dy, share)) = edge(&brightness, x as isize, y as isize) {
                    let other = ((y as isize + dy) as usize) * width + (x as isize + dx) as usize;
                    out[x] = mix(original[y * width + x], original[other], share);
                }
            }
        }
    });
}

fn mix(a: [u8; 4], b: [u8; 4], share: f32) -> [u8; 4] {
    core::array::from_fn(|c| (f32::from(a[c]) + (f32::from(b[c]) - f32::from(a[c])) * share + 0.5) as u8)
}

/// The neighbour across the edge at a pixel, and how much of the pixel it covers.
fn edge(brightness: &Brightness<'_>, x: isize, y: isize) -> Option<(isize, isize, f32)> {
    let at = |dx: isize, dy: isize| brightness.at(x + dx, y + dy);
    let (own, north, south, west, east) = (at(0, 0), at(0, -1), at(0, 1), at(-1, 0), at(1, 0));
    let most = own.max(north).max(south).max(west).max(east);
    let least = own.min(north).min(south).min(west).min(east);
    let contrast = most - least;
    if contrast < LEAST_CONTRAST.max(most / 10) {
        return None;
    }
    let (nw, ne, sw, se) = (at(-1, -1), at(1, -1), at(-1, 1), at(1, 1));
    let curve = |a: i32, b: i32, c: i32| (a + c - 2 * b).abs();
    let level = curve(north, own, south) * 2 + curve(nw, west, sw) + curve(ne, east, se);
    let upright = curve(west, own, east) * 2 + curve(nw, north, ne) + curve(sw, south, se);
    let lies_flat = level >= upright;
    let (before, after) = if lies_flat { (north, south) } else { (west, east) };
    let side = if (before - own).abs() >= (after - own).abs() { -1 } else { 1 };
    let across = if lies_flat { (0, side) } else { (side, 0) };
    let (beyond_x, beyond_y) = (x + across.0, y + across.1);
    if beyond_x < 0 || beyond_y < 0 || beyond_x >= brightness.width || beyond_y >= brightness.height {
        return None;
    }
    let other = if side < 0 { before } else { after };
    let share = along(brightness, (x, y), across, own + other, (other - own).abs().max(4));
    // A pixel that stands alone against all around it gives some of itself away too.
    let around = (2 * (north + south + west + east) + nw + ne + sw + se) / 12;
    let alone = ((around - own).abs() as f32 / contrast as f32).min(1.0);
    let share = share.max(alone * alone * 0.45);
    (share > 0.0).then_some((across.0, across.1, share))
}

/// Follows the edge both ways; `pair` is the sum of the two sides' brightness here.
fn along(brightness: &Brightness<'_>, (x, y): (isize, isize), across: (isize, isize), pair: i32, jump: i32) -> f32 {
    let (step_x, step_y) = (across.1.abs(), across.0.abs());
    let end = |direction: isize| {
        for step in 1..=REACH {
            let (px, py) = (x + step_x * step * direction, y + step_y * step * direction);
            let here = brightness.at(px, py) + brightness.at(px + across.0, py + across.1) - pair;
            if here.abs() * 2 >= jump {
                return (step, here);
            }
        }
        (REACH, 0)
    };
    let ((back, at_back), (ahead, at_ahead)) = (end(-1), end(1));
    let (near, at_near) = if back < ahead { (back, at_back) } else { (ahead, at_ahead) };
    // The edge bends towards this pixel only if, at its nearer end, the pair changes away from this pixel's side.
    let own_is_darker = 2 * brightness.at(x, y) < pair;
    if at_near == 0 || (at_near < 0) == own_is_darker {
        return 0.0;
    }
    let length = (back + ahead - 1).max(1) as f32;
    (0.5 - (near as f32 - 0.5) / length).clamp(0.0, 0.5)
}

//! What each pixel sees: all draws, the nearest first, but for those that are hidden behind what has been drawn already.

use super::draw::Draw;
use super::numbers::Numbers;
use super::raster::Rows;
use super::setup::{self, AWKWARD, Corner, Frame, SUB, SUB_BITS, Sink, Triangle};
use super::vectors::{Avx2, Vectors, widest};
use crate::camera::View;
use crate::mesh::Aabb;

/// Pieces of fewer corners are drawn without asking whether they are hidden: asking costs about as much.
const FEW_CORNERS: usize = 24;
/// What a corner may lie nearer than its piece's box for rounding, m; much more than it does.
const SLACK_M: f32 = 1e-4;
/// The same across, in fractions of pixels.
const SLACK_SUB: i32 = SUB / 2;
/// Pixels compared before asking whether any of them lies open.
const STRETCH: usize = 32;

/// Draws everything into some rows. The bits are the same with and without AVX2.
pub(super) fn draw(
    wide: Option<Avx2>,
    draws: &[Draw<'_>],
    numbers: &Numbers,
    view: &View,
    rows: &mut Rows<'_>,
    corners: &mut Vec<Corner>,
) {
    widest!(
        wide,
        draw_all(
            draws: &[Draw<'_>],
            numbers: &Numbers,
            view: &View,
            rows: &mut Rows<'_>,
            corners: &mut Vec<Corner>,
        )
    );
}

#[inline(always)]
fn draw_all(
    vectors: impl Vectors,
    draws: &[Draw<'_>],
    numbers: &Numbers,
    view: &View,
    rows: &mut Rows<'_>,
    corners: &mut Vec<Corner>,
) {
    let frame = Frame::rows(view, rows.first, rows.count);
    for (index, draw) in draws.iter().enumerate() {
        let piece = draw.piece;
        if piece.corners.len() >= FEW_CORNERS && is_hidden(draw, piece.bounds, frame, rows) {
            continue;
        }
        // A triangle's number less its place in its mesh.
        let first = numbers.first(index).wrapping_sub(piece.triangles.start);
        // One way for pieces in one part and in many: what draws them is compiled into here only once.
        let mut clusters = piece.clusters.iter();
        let mut whole = piece.clusters.is_empty();
        loop {
            let (own, triangles) = if core::mem::take(&mut whole) {
                (&piece.corners, &piece.triangles)
            } else {
                let Some(cluster) = clusters.find(|cluster| !is_hidden(draw, cluster.bounds, frame, rows)) else {
                    break;
                };
                (&cluster.corners, &cluster.triangles)
            };
            setup::one(draw, own, triangles, index as u32, frame, corners, &mut Onto { vectors, rows, first });
        }
    }
}

/// Draws triangles as they come.
struct Onto<'a, 'b, V> {
    vectors: V,
    rows: &'a mut Rows<'b>,
    first: u32,
}

impl<V: Vectors> Sink for Onto<'_, '_, V> {
    #[inline(always)]
    fn take(&mut self, triangle: &Triangle) {
        self.rows.draw(self.vectors, triangle, self.first.wrapping_add(triangle.index));
    }
}

/// Whether nothing within a box can be seen in some rows.
#[inline(always)]
fn is_hidden(draw: &Draw<'_>, bounds: Aabb, frame: Frame<'_>, rows: &Rows<'_>) -> bool {
    let corners = setup::project(draw.to_camera, &bounds.corners(), frame);
    let all = corners.iter().fold(!AWKWARD, |all, corner| all & corner.beyond);
    let any = corners.iter().fold(0, |any, corner| any | corner.beyond);
    if all != 0 || any & AWKWARD != 0 {
        return all != 0;
    }
    let bound = |axis: usize, first: usize, count: usize| {
        let low = corners.iter().fold(i32::MAX, |low, corner| low.min(corner.at[axis])) - SLACK_SUB;
        let high = corners.iter().fold(i32::MIN, |high, corner| high.max(corner.at[axis])) + SLACK_SUB;
        let (low, high) = ((low >> SUB_BITS).max(first as i32), (high >> SUB_BITS).min((first + count) as i32 - 1));
        low as usize..(high + 1).max(low) as usize
    };
    let (across, down) = (bound(0, 0, rows.width), bound(1, rows.first, rows.count));
    let nearest = corners.iter().fold(0.0_f32, |nearest, corner| nearest.max(corner.nearness));
    let nearest = nearest / (1.0 - SLACK_M * nearest);
    down.into_iter().all(|y| {
        let row = (y - rows.first) * rows.width;
        let row = &rows.nearness[row + across.start..row + across.end];
        row.chunks(STRETCH).all(|stretch| stretch.iter().fold(0, |open, near| open | u32::from(*near < nearest)) == 0)
    })
}

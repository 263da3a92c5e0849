//! Which rooms a camera sees, and through which part of the picture: its own, and others through gaps in walls.

use cohabit_cdf::room::MOST_ROOMS;

use crate::camera::{Camera, NEAR_M, Rect, View};
use crate::mesh::Aabb;
use crate::plan::{Plan, rooms_of};

/// Gaps looked through one behind the other.
const DEPTH: u32 = 8;

/// For each room the part of the picture in which it may be seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Visible {
    rects: [Option<Rect>; MOST_ROOMS],
    /// The rooms that have one, as bits.
    seen: u64,
}

impl Visible {
    /// Every room, in the whole picture.
    pub(crate) fn everything(view: &View) -> Self {
        Self { rects: [Some(view.screen()); MOST_ROOMS], seen: u64::MAX }
    }

    /// What is seen from where the camera stands.
    pub(crate) fn new(plan: &Plan, view: &View, camera: &Camera) -> Self {
        let own = plan.rooms_at(view.eye.x, view.eye.y, 0.0);
        let inside = view.eye.z > 0.0 && view.eye.z < plan.height_m;
        if !camera.ceiling || !inside || own == 0 {
            return Self::everything(view);
        }
        let mut visible = Self { rects: [None; MOST_ROOMS], seen: 0 };
        for room in rooms_of(own) {
            visible.look(plan, view, room, view.screen(), DEPTH);
        }
        visible
    }

    fn look(&mut self, plan: &Plan, view: &View, room: usize, rect: Rect, depth: u32) {
        self.rects[room] = Some(self.rects[room].map_or(rect, |known| known.union(rect)));
        self.seen |= 1 << room;
        if depth == 0 {
            return;
        }
        for gap in plan.gaps.iter().filter(|gap| gap.rooms >> room & 1 == 1 && gap.rooms.count_ones() == 2) {
            let beyond = (gap.rooms & !(1 << room)).trailing_zeros() as usize;
            let Some(through) = gap_rect(view, gap.bounds).and_then(|gap| gap.intersection(rect)) else { continue };
            let known = self.rects[beyond].is_some_and(|known| known.union(through) == known);
            if !known {
                self.look(plan, view, beyond, through, depth - 1);
            }
        }
    }

    /// Whether something in these rooms, within this part of the picture, may be seen.
    pub(crate) fn sees(&self, rooms: u64, rect: Rect) -> bool {
        let mut rects = rooms_of(rooms & self.seen).filter_map(|room| self.rects[room]);
        rects.any(|own| own.intersection(rect).is_some())
    }
}

/// The part of the picture that a gap may cover.
fn gap_rect(view: &View, bounds: Aabb) -> Option<Rect> {
    let corners = bounds.corners().map(|corner| view.in_camera(corner));
    if corners.iter().all(|corner| corner.z <= NEAR_M) {
        return None;
    }
    if corners.iter().any(|corner| corner.z <= NEAR_M) {
        return Some(view.screen());
    }
    let at = corners.map(|corner| {
        let scale = view.focal / corner.z;
        [corner.x * scale + view.center[0], corner.y * scale + view.center[1]]
    });
    let bound =
        |axis: usize| at.iter().fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
    let ((left, right), (top, bottom)) = (bound(0), bound(1));
    // One pixel more on each side, so that what a pixel's centre sees is never cut off.
    Some(Rect { min: [left - 1.0, top - 1.0], max: [right + 1.0, bottom + 1.0] })
}

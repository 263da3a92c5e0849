//! What one camera may see of a scene, before anything is drawn: by rooms, by the picture's edges, and by size.

use glam::Vec3;

use crate::camera::{Camera, View};
use crate::placed::Placed;
use crate::plan::{PlanPart, RoomSurface};
use crate::portals::Visible;
use crate::scene::Scene;

/// Radius in pixels above which an instance is drawn finely, and above which it is not drawn coarsely.
const LEVEL_PX: [f32; 2] = [130.0, 36.0];
/// Less than this radius in pixels is nothing to see.
const LEAST_PX: f32 = 0.35;

/// Something that may be seen.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Thing<'a> {
    /// Of the floor plan.
    Part(&'a PlanPart),
    /// An instance, at a level of detail.
    Placed(&'a Placed, usize),
}

/// Something that may be seen, and from how far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<'a> {
    pub thing: Thing<'a>,
    /// Its place in the order of the scene: the plan's parts, then all that is placed.
    pub number: usize,
    /// How far from the eye it begins.
    near_m: f32,
}

/// Everything that may be seen, the nearest first.
pub(crate) fn collect<'a>(scene: &'a Scene, camera: &Camera, view: &View, visible: &Visible) -> Vec<Seen<'a>> {
    let mut all = Vec::with_capacity(512);
    let parts = &scene.plan.parts;
    for (number, part) in parts.iter().enumerate() {
        if !camera.ceiling && matches!(part.surface, RoomSurface::Ceiling | RoomSurface::Lamp) {
            continue;
        }
        let (center, radius) = (part.bounds.center(), part.bounds.size().length() * 0.5);
        if view.sphere_rect(center, radius).is_some_and(|rect| visible.sees(part.rooms, rect)) {
            all.push(Seen {
                thing: Thing::Part(part),
                number,
                near_m: nearest(view, part.bounds.min, part.bounds.max),
            });
        }
    }
    for (index, placed) in scene.placed().enumerate().filter(|(_, placed)| camera.hide != Some(placed.id)) {
        let Some(rect) = view.sphere_rect(placed.center, placed.radius) else { continue };
        if !visible.sees(placed.rooms, rect) {
            continue;
        }
        let depth = view.in_camera(placed.center).z.max(0.05);
        let pixels = placed.radius * view.focal / depth;
        if pixels < LEAST_PX {
            continue;
        }
        let level = LEVEL_PX.iter().filter(|limit| pixels < **limit).count();
        let near_m = nearest(view, placed.bounds.min, placed.bounds.max);
        all.push(Seen { thing: Thing::Placed(placed, level), number: parts.len() + index, near_m });
    }
    // Stable: what is equally near stays in the order of the scene.
    all.sort_by(|a, b| a.near_m.total_cmp(&b.near_m));
    all
}

fn nearest(view: &View, min: Vec3, max: Vec3) -> f32 {
    (view.eye.clamp(min, max) - view.eye).length()
}

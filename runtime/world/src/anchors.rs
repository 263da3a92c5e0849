//! Anchors: the places of a receptacle that hold one object each, and which of them are free.

use cohabit_cdf::{ObjectId, catalog::Surface};
use glam::{Vec2, Vec3};

use crate::{entity::Support, facts::Facts, geometry::Pose};

/// One anchor of a receptacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Anchor {
    /// Its number in the receptacle.
    pub index: u16,
    /// Where it is, m, in the frame of the receptacle before its scale.
    pub at: Vec3,
    /// Height free above it, m.
    pub clearance_m: f32,
    /// How wide a thing may be that stands here, m: what is behind a door fits in whole, or the door would not shut.
    pub width_m: f32,
}

impl Anchor {
    /// The pose of what stands here, in the frame of the (scaled) receptacle.
    pub fn local(&self, scale: [f32; 3]) -> Pose {
        Pose { position: self.at * Vec3::from(scale), rotation: glam::Quat::IDENTITY }
    }
}

/// All anchors of `receptacle`, surface by surface; none, if it takes nothing.
pub(crate) fn anchors(facts: &Facts<'_>, receptacle: ObjectId) -> Vec<Anchor> {
    let Some(kind) = &facts.class(receptacle).receptacle else { return Vec::new() };
    let width = |surface: &Surface| {
        if kind.enclosed { surface.size_m[0].max(surface.size_m[1]) } else { f32::INFINITY }
    };
    let places = kind.surfaces.iter().flat_map(|surface| places(surface).map(move |at| (at, surface)));
    (0..=u16::MAX)
        .zip(places)
        .map(|(index, (at, surface))| Anchor { index, at, clearance_m: surface.clearance_m, width_m: width(surface) })
        .collect()
}

fn places(surface: &Surface) -> impl Iterator<Item = Vec3> + '_ {
    let [across, along] = surface.anchors;
    let step = |index: u32, count: u32, length: f32| ((index as f32 + 0.5) / count as f32 - 0.5) * length;
    (0..across).flat_map(move |x| {
        (0..along).map(move |y| {
            let on_surface = Vec2::new(step(x, across, surface.size_m[0]), step(y, along, surface.size_m[1]));
            Vec3::from(surface.center_m) + on_surface.extend(0.0)
        })
    })
}

/// Whether something that stands somewhere between the anchors of a receptacle takes the anchor of that number.
pub(crate) fn covers(facts: &Facts<'_>, id: ObjectId, receptacle: ObjectId, index: u16) -> bool {
    let scale = facts.object(receptacle).scale;
    let (Support::On { local, .. }, Some(anchor)) =
        (&facts.object(id).support, anchors(facts, receptacle).get(usize::from(index)).copied())
    else {
        return false;
    };
    is_covered(anchor.local(scale).position, local.position, radius(facts, id))
}

/// Whether something at `from` of this radius takes an anchor at `at`.
fn is_covered(at: Vec3, from: Vec3, radius: f32) -> bool {
    (from.z - at.z).abs() < 0.1 && from.truncate().distance(at.truncate()) < radius
}

/// The anchors where nothing stands, in order.
pub(crate) fn free_anchors(facts: &Facts<'_>, receptacle: ObjectId) -> Vec<Anchor> {
    let scale = facts.object(receptacle).scale;
    let taken: Vec<(Option<u16>, Vec3, f32)> = facts
        .state
        .children(receptacle)
        .filter_map(|child| match facts.object(child).support {
            Support::On { anchor, local, .. } => Some((anchor, local.position, radius(facts, child))),
            _ => None,
        })
        .collect();
    anchors(facts, receptacle)
        .into_iter()
        .filter(|anchor| {
            let at = anchor.local(scale).position;
            !taken.iter().any(|(index, from, radius)| match index {
                Some(index) => *index == anchor.index,
                // What the layout put somewhere between anchors takes those that it covers.
                None => is_covered(at, *from, *radius),
            })
        })
        .collect()
}

/// Half the larger side of what an object covers, m.
pub(crate) fn radius(facts: &Facts<'_>, id: ObjectId) -> f32 {
    let size = facts.size(id);
    size.x.max(size.y) / 2.0
}

/// The free anchors that something of this size fits under: those with elbow room, and the others, each in order.
pub(crate) fn roomy_and_tight(facts: &Facts<'_>, receptacle: ObjectId, size: Vec3) -> (Vec<Anchor>, Vec<Anchor>) {
    let scale = facts.object(receptacle).scale;
    let reach = size.x.max(size.y) / 2.0;
    free_anchors(facts, receptacle)
        .into_iter()
        .filter(|anchor| size.z <= anchor.clearance_m * scale[2] + 1e-3)
        .filter(|anchor| size.x.min(size.y) <= anchor.width_m * scale[0] + 1e-3)
        .partition(|anchor| has_elbow_room(facts, receptacle, anchor.local(scale).position, reach))
}

/// The same in one list, those with elbow room first.
pub(crate) fn fitting_anchors(facts: &Facts<'_>, receptacle: ObjectId, size: Vec3) -> Vec<Anchor> {
    let (roomy, tight) = roomy_and_tight(facts, receptacle, size);
    roomy.into_iter().chain(tight).collect()
}

/// Whether nothing on the same level comes closer to a point than two things may.
fn has_elbow_room(facts: &Facts<'_>, receptacle: ObjectId, at: Vec3, reach: f32) -> bool {
    facts.state.children(receptacle).all(|child| match facts.object(child).support {
        Support::On { local, .. } => {
            (local.position.z - at.z).abs() > 0.1
                || local.position.truncate().distance(at.truncate()) > 0.8 * (reach + radius(facts, child))
        }
        _ => true,
    })
}

/// Whether every anchor is taken; false for what takes nothing.
pub(crate) fn is_full(facts: &Facts<'_>, receptacle: ObjectId) -> bool {
    !anchors(facts, receptacle).is_empty() && free_anchors(facts, receptacle).is_empty()
}

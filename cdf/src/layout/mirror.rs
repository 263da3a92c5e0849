//! A plan mirrored left to right about its middle.

use super::{Layout, Opening, Placement, Room};

/// What an id ends in when the plan is mirrored.
pub(super) const SUFFIX: &str = "_mirror";

/// The plan as seen in a mirror that stands north-south in its middle; objects keep their own handedness.
pub(super) fn mirrored(plan: &Layout) -> Layout {
    let [west, _, east, _] = plan.bounds_m();
    let across = |x_m: f32| west + east - x_m;
    let mut plan = plan.clone();
    plan.id.push_str(SUFFIX);
    for Room { rects_m, .. } in &mut plan.rooms {
        for rect in rects_m {
            (rect[0], rect[2]) = (across(rect[2]), across(rect[0]));
        }
    }
    for Opening { at_m, .. } in &mut plan.openings {
        at_m[0] = across(at_m[0]);
    }
    for placement in &mut plan.placements {
        mirror_placement(placement, across);
    }
    for view in &mut plan.viewpoints {
        view.at_m[0] = across(view.at_m[0]);
        view.yaw_deg = yaw(view.yaw_deg);
    }
    for note in &mut plan.note_places {
        note.at_m[0] = across(note.at_m[0]);
        note.yaw_deg = yaw(note.yaw_deg);
    }
    plan
}

/// What stands on another object keeps its place before and behind, and changes sides.
fn mirror_placement(placement: &mut Placement, across: impl Fn(f32) -> f32) {
    if placement.on.is_none() {
        placement.at_m[0] = across(placement.at_m[0]);
    } else {
        placement.at_m[1] = -placement.at_m[1];
    }
    placement.yaw_deg = yaw(placement.yaw_deg);
}

/// The mirrored heading, in `(-180, 180]`.
fn yaw(yaw_deg: f32) -> f32 {
    let turned = 180.0 - yaw_deg;
    if turned > 180.0 { turned - 360.0 } else { turned }
}

//! Moving parts: the doors, lids and drawers of each class, and the space that they take as they open.
//!
//! They come from the joints of the models, so that what is seen to swing is what blocks. Never knows where anything
//! stands.

use cohabit_cdf::{
    Catalog, ClassId, Property,
    model::{Axis, Drive, Joint, Model, Part, Shape},
};
use glam::{Quat, Vec2, Vec3};

use crate::geometry::{Footprint, Pose, direction};

/// No leaf reaches further from the middle of its object, m.
pub(crate) const LEAF_M: f32 = 1.6;

/// The moving parts of all classes, by class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Swings(Vec<Vec<Swing>>);

/// A part that turns about an upright hinge, or slides level, as its object opens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Swing {
    /// Its corners when shut, m, in the object's frame.
    low: Vec3,
    high: Vec3,
    motion: Motion,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Turn { hinge: Vec2, by_rad: f32 },
    Slide { by: Vec2 },
}

/// A moving part where it is: an upright box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leaf {
    pub print: Footprint,
    /// Heights of its lower and upper edge, m.
    pub low_m: f32,
    pub high_m: f32,
}

impl Swings {
    /// Measures the moving parts of every class that is not carried about.
    pub fn new(catalog: &Catalog) -> Self {
        let classes = (0_u16..).map(ClassId).zip(catalog.classes());
        let swings = classes.map(|(id, class)| match class.has(Property::Pickupable) {
            true => Vec::new(),
            false => swings(catalog.model(id)),
        });
        Self(swings.collect())
    }

    /// The moving parts of a class.
    pub fn of(&self, class: ClassId) -> &[Swing] {
        self.0.get(usize::from(class.0)).map_or(&[], Vec::as_slice)
    }
}

impl Swing {
    /// Where it is on an object that is `opened` from 0 to 1.
    pub fn leaf(&self, object: &Pose, scale: Vec3, opened: f32) -> Leaf {
        let (low, high) = (self.low * scale, self.high * scale);
        let (center, half) = (((low + high) / 2.0).truncate(), ((high - low) / 2.0).truncate());
        let (center, turned_rad) = match self.motion {
            Motion::Turn { hinge, by_rad } => {
                let (hinge, angle) = (hinge * scale.truncate(), by_rad * opened);
                (hinge + direction(angle).rotate(center - hinge), angle)
            }
            Motion::Slide { by } => (center + by * scale.truncate() * opened, 0.0),
        };
        let at = object.point(center.extend(0.0));
        let print = Footprint::new(at.truncate(), half, object.yaw_rad() + turned_rad);
        Leaf { print, low_m: at.z + low.z, high_m: at.z + high.z }
    }
}

impl Leaf {
    /// Whether the straight line between two points goes through it.
    pub fn cuts(&self, a: Vec3, b: Vec3) -> bool {
        let (mut from, mut to) = (0.0_f32, 1.0_f32);
        let along = b.z - a.z;
        if along.abs() < 1e-6 {
            if a.z < self.low_m || a.z > self.high_m {
                return false;
            }
        } else {
            let (one, two) = ((self.low_m - a.z) / along, (self.high_m - a.z) / along);
            from = from.max(one.min(two));
            to = to.min(one.max(two));
        }
        from <= to && self.print.cut_by(a.lerp(b, from).truncate(), a.lerp(b, to).truncate())
    }
}

fn swings(model: &Model) -> Vec<Swing> {
    let opening = model.joints.iter().filter(|joint| joint.driven_by == Drive::Open);
    opening
        .filter_map(|joint| {
            let motion = motion(joint)?;
            let moved = model.parts.iter().filter(|part| part.joint.as_deref() == Some(&joint.id));
            let (low, high) = moved.map(part_bounds).reduce(join)?;
            Some(Swing { low, high, motion })
        })
        .collect()
}

fn motion(joint: &Joint) -> Option<Motion> {
    let axis = Vec3::from(joint.axis).normalize_or_zero();
    if axis.z.abs() > 0.9 && joint.turn_deg != 0.0 {
        let by_rad = joint.turn_deg.to_radians() * axis.z.signum();
        return Some(Motion::Turn { hinge: Vec3::from(joint.at).truncate(), by_rad });
    }
    (joint.slide_m != 0.0 && axis.z.abs() < 0.1).then(|| Motion::Slide { by: axis.truncate() * joint.slide_m })
}

/// Lower and upper corner of what a part fills, m.
fn part_bounds(part: &Part) -> (Vec3, Vec3) {
    let (low, high) = shape_bounds(&part.shape);
    let [x, y, z] = part.turn_deg.map(f32::to_radians);
    let turned = about(Vec3::Z, z) * about(Vec3::Y, y) * about(Vec3::X, x);
    let corners = (0..8_u8).map(|corner| {
        let pick = |axis: u8, at: usize| if corner >> axis & 1 == 0 { low[at] } else { high[at] };
        turned * Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2)) + Vec3::from(part.at)
    });
    let one = corners.map(|corner| (corner, corner)).reduce(join).unwrap_or_default();
    let all = match part.repeat {
        Some(repeat) => {
            let last = Vec3::from(repeat.step) * repeat.count.saturating_sub(1) as f32;
            join(one, (one.0 + last, one.1 + last))
        }
        None => one,
    };
    let Some(axis) = part.mirror else { return all };
    let flip = match axis {
        Axis::X => Vec3::new(-1.0, 1.0, 1.0),
        Axis::Y => Vec3::new(1.0, -1.0, 1.0),
        Axis::Z => Vec3::new(1.0, 1.0, -1.0),
    };
    let (one, two) = (all.0 * flip, all.1 * flip);
    join(all, (one.min(two), one.max(two)))
}

fn shape_bounds(shape: &Shape) -> (Vec3, Vec3) {
    let standing = |half: Vec2, height: f32| ((-half).extend(0.0), half.extend(height));
    match shape {
        Shape::Box { size, .. } => standing(Vec2::new(size[0], size[1]) / 2.0, size[2]),
        Shape::Cylinder { radius, top_radius, height, .. } => {
            standing(Vec2::splat(radius.max(top_radius.unwrap_or(0.0))), *height)
        }
        Shape::Sphere { radii } => (-Vec3::from(*radii), Vec3::from(*radii)),
        Shape::Lathe { profile } => {
            let at = |[radius, z]: [f32; 2]| (Vec3::new(-radius, -radius, z), Vec3::new(radius, radius, z));
            profile.iter().copied().map(at).reduce(join).unwrap_or_default()
        }
        Shape::Tube { path, radius, .. } => {
            let round = |point: &[f32; 3]| (Vec3::from(*point) - *radius, Vec3::from(*point) + *radius);
            path.iter().map(round).reduce(join).unwrap_or_default()
        }
        Shape::Extrude { outline, height, .. } => {
            let at = |point: &[f32; 2]| (Vec2::from(*point).extend(0.0), Vec2::from(*point).extend(*height));
            outline.iter().map(at).reduce(join).unwrap_or_default()
        }
        Shape::Mesh { points, .. } => {
            points.iter().map(|point| (Vec3::from(*point), Vec3::from(*point))).reduce(join).unwrap_or_default()
        }
        // Letters are painted on something else.
        Shape::Text { .. } | Shape::Line { .. } => (Vec3::ZERO, Vec3::ZERO),
    }
}

fn join(one: (Vec3, Vec3), two: (Vec3, Vec3)) -> (Vec3, Vec3) {
    (one.0.min(two.0), one.1.max(two.1))
}

fn about(axis: Vec3, angle_rad: f32) -> Quat {
    Quat::from_vec4((axis * libm::sinf(angle_rad / 2.0)).extend(libm::cosf(angle_rad / 2.0)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn leaf(class: &str, opened: f32) -> Leaf {
        let catalog = Catalog::builtin();
        let swings = Swings::new(&catalog);
        let class = catalog.find(class).unwrap();
        swings.of(class)[0].leaf(&Pose::level(Vec3::ZERO, 0.0), Vec3::ONE, opened)
    }

    #[test]
    fn a_door_swings_out_from_its_hinge() {
        let (shut, open) = (leaf("Door_01", 0.0), leaf("Door_01", 1.0));
        assert!(shut.print.distance(Vec2::new(0.0, 0.4)) == 0.0 && shut.high_m > 2.0, "{shut:?}");
        assert!(open.print.distance(Vec2::new(0.0, 0.4)) > 0.5 && open.print.distance(Vec2::new(0.9, -0.55)) < 0.05);
        assert!(shut.cuts(Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0)));
        assert!(!open.cuts(Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0)));
        assert!(!shut.cuts(Vec3::new(-1.0, 0.0, 2.5), Vec3::new(1.0, 0.0, 2.3)));
    }

    #[test]
    fn a_drawer_slides_out() {
        let (shut, open) = (leaf("KitchenCounterDrawer_02", 0.0), leaf("KitchenCounterDrawer_02", 1.0));
        assert!((open.print.center.x - shut.print.center.x - 0.4).abs() < 1e-5, "{open:?}");
        assert!(shut.low_m > 0.4 && shut.high_m < 0.9, "{shut:?}");
    }

    #[test]
    fn every_class_that_opens_and_is_not_carried_has_a_leaf_or_a_flap() {
        let catalog = Catalog::builtin();
        let swings = Swings::new(&catalog);
        for (id, class) in (0_u16..).map(ClassId).zip(catalog.classes()) {
            let opens = class.has(Property::Openable) && !class.has(Property::Pickupable);
            assert!(!opens || !swings.of(id).is_empty() || class.id == "VendingMachine_01", "{}", class.id);
        }
    }
}

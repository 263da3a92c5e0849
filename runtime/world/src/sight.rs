//! Who sees what: straight lines from an eye to a thing, and all that can stand in between.

use cohabit_cdf::{ObjectId, Property};
use glam::{Vec2, Vec3};

use crate::{body::Body, entity::Support, facts::Facts, geometry::Pose};

/// How wide a camera sees to each side: the cosine of 45 degrees.
const SIGHT_COS: f32 = 0.707;
/// Thickness of a board of open furniture, m.
const BOARD_M: f32 = 0.04;
/// What is smaller than this hides nothing worth the name, m.
const SMALL_M: f32 = 0.25;

/// A box in the world.
struct Block {
    pose: Pose,
    center: Vec3,
    half: Vec3,
}

/// Whether a body sees an object that is no further from its eye than `within_m`.
pub(crate) fn sees(facts: &Facts<'_>, body: &Body, id: ObjectId, within_m: f32) -> bool {
    let eye = body.eye();
    let in_view = |point: &Vec3| {
        let to = *point - eye;
        to.length() <= within_m && to.normalize_or_zero().dot(body.gaze()) >= SIGHT_COS
    };
    let points: Vec<Vec3> = marks(facts, id).into_iter().filter(in_view).collect();
    if points.is_empty() || facts.shut_around(id).is_some() || facts.walled_off(id, body.position) {
        return false;
    }
    let blocks = between(facts, id, eye, &points);
    points.into_iter().any(|point| !blocks.iter().any(|block| block.hides(eye, point)))
}

/// The points of a thing that are looked for: its middle, and places near its ends.
fn marks(facts: &Facts<'_>, id: ObjectId) -> [Vec3; 6] {
    let object = facts.object(id);
    let size = facts.size(id);
    let at = |x: f32, y: f32, z: f32| object.pose.point(Vec3::new(x * size.x, y * size.y, z * size.z));
    [at(0.0, 0.0, 0.5), at(0.0, 0.0, 0.9), at(0.4, 0.0, 0.5), at(-0.4, 0.0, 0.5), at(0.0, 0.4, 0.5), at(0.0, -0.4, 0.5)]
}

/// What could stand between an eye and the points of a thing; not what it stands in or on, nor what stands on it.
fn between(facts: &Facts<'_>, id: ObjectId, eye: Vec3, points: &[Vec3]) -> Vec<Block> {
    let own = |other: ObjectId| {
        other == id
            || facts.state.ancestors(id).any(|outer| outer == other)
            || facts.state.ancestors(other).any(|outer| outer == id)
    };
    let reach = |low: Vec2, point: &Vec3| low.min(point.truncate());
    let low = points.iter().fold(eye.truncate(), reach);
    let high = points.iter().fold(eye.truncate(), |high, point| high.max(point.truncate()));
    let large = |other: ObjectId| facts.size(other).max_element() >= SMALL_M;
    let solid = facts.state.existing().filter(|(other, object)| {
        let radius = facts.size(*other).truncate().length() / 2.0;
        let at = object.pose.position.truncate();
        matches!(object.support, Support::Fixed | Support::On { .. })
            && at.cmpge(low - radius).all()
            && at.cmple(high + radius).all()
            && large(*other)
            // These count with the walls that they are in.
            && !facts.is_room_door(*other)
            && !own(*other)
    });
    solid.flat_map(|(other, _)| blocks(facts, other)).collect()
}

/// Open furniture is its boards; what is hollow and small hides nothing; everything else is its whole box.
fn blocks(facts: &Facts<'_>, id: ObjectId) -> Vec<Block> {
    let class = facts.class(id);
    let pose = facts.object(id).pose;
    let scale = Vec3::from(facts.object(id).scale);
    match &class.receptacle {
        Some(kind) if !kind.enclosed && !facts.has(id, Property::Powerable) => kind
            .surfaces
            .iter()
            .map(|surface| Block {
                pose,
                center: (Vec3::from(surface.center_m) - Vec3::Z * (BOARD_M / 2.0)) * scale,
                half: Vec2::from(surface.size_m).extend(BOARD_M) / 2.0 * scale,
            })
            .collect(),
        _ => {
            let half = Vec3::from(class.size_m) / 2.0 * scale;
            vec![Block { pose, center: Vec3::Z * half.z, half }]
        }
    }
}

impl Block {
    /// Whether the straight line from `eye` to `point` goes through it.
    fn hides(&self, eye: Vec3, point: Vec3) -> bool {
        let inverse = self.pose.rotation.inverse();
        let local = |world: Vec3| inverse * (world - self.pose.position) - self.center;
        let (from, to) = (local(eye), local(point));
        let along = to - from;
        let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
        for axis in 0..3 {
            if along[axis].abs() < 1e-6 {
                if from[axis].abs() > self.half[axis] {
                    return false;
                }
                continue;
            }
            let one = (-self.half[axis] - from[axis]) / along[axis];
            let two = (self.half[axis] - from[axis]) / along[axis];
            enter = enter.max(one.min(two));
            leave = leave.min(one.max(two));
        }
        enter < leave
    }
}

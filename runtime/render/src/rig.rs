//! Joints: where a part turns or slides when something drives it, and what carries them.

use cohabit_cdf::model::{Cycle, CycleWay, Drive, Model};
use glam::{Mat3, Vec3};

use crate::mesh::Aabb;
use crate::pose::{Limb, Pose};

/// What moves a joint.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Driver {
    /// How far the object is open.
    Opened,
    /// How far it runs.
    Running,
    /// The pose of a body: radians about the axis, or metres along it.
    Limb(Limb),
}

/// A joint, ready to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rig {
    pub driver: Driver,
    pub at: Vec3,
    pub axis: Vec3,
    pub turn_rad: f32,
    pub slide_m: f32,
    /// The joint that carries it: one before it.
    pub parent: Option<u8>,
    pub cycle: Option<Cycle>,
}

/// What drives the joints of an instance, and when.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drives<'a> {
    pub opened: f32,
    pub running: f32,
    pub pose: Option<&'a Pose>,
    /// Simulated time.
    pub nanos: u64,
}

impl Rig {
    /// The rotation and offset of what it moves, in the frame of what carries it.
    fn moved(&self, drives: &Drives<'_>) -> (Mat3, Vec3) {
        let (angle, slide) = match self.driver {
            Driver::Limb(limb) => {
                let value = drives.pose.map_or(0.0, |pose| pose.of(limb));
                if limb.slides() { (0.0, value) } else { (value, 0.0) }
            }
            Driver::Opened => self.driven(drives.opened, drives.nanos),
            Driver::Running => self.driven(drives.running, drives.nanos),
        };
        self.motion(angle, slide)
    }

    /// Whether it is driven at all.
    pub(crate) fn is_driven(&self, drives: &Drives<'_>) -> bool {
        match self.driver {
            Driver::Limb(_) => drives.pose.is_some(),
            Driver::Opened => drives.opened > 0.0,
            Driver::Running => drives.running > 0.0,
        }
    }

    /// Angle and way for a value from 0 to 1, at a time.
    fn driven(&self, value: f32, nanos: u64) -> (f32, f32) {
        let Some(cycle) = self.cycle.filter(|_| value > 0.0) else {
            return (self.turn_rad * value, self.slide_m * value);
        };
        let share = phase(nanos, cycle.per_s);
        match cycle.way {
            CycleWay::Around => (core::f32::consts::TAU.copysign(self.turn_rad) * share, self.slide_m * value),
            CycleWay::OverAndOver => (self.turn_rad * value * share, self.slide_m * value * share),
            CycleWay::BackAndForth => {
                let there = value * (0.5 - 0.5 * libm::cosf(core::f32::consts::TAU * share));
                (self.turn_rad * there, self.slide_m * there)
            }
        }
    }

    fn motion(&self, angle: f32, slide: f32) -> (Mat3, Vec3) {
        let rotation = axis_rotation(self.axis, angle);
        (rotation, self.at - rotation * self.at + self.axis * slide)
    }
}

/// How far, 0 to 1, a motion that repeats so often has come.
pub(crate) fn phase(nanos: u64, per_s: f32) -> f32 {
    let turns = nanos as f64 * 1e-9 * f64::from(per_s);
    (turns - libm::floor(turns)) as f32
}

/// For each joint, the rotation and offset of what it moves, in the object's frame.
pub(crate) fn transforms(rigs: &[Rig], drives: &Drives<'_>) -> Vec<(Mat3, Vec3)> {
    let mut all: Vec<(Mat3, Vec3)> = Vec::with_capacity(rigs.len());
    for rig in rigs {
        let (rotation, offset) = rig.moved(drives);
        let whole = match rig.parent.and_then(|parent| all.get(usize::from(parent))) {
            Some((above, shift)) => (*above * rotation, *above * offset + *shift),
            None => (rotation, offset),
        };
        all.push(whole);
    }
    all
}

/// Whether a joint, or one that carries it, moves on and on.
pub(crate) fn cycles(rigs: &[Rig], joint: u8) -> bool {
    let mut next = Some(joint);
    while let Some(rig) = next.and_then(|joint| rigs.get(usize::from(joint))) {
        if rig.cycle.is_some() {
            return true;
        }
        next = rig.parent;
    }
    false
}

/// The box around what `joint` moves, on its whole way and on that of all that carries it.
pub(crate) fn swept(own: Aabb, rigs: &[Rig], joint: u8) -> Aabb {
    let mut all = own;
    let mut next = Some(joint);
    while let Some(rig) = next.and_then(|joint| rigs.get(usize::from(joint))) {
        let around = all;
        for (angle, slide) in rig.ways() {
            let (rotation, offset) = rig.motion(angle, slide);
            for corner in around.corners() {
                all = all.with(rotation * corner + offset);
            }
        }
        next = rig.parent;
    }
    all
}

impl Rig {
    /// Places on its way, close enough to each other for a box around them.
    fn ways(&self) -> Vec<(f32, f32)> {
        let part = |step: u32, of: u32| step as f32 / of as f32;
        match (self.driver, self.cycle) {
            (Driver::Limb(limb), _) => {
                let [low, high] = limb.range();
                let values = (0..=4).map(|step| low + (high - low) * part(step, 4));
                values.map(|value| if limb.slides() { (0.0, value) } else { (value, 0.0) }).collect()
            }
            (_, Some(Cycle { way: CycleWay::Around, .. })) => {
                let turns = (0..16).map(|step| core::f32::consts::TAU * part(step, 16));
                turns.flat_map(|angle| [(angle, 0.0), (angle, self.slide_m)]).collect()
            }
            _ => (0..=4).map(|step| (self.turn_rad * part(step, 4), self.slide_m * part(step, 4))).collect(),
        }
    }
}

/// Rodrigues' formula, with the same bits on every machine.
fn axis_rotation(axis: Vec3, angle: f32) -> Mat3 {
    let (sin, cos) = libm::sincosf(angle);
    let (s, t) = (axis * sin, 1.0 - cos);
    Mat3::from_cols(
        Vec3::new(cos + axis.x * axis.x * t, axis.x * axis.y * t + s.z, axis.x * axis.z * t - s.y),
        Vec3::new(axis.x * axis.y * t - s.z, cos + axis.y * axis.y * t, axis.y * axis.z * t + s.x),
        Vec3::new(axis.x * axis.z * t + s.y, axis.y * axis.z * t - s.x, cos + axis.z * axis.z * t),
    )
}

/// The joints of a model, or which of them is carried by none before it.
pub(crate) fn rigs(model: &Model, body: bool) -> Result<Vec<Rig>, usize> {
    let mut all = Vec::with_capacity(model.joints.len());
    for (index, joint) in model.joints.iter().enumerate() {
        let driver = match (Limb::named(&joint.id).filter(|_| body), joint.driven_by) {
            (Some(limb), _) => Driver::Limb(limb),
            (None, Drive::Open) => Driver::Opened,
            (None, Drive::On) => Driver::Running,
        };
        let parent = match &joint.parent {
            None => None,
            Some(name) => {
                let before = model.joints[..index].iter().position(|known| known.id == *name);
                Some(before.ok_or(index)? as u8)
            }
        };
        all.push(Rig {
            driver,
            at: Vec3::from_array(joint.at),
            axis: Vec3::from_array(joint.axis).normalize_or(Vec3::Z),
            turn_rad: joint.turn_deg.to_radians(),
            slide_m: joint.slide_m,
            parent,
            cycle: joint.cycle,
        });
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(axis: Vec3, turn_rad: f32, slide_m: f32) -> Rig {
        Rig { driver: Driver::Running, at: Vec3::ZERO, axis, turn_rad, slide_m, parent: None, cycle: None }
    }

    fn at(rigs: &[Rig], nanos: u64) -> Vec<(Mat3, Vec3)> {
        transforms(rigs, &Drives { opened: 0.0, running: 1.0, pose: None, nanos })
    }

    #[test]
    fn what_is_carried_goes_along() {
        let shoulder = rig(Vec3::Y, -core::f32::consts::FRAC_PI_2, 0.0);
        let hand = Rig { at: Vec3::NEG_Z, parent: Some(0), ..rig(Vec3::Y, -core::f32::consts::FRAC_PI_2, 0.0) };
        let all = at(&[shoulder, hand], 0);
        let (turn, shift) = all[1];
        // A forearm that hung below points up, in front.
        assert!((turn * Vec3::new(0.0, 0.0, -2.0) + shift - Vec3::new(1.0, 0.0, 1.0)).length() < 1e-5);
    }

    #[test]
    fn what_repeats_comes_back() {
        for way in [CycleWay::Around, CycleWay::BackAndForth, CycleWay::OverAndOver] {
            let one = [Rig { cycle: Some(Cycle { way, per_s: 0.5 }), ..rig(Vec3::Z, 1.0, 0.3) }];
            assert_eq!(at(&one, 300_000_000), at(&one, 300_000_000));
            assert_ne!(at(&one, 300_000_000), at(&one, 700_000_000));
            let [(turn, _)] = at(&one, 2_000_000_000)[..] else { panic!("one joint") };
            assert!((turn * Vec3::X - Vec3::X).length() < 1e-5, "{way:?}");
        }
    }
}

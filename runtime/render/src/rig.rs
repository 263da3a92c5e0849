//! Joints: where a part turns or slides when something drives it.

use cohabit_cdf::model::{Drive, Model};
use glam::Vec3;

use crate::mesh::Aabb;

/// What moves a joint.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Driver {
    /// How far the object is open.
    Opened,
    /// How far it runs.
    Running,
    /// The pitch of the robot's head.
    Head,
    /// How far a body reaches forward.
    Arm,
}

/// A joint, ready to move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rig {
    pub driver: Driver,
    pub at: Vec3,
    pub axis: Vec3,
    pub turn_rad: f32,
    pub slide_m: f32,
}

/// The box around a moving box on its whole way.
pub(crate) fn swept(own: Aabb, rig: &Rig) -> Aabb {
    let values: &[f32] = if rig.driver == Driver::Head { &[-1.2, -0.6, 0.6, 1.2] } else { &[0.25, 0.5, 0.75, 1.0] };
    let mut all = own;
    for value in values {
        let (rotation, offset) = rig.moved(*value);
        for corner in own.corners() {
            all = all.with(rotation * corner + offset);
        }
    }
    all
}

impl Rig {
    /// The rotation and offset of what it moves, in the object's frame. A head takes its pitch in radians, upwards.
    pub(crate) fn moved(&self, value: f32) -> (glam::Mat3, Vec3) {
        let (angle, slide) = match self.driver {
            // Turning about the left axis by a positive angle would lower the face.
            Driver::Head => (if self.axis.y < 0.0 { value } else { -value }, 0.0),
            _ => (self.turn_rad * value, self.slide_m * value),
        };
        let rotation = axis_rotation(self.axis, angle);
        (rotation, self.at - rotation * self.at + self.axis * slide)
    }
}

/// Rodrigues' formula, with the same bits on every machine.
fn axis_rotation(axis: Vec3, angle: f32) -> glam::Mat3 {
    let (sin, cos) = libm::sincosf(angle);
    let (s, t) = (axis * sin, 1.0 - cos);
    glam::Mat3::from_cols(
        Vec3::new(cos + axis.x * axis.x * t, axis.x * axis.y * t + s.z, axis.x * axis.z * t - s.y),
        Vec3::new(axis.x * axis.y * t - s.z, cos + axis.y * axis.y * t, axis.y * axis.z * t + s.x),
        Vec3::new(axis.x * axis.z * t + s.y, axis.y * axis.z * t - s.x, cos + axis.z * axis.z * t),
    )
}

/// The joints of a model.
pub(crate) fn rigs(model: &Model) -> Vec<Rig> {
    let body = model.id == "robot" || model.id == "human";
    let driver = |id: &str, drive: Drive| match drive {
        _ if body && id.starts_with("head") => Driver::Head,
        _ if body && id.starts_with("arm") => Driver::Arm,
        Drive::Open => Driver::Opened,
        Drive::On => Driver::Running,
    };
    let rig = |joint: &cohabit_cdf::model::Joint| Rig {
        driver: driver(&joint.id, joint.driven_by),
        at: Vec3::from_array(joint.at),
        axis: Vec3::from_array(joint.axis).normalize_or(Vec3::Z),
        turn_rad: joint.turn_deg.to_radians(),
        slide_m: joint.slide_m,
    };
    model.joints.iter().map(rig).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_head_looks_up_and_an_arm_reaches_forward() {
        let rig = |driver, turn_rad| Rig { driver, at: Vec3::ZERO, axis: Vec3::Y, turn_rad, slide_m: 0.0 };
        let (turn, _) = rig(Driver::Head, 0.0).moved(0.3);
        assert!((turn * Vec3::X).z > 0.2);
        let (turn, _) = rig(Driver::Arm, -1.2).moved(1.0);
        assert!((turn * Vec3::NEG_Z).x > 0.9);
    }
}

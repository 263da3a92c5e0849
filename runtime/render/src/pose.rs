//! How bodies hold themselves: from what they do to the angles of their joints.

use core::f32::consts::TAU;

/// What a body's model may move, by the names of its joints.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Limb {
    /// All that is carried: goes up and down with each step.
    Body,
    /// Leans forward from the hips.
    Torso,
    Head,
    ArmLeft,
    ArmRight,
    ElbowLeft,
    ElbowRight,
    /// A hand that slides out of its forearm.
    HandRight,
    LegLeft,
    LegRight,
    KneeLeft,
    KneeRight,
    Wheels,
}

impl Limb {
    const ALL: [(Self, &'static str); 13] = [
        (Self::Body, "body"),
        (Self::Torso, "torso"),
        (Self::Head, "head"),
        (Self::ArmLeft, "arm_left"),
        (Self::ArmRight, "arm_right"),
        (Self::ElbowLeft, "elbow_left"),
        (Self::ElbowRight, "elbow_right"),
        (Self::HandRight, "hand_right"),
        (Self::LegLeft, "leg_left"),
        (Self::LegRight, "leg_right"),
        (Self::KneeLeft, "knee_left"),
        (Self::KneeRight, "knee_right"),
        (Self::Wheels, "wheels"),
    ];

    /// The limb that a joint of this name moves.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| *known == name).map(|(limb, _)| *limb)
    }

    /// Whether it slides along its axis; otherwise it turns about it.
    pub(crate) fn slides(self) -> bool {
        matches!(self, Self::Body | Self::HandRight)
    }

    /// The least and the greatest value, rad or m.
    pub(crate) fn range(self) -> [f32; 2] {
        match self {
            Self::Body => [-0.12, 0.0],
            Self::Torso => [0.0, 0.45],
            Self::Head => [-1.6, 1.6],
            Self::ArmLeft | Self::ArmRight => [-0.8, 1.9],
            Self::ElbowLeft | Self::ElbowRight => [0.0, 2.6],
            Self::HandRight => [0.0, 0.3],
            Self::LegLeft | Self::LegRight => [-0.6, 0.6],
            Self::KneeLeft | Self::KneeRight => [-1.2, 0.0],
            Self::Wheels => [0.0, TAU],
        }
    }
}

/// The value of every limb: rad, forwards or upwards, or m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    values: [f32; Limb::ALL.len()],
}

impl Pose {
    pub(crate) fn of(&self, limb: Limb) -> f32 {
        self.values[limb as usize]
    }

    fn set(&mut self, limb: Limb, value: f32) {
        let [low, high] = limb.range();
        // What is no number becomes zero.
        self.values[limb as usize] = if value.is_finite() { value.clamp(low, high) } else { 0.0 };
    }
}

/// Two links in a plane that looks along the body: forwards, and up.
struct Arm {
    /// Lengths from shoulder to elbow, and from elbow to the middle of the hand, m.
    links_m: [f32; 2],
    /// Angles of shoulder and elbow while it hangs.
    rest_rad: [f32; 2],
    /// Where the hand is, seen from the shoulder, while it carries something, m.
    carry_m: [f32; 2],
    /// How much further it is when the arm is stretched out, m.
    reach_m: f32,
}

const ROBOT: Arm = Arm { links_m: [0.21, 0.235], rest_rad: [-0.06, 0.45], carry_m: [0.38, -0.04], reach_m: 0.3 };
const PERSON: Arm = Arm { links_m: [0.28, 0.29], rest_rad: [-0.06, 0.2], carry_m: [0.37, -0.33], reach_m: 0.3 };
/// What a robot's hand slides out by, m.
const SLIDE_M: f32 = 0.27;
/// From a step of one foot to its next, m.
const STRIDE_M: f32 = 1.35;
/// How far a leg swings, rad, and how far it bends.
const SWING_RAD: f32 = 0.42;
const BEND_RAD: f32 = 0.85;
/// From hip to sole, m.
const LEG_M: f32 = 0.86;
/// From the hips to the shoulders, m.
const TRUNK_M: f32 = 0.43;
/// How far people bend to reach something, rad.
const LEAN_RAD: f32 = 0.42;
/// Radius of the robot's wheels, m.
const WHEEL_M: f32 = 0.095;

impl Arm {
    /// Angles of shoulder and elbow that bring the hand to a point, and by how much it falls short, m.
    fn at(&self, [forward, up]: [f32; 2]) -> ([f32; 2], f32) {
        let [upper, fore] = self.links_m;
        let wanted = forward.hypot(up);
        let far = wanted.clamp((upper - fore).abs() + 0.02, (upper + fore) * 0.995);
        let corner = |a: f32, b: f32, c: f32| libm::acosf(((a * a + b * b - c * c) / (2.0 * a * b)).clamp(-1.0, 1.0));
        let towards = libm::atan2f(forward, -up);
        let shoulder = towards - corner(upper, far, fore);
        let elbow = core::f32::consts::PI - corner(upper, fore, far);
        ([shoulder, elbow], wanted - far)
    }

    /// Where the hand wants to be, seen from the shoulder of somebody upright.
    fn target(&self, arm: f32, holds: bool) -> [f32; 2] {
        [self.carry_m[0] + self.reach_m * if holds { arm } else { 1.0 }, self.carry_m[1]]
    }

    /// Angles of an arm whose hand wants to be there, and is on its way: at once if it holds something.
    fn on_its_way(&self, there_rad: [f32; 2], arm: f32, holds: bool) -> [f32; 2] {
        let share = if holds { 1.0 } else { arm };
        [0, 1].map(|joint| self.rest_rad[joint] + (there_rad[joint] - self.rest_rad[joint]) * share)
    }
}

/// How a robot holds itself.
pub(crate) fn robot(head_pitch_rad: f32, arm: f32, holds: bool, rolled_m: f32) -> Pose {
    let mut pose = Pose::default();
    pose.set(Limb::Head, head_pitch_rad);
    let arm = share(arm);
    let (there, short) = ROBOT.at(ROBOT.target(arm, holds));
    let [shoulder, elbow] = ROBOT.on_its_way(there, arm, holds);
    pose.set(Limb::ArmRight, shoulder);
    pose.set(Limb::ElbowRight, elbow);
    pose.set(Limb::HandRight, (short * if holds { 1.0 } else { arm }).clamp(0.0, SLIDE_M));
    pose.set(Limb::ArmLeft, ROBOT.rest_rad[0]);
    pose.set(Limb::ElbowLeft, ROBOT.rest_rad[1]);
    let turns = rolled_m / (TAU * WHEEL_M);
    pose.set(Limb::Wheels, (turns - libm::floorf(turns)) * TAU);
    pose
}

/// How a person does: `pace` is 0 standing, 1 walking.
pub(crate) fn person(head_pitch_rad: f32, arm: f32, holds: bool, walked_m: f32, pace: f32) -> Pose {
    let mut pose = Pose::default();
    let (pace, arm) = (share(pace), share(arm));
    let turns = walked_m / STRIDE_M;
    let (sin, cos) = libm::sincosf((turns - libm::floorf(turns)) * TAU);
    for (leg, knee, side) in [(Limb::LegRight, Limb::KneeRight, 1.0_f32), (Limb::LegLeft, Limb::KneeLeft, -1.0_f32)] {
        pose.set(leg, SWING_RAD * pace * side * sin);
        // It bends while it comes forward.
        pose.set(knee, -pace * (0.06 + BEND_RAD * (side * cos).max(0.0)));
    }
    // Legs apart do not reach the floor from where legs together do.
    pose.set(Limb::Body, LEG_M * (libm::cosf(SWING_RAD * pace * sin) - 1.0));
    let swing = -0.4 * pace * sin;
    let upright = PERSON.target(arm, holds);
    let lean = (PERSON.at(upright).1 / TRUNK_M).clamp(0.0, LEAN_RAD) * if holds { 1.0 } else { arm };
    pose.set(Limb::Torso, lean);
    pose.set(Limb::Head, head_pitch_rad + lean);
    let ([shoulder, elbow], _) = PERSON.at(leant(upright, lean));
    let [shoulder, elbow] = PERSON.on_its_way([shoulder, elbow], arm, holds);
    let free = if holds { 0.0 } else { 1.0 - arm };
    pose.set(Limb::ArmRight, shoulder + swing * free);
    pose.set(Limb::ElbowRight, elbow + 0.3 * pace * free);
    pose.set(Limb::ArmLeft, PERSON.rest_rad[0] - swing + lean);
    pose.set(Limb::ElbowLeft, PERSON.rest_rad[1] + 0.3 * pace);
    pose
}

/// What is no number, or too small, is 0; what is too large is 1.
fn share(value: f32) -> f32 {
    if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 }
}

/// A point seen from the shoulder of somebody upright, seen from that of somebody who leans forward.
fn leant([forward, up]: [f32; 2], lean_rad: f32) -> [f32; 2] {
    let (sin, cos) = libm::sincosf(lean_rad);
    let from_hips = [forward, up + TRUNK_M];
    [from_hips[0] * cos - from_hips[1] * sin, from_hips[0] * sin + from_hips[1] * cos - TRUNK_M]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_gets_where_it_is_wanted() {
        for point in [[0.3, -0.3], [0.4, 0.0], [0.1, -0.4]] {
            let ([shoulder, elbow], short) = PERSON.at(point);
            let [upper, fore] = PERSON.links_m;
            let hand = [
                upper * shoulder.sin() + fore * (shoulder + elbow).sin(),
                -upper * shoulder.cos() - fore * (shoulder + elbow).cos(),
            ];
            assert!((hand[0] - point[0]).hypot(hand[1] - point[1]) < 1e-4 && short.abs() < 1e-4, "{point:?} {hand:?}");
        }
        let (_, short) = ROBOT.at([0.7, 0.0]);
        assert!(short > 0.2);
    }

    #[test]
    fn limbs_stay_in_their_ranges() {
        for step in 0..40 {
            let x = step as f32 * 0.31 - 5.0;
            for pose in [person(x, x, step % 2 == 0, x * 3.0, x.abs()), robot(x, x, step % 3 == 0, x)] {
                for (limb, name) in Limb::ALL {
                    let [low, high] = limb.range();
                    assert!((low..=high).contains(&pose.of(limb)), "{name}: {}", pose.of(limb));
                }
            }
        }
        assert_eq!(person(f32::NAN, f32::NAN, true, f32::INFINITY, f32::NAN).of(Limb::Head), 0.0);
    }
}

//! The camera that follows a body for people to watch: behind and above it, smooth, and never outside its room.

use cohabit_cdf::Layout;
use cohabit_render::{Camera, Instance, Lens};
use libm::{cosf, expf, sinf};

use crate::standing::Standing;

const BEHIND_M: f32 = 1.9;
const NEAREST_M: f32 = 0.45;
const ABOVE_FLOOR_M: f32 = 1.95;
const PITCH_RAD: f32 = -0.32;
/// How much of the head's pitch the camera takes on.
const HEAD_SHARE: f32 = 0.2;
/// How much higher the camera is, and how much farther down it looks, with a wall right behind the body.
const RISE_M: f32 = 0.6;
const LOOK_DOWN_RAD: f32 = 0.6;
const CLEAR_OF_WALLS_M: f32 = 0.22;
/// How fast the camera closes in on where it should be, 1/s.
const FOLLOW_PER_S: f32 = 7.0;
const TURN_PER_S: f32 = 6.0;

/// A camera on a boom behind a body.
#[derive(Clone, Debug, Default)]
pub struct CameraRig {
    pose: Option<Pose>,
}

#[derive(Clone, Copy, Debug)]
struct Pose {
    x: f32,
    y: f32,
    yaw_rad: f32,
    boom_m: f32,
    pitch_rad: f32,
}

impl CameraRig {
    /// Moves the camera on by `dt_s` seconds and gives where it is now.
    pub fn follow(&mut self, standing: &Standing, layout: &Layout, tall: &[Tall], dt_s: f32, lens: Lens) -> Camera {
        let [x, y, _] = standing.position_m;
        let mut pose =
            self.pose.unwrap_or(Pose { x, y, yaw_rad: standing.yaw_rad, boom_m: BEHIND_M, pitch_rad: PITCH_RAD });
        let near = 1.0 - expf(-FOLLOW_PER_S * dt_s);
        let turned = 1.0 - expf(-TURN_PER_S * dt_s);
        pose.x += (x - pose.x) * near.max(0.5);
        pose.y += (y - pose.y) * near.max(0.5);
        pose.yaw_rad += wrap(standing.yaw_rad - pose.yaw_rad) * turned;
        pose.pitch_rad += (PITCH_RAD + standing.head_pitch_rad * HEAD_SHARE - pose.pitch_rad) * turned;
        let back = [-cosf(pose.yaw_rad), -sinf(pose.yaw_rad)];
        let free = free_length_m(layout, tall, [pose.x, pose.y], back, BEHIND_M);
        // Walls pull the camera in at once; it eases out again.
        pose.boom_m = free.min(pose.boom_m + (free - pose.boom_m).max(0.0) * near * 0.4);
        self.pose = Some(pose);
        let boom = pose.boom_m.max(NEAREST_M);
        // With a wall at its back the camera rises and looks down on the body instead.
        let near_wall = 1.0 - boom / BEHIND_M;
        let place = [boom, ABOVE_FLOOR_M + near_wall * RISE_M];
        Camera::third_person(lens, [pose.x, pose.y], pose.yaw_rad, place, pose.pitch_rad - near_wall * LOOK_DOWN_RAD)
    }
}

fn wrap(angle_rad: f32) -> f32 {
    use std::f32::consts::{PI, TAU};
    let turned = (angle_rad + PI) % TAU;
    if turned < 0.0 { turned + PI } else { turned - PI }
}

/// How far one can go from a point before leaving the rooms' floors or coming to something tall, at most `most_m`.
pub fn free_length_m(layout: &Layout, tall: &[Tall], from: [f32; 2], direction: [f32; 2], most_m: f32) -> f32 {
    const STEP_M: f32 = 0.05;
    let mut length = 0.0;
    while length < most_m {
        let next = length + STEP_M;
        let point = [from[0] + direction[0] * next, from[1] + direction[1] * next];
        if !on_clear_floor(layout, point) || tall.iter().any(|tall| tall.holds(point)) {
            break;
        }
        length = next;
    }
    length
}

/// The outline of something at the height of the camera.
#[derive(Clone, Copy, Debug)]
pub struct Tall {
    middle_m: [f32; 2],
    half_m: [f32; 2],
    /// Along its own x.
    axis: [f32; 2],
}

impl Tall {
    /// Where a camera may be, m above the floor.
    const HEIGHTS_M: [f32; 2] = [ABOVE_FLOOR_M - 0.1, ABOVE_FLOOR_M + RISE_M + 0.1];

    /// The outline of an instance with a box of that size; `None` if the camera passes above or below it.
    pub fn of(instance: &Instance, size_m: [f32; 3]) -> Option<Self> {
        let [x, y, z] = instance.position_m;
        let [length, width, height] = [0, 1, 2].map(|axis| size_m[axis] * instance.scale[axis]);
        let [low, high] = Self::HEIGHTS_M;
        let is_there = instance.visible && z < high && z + height > low;
        let [_, _, sin_half, cos_half] = instance.rotation;
        let axis = [cos_half * cos_half - sin_half * sin_half, 2.0 * sin_half * cos_half];
        is_there.then_some(Self { middle_m: [x, y], half_m: [length / 2.0, width / 2.0], axis })
    }

    fn holds(&self, [x, y]: [f32; 2]) -> bool {
        let (dx, dy) = (x - self.middle_m[0], y - self.middle_m[1]);
        let [cos, sin] = self.axis;
        (dx * cos + dy * sin).abs() < self.half_m[0] + CLEAR_OF_WALLS_M
            && (dy * cos - dx * sin).abs() < self.half_m[1] + CLEAR_OF_WALLS_M
    }
}

fn on_clear_floor(layout: &Layout, [x, y]: [f32; 2]) -> bool {
    let m = CLEAR_OF_WALLS_M;
    layout.rooms.iter().any(|room| {
        room.rects_m
            .iter()
            .any(|[west, south, east, north]| x > west + m && x < east - m && y > south + m && y < north - m)
    }) || layout.openings.iter().any(|opening| in_opening(opening, [x, y]))
}

fn in_opening(opening: &cohabit_cdf::layout::Opening, [x, y]: [f32; 2]) -> bool {
    use cohabit_cdf::{layout::OpeningKind, model::Axis};
    let (along, across) = match opening.wall_runs {
        Axis::X => (x - opening.at_m[0], y - opening.at_m[1]),
        _ => (y - opening.at_m[1], x - opening.at_m[0]),
    };
    opening.kind != OpeningKind::Window
        && along.abs() < opening.width_m / 2.0 - CLEAR_OF_WALLS_M
        && across.abs() <= CLEAR_OF_WALLS_M + 0.01
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_camera_keeps_off_what_is_at_its_height() {
        let at = |z: f32| Instance {
            id: 1,
            look: cohabit_render::Look::Object(cohabit_cdf::ClassId(0)),
            position_m: [2.0, 3.0, z],
            rotation: [0.0, 0.0, std::f32::consts::FRAC_1_SQRT_2, std::f32::consts::FRAC_1_SQRT_2],
            scale: [1.0; 3],
            flags: cohabit_cdf::StateFlags::default(),
            fluid: cohabit_cdf::Fluid::None,
            color: cohabit_cdf::Color::Original,
            opened: 0.0,
            running: 0.0,
            room: cohabit_cdf::RoomId::BREAK_ROOM,
            visible: true,
        };
        let cupboard = [0.4, 1.0, 0.7];
        assert!(Tall::of(&at(0.0), cupboard).is_none(), "it looks over a counter");
        let tall = Tall::of(&at(1.5), cupboard).unwrap();
        // Turned by 90 degrees, it is 1.0 m long from west to east.
        assert!(
            tall.holds([2.6, 3.0]) && tall.holds([2.0, 3.35]) && !tall.holds([2.0, 3.6]) && !tall.holds([2.8, 3.0])
        );
    }

    #[test]
    fn angles_wrap_to_the_short_way() {
        for (angle, wrapped) in [(0.1, 0.1), (6.2, 6.2 - std::f32::consts::TAU), (-6.2, std::f32::consts::TAU - 6.2)] {
            assert!((wrap(angle) - wrapped).abs() < 1e-5, "{angle}");
        }
    }
}

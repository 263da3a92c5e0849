//! Bodies: the robots (and avatars) that act in the world. Never knows where the others are.

use cohabit_cdf::{Action, BodyId, ObjectId, RoomId};
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, direction};

/// Radius of the cylinder that a body keeps free of everything, m.
pub(crate) const RADIUS_M: f32 = 0.25;
/// Height of the camera above the floor, m.
pub(crate) const EYE_HEIGHT_M: f32 = 1.3;
/// How far the camera is in front of the body's middle, m.
const EYE_FORWARD_M: f32 = 0.1;
/// Where the hand carries things: forward, left, up, m.
const HAND_M: Vec3 = Vec3::new(0.42, -0.16, 0.82);
/// How much further the hand is at full reach, m.
const REACH_FORWARD_M: f32 = 0.3;

/// One body.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Body {
    /// Its middle on the floor, m.
    pub position: Vec2,
    pub yaw_rad: f32,
    /// Positive is up.
    pub head_pitch_rad: f32,
    pub speed_m_s: f32,
    pub turn_rad_s: f32,
    /// How far the arm is stretched out, 0 to 1.
    pub arm: f32,
    pub held: Option<ObjectId>,
    pub room: RoomId,
    pub alive: bool,
    pub task: Option<Task>,
}

/// The command that a body is carrying out.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Task {
    pub command: u64,
    pub action: Action,
    /// What is left to do, the next one last.
    pub steps: Vec<Step>,
    /// Whether it goes elsewhere than asked.
    pub alternate: bool,
    /// Ticks that it has waited for the way to be free.
    pub waited: u32,
}

/// A part of carrying out a command.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Step {
    /// Along a path on the floor, from the point at `next` on.
    Walk { path: Vec<Vec2>, next: usize },
    /// Straight on or back, as far as is left, m.
    Drive { left_m: f32 },
    /// Turn by what is left, rad.
    Turn { left_rad: f32 },
    /// Turn body and head until they point there.
    Face { point: Vec3 },
    /// Turn until this heading is reached, looking level, rad.
    Head { yaw_rad: f32 },
    /// Pitch the head to this, rad.
    Pitch { to_rad: f32 },
    /// Stretch the arm out; the effect comes at full reach.
    Reach,
}

impl Body {
    /// A body that stands still.
    pub fn new(position: Vec2, yaw_rad: f32, room: RoomId) -> Self {
        Self {
            position,
            yaw_rad,
            head_pitch_rad: 0.0,
            speed_m_s: 0.0,
            turn_rad_s: 0.0,
            arm: 0.0,
            held: None,
            room,
            alive: true,
            task: None,
        }
    }

    /// Its camera's place, m.
    pub fn eye(&self) -> Vec3 {
        (self.position + direction(self.yaw_rad) * EYE_FORWARD_M).extend(EYE_HEIGHT_M)
    }

    /// The direction its camera looks in.
    pub fn gaze(&self) -> Vec3 {
        let level = libm::cosf(self.head_pitch_rad);
        (direction(self.yaw_rad) * level).extend(libm::sinf(self.head_pitch_rad))
    }

    /// Where what it holds is.
    pub fn hand(&self) -> Pose {
        let body = Pose::level(self.position.extend(0.0), self.yaw_rad);
        Pose { position: body.point(HAND_M + Vec3::X * (REACH_FORWARD_M * self.arm)), rotation: body.rotation }
    }

    /// Whether it carries out a command.
    pub fn busy(&self) -> bool {
        self.task.is_some()
    }
}

/// What everybody outside may know of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyView {
    /// Its index in the world.
    pub id: BodyId,
    /// Its middle on the floor, m.
    pub position_m: Vec3,
    /// Its heading, rad.
    pub yaw_rad: f32,
    /// The pitch of its head, rad, positive up.
    pub head_pitch_rad: f32,
    /// Where its camera is, m; it looks along yaw and pitch.
    pub eye: Vec3,
    /// What it holds.
    pub held: Option<ObjectId>,
    /// The room it is in.
    pub room: RoomId,
    /// How far its arm is stretched out, 0 to 1.
    pub arm: f32,
    /// Speed along its heading, m/s; negative is backwards.
    pub speed_m_s: f32,
    /// Whether it carries out a command.
    pub busy: bool,
    /// Which.
    pub command: Option<u64>,
    /// Whether it still can act.
    pub alive: bool,
}

impl BodyView {
    /// What may be known of `body`.
    pub(crate) fn of(id: BodyId, body: &Body) -> Self {
        Self {
            id,
            position_m: body.position.extend(0.0),
            yaw_rad: body.yaw_rad,
            head_pitch_rad: body.head_pitch_rad,
            eye: body.eye(),
            held: body.held,
            room: body.room,
            arm: body.arm,
            speed_m_s: body.speed_m_s,
            busy: body.busy(),
            command: body.task.as_ref().map(|task| task.command),
            alive: body.alive,
        }
    }
}

//! Bodies: the robots (and avatars) that act in the world. Never knows where the others are.

use cohabit_cdf::{Action, BodyId, BodyKind, ObjectId, RoomId, StateFlags};
use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, direction};

/// Radius of the widest body, m: the floor is worked out for it.
pub(crate) const RADIUS_M: f32 = 0.25;
/// How much further the hand is at full reach, m.
const REACH_FORWARD_M: f32 = 0.3;

/// How a kind of body is built, and how fast it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Figure {
    /// Radius of the cylinder that it keeps free of everything, m.
    pub radius_m: f32,
    /// Height of that cylinder, m.
    pub height_m: f32,
    /// Height of the camera above the floor, m.
    pub eye_height_m: f32,
    /// How far the camera is in front of the middle, m.
    eye_forward_m: f32,
    /// Where the hand carries things: forward, left, up, m.
    hand_m: Vec3,
    /// Walking speed, m/s.
    pub walk_m_s: f32,
    /// Turning speed, rad/s.
    pub turn_rad_s: f32,
}

/// How tall a robot is, m.
pub(crate) const ROBOT_HEIGHT_M: f32 = 1.4;

/// Walks like an unhurried person, turns 150 degrees a second.
const ROBOT: Figure = Figure {
    radius_m: RADIUS_M,
    height_m: ROBOT_HEIGHT_M,
    eye_height_m: 1.3,
    eye_forward_m: 0.1,
    hand_m: Vec3::new(0.42, -0.16, 0.82),
    walk_m_s: 1.4,
    turn_rad_s: 2.617_994,
};

/// A person of middle height; 1.3 m/s is an ordinary pace indoors.
const PERSON: Figure = Figure {
    radius_m: 0.22,
    height_m: 1.75,
    eye_height_m: 1.62,
    eye_forward_m: 0.08,
    hand_m: Vec3::new(0.4, -0.2, 1.0),
    walk_m_s: 1.3,
    turn_rad_s: 3.1,
};

impl Figure {
    /// The measures of a kind.
    fn of(kind: BodyKind) -> &'static Self {
        match kind {
            BodyKind::Robot => &ROBOT,
            BodyKind::Person => &PERSON,
        }
    }
}

/// One body.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Body {
    pub kind: BodyKind,
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
    /// States that it shows, such as its face.
    pub flags: StateFlags,
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
    /// How often it has changed its way.
    pub detours: u32,
    /// The tick before which it does not change its way for others again.
    pub settled_until: u64,
    /// The floor's version that its way was last checked against.
    pub floor_version: u64,
    /// What it is pushing along, which is not where the floor was last worked out with it.
    pub pushing: Vec<ObjectId>,
}

impl Task {
    /// What stands for a walk that nobody has asked for: a command of that kind takes no time, and is never a task.
    const UNASKED: Action = Action::Stop;

    /// A walk out of somebody's way.
    pub fn aside(path: Vec<Vec2>, floor_version: u64) -> Self {
        let steps = vec![Step::Walk { path, next: 0 }];
        Self::new(0, Self::UNASKED, steps, false, floor_version)
    }

    /// The command that it carries out, if it is one.
    pub fn command(&self) -> Option<u64> {
        (self.action != Self::UNASKED).then_some(self.command)
    }

    /// A task that is about to begin.
    pub fn new(command: u64, action: Action, steps: Vec<Step>, alternate: bool, floor_version: u64) -> Self {
        Self {
            command,
            action,
            steps,
            alternate,
            waited: 0,
            detours: 0,
            settled_until: 0,
            floor_version,
            pushing: Vec::new(),
        }
    }

    /// What is left of the way it is walking, if it is walking.
    pub fn way(&self) -> Option<&[Vec2]> {
        match self.steps.last() {
            Some(Step::Walk { path, next }) => Some(path.get(*next..).unwrap_or(&[])),
            _ => None,
        }
    }
}

/// A part of carrying out a command.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Step {
    /// Along a path on the floor, from the point at `next` on.
    Walk { path: Vec<Vec2>, next: usize },
    /// Straight on or back, as far as is left, m.
    Straight { left_m: f32 },
    /// Turn by what is left, rad.
    Turn { left_rad: f32 },
    /// Turn body and head until they point there.
    Face { point: Vec3 },
    /// Turn until this heading is reached, looking level, rad.
    Head { yaw_rad: f32 },
    /// Pitch the head to this, rad.
    Pitch { to_rad: f32 },
    /// Let another body pass, for as many ticks at most.
    Yield { to: BodyId, ticks_left: u32 },
    /// Stretch the arm out; the effect comes at full reach.
    Reach,
    /// As a person at the controls asks, for as many ticks at most; then to a halt.
    Drive { controls: Controls, ticks_left: u32 },
}

/// What a person at the controls asks of a body, within what it can do.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Controls {
    /// Along its heading; negative is backwards, m/s.
    pub forward_m_s: f32,
    /// Positive is to the left, rad/s.
    pub turn_rad_s: f32,
    /// Of the head; positive is up, rad/s.
    pub pitch_rad_s: f32,
}

impl Body {
    /// A body that stands still.
    pub fn new(kind: BodyKind, position: Vec2, yaw_rad: f32, room: RoomId) -> Self {
        Self {
            kind,
            position,
            yaw_rad,
            head_pitch_rad: 0.0,
            speed_m_s: 0.0,
            turn_rad_s: 0.0,
            arm: 0.0,
            held: None,
            room,
            alive: true,
            flags: StateFlags::default(),
            task: None,
        }
    }

    /// Its measures.
    pub fn figure(&self) -> &'static Figure {
        Figure::of(self.kind)
    }

    /// Its velocity, m/s.
    pub fn velocity(&self) -> Vec2 {
        direction(self.yaw_rad) * self.speed_m_s
    }

    /// Its camera's place, m.
    pub fn eye(&self) -> Vec3 {
        let figure = self.figure();
        (self.position + direction(self.yaw_rad) * figure.eye_forward_m).extend(figure.eye_height_m)
    }

    /// The direction its camera looks in.
    pub fn gaze(&self) -> Vec3 {
        let level = libm::cosf(self.head_pitch_rad);
        (direction(self.yaw_rad) * level).extend(libm::sinf(self.head_pitch_rad))
    }

    /// Where what it holds is.
    pub fn hand(&self) -> Pose {
        let body = Pose::level(self.position.extend(0.0), self.yaw_rad);
        Pose {
            position: body.point(self.figure().hand_m + Vec3::X * (REACH_FORWARD_M * self.arm)),
            rotation: body.rotation,
        }
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
    /// Robot or person.
    pub kind: BodyKind,
    /// Radius of the cylinder that it keeps free, m.
    pub radius_m: f32,
    /// Its height, m.
    pub height_m: f32,
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
    /// States that it shows, such as its face.
    pub flags: StateFlags,
}

impl BodyView {
    /// What may be known of `body`.
    pub(crate) fn of(id: BodyId, body: &Body) -> Self {
        Self {
            id,
            kind: body.kind,
            radius_m: body.figure().radius_m,
            height_m: body.figure().height_m,
            position_m: body.position.extend(0.0),
            yaw_rad: body.yaw_rad,
            head_pitch_rad: body.head_pitch_rad,
            eye: body.eye(),
            held: body.held,
            room: body.room,
            arm: body.arm,
            speed_m_s: body.speed_m_s,
            busy: body.busy(),
            command: body.task.as_ref().and_then(Task::command),
            alive: body.alive,
            flags: body.flags,
        }
    }
}

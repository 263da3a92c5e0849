//! The world as the renderer sees it.

use cohabit_bus::message::Thing;
use cohabit_cdf::{BodyId, BodyKind, Color, Fluid, RoomId, mission::Era};
use cohabit_render::{Highlight, Instance, Look};
use cohabit_world::{BodyView, DT_NANOS, World};

use crate::{
    engine::Engine,
    shot::{self, Outlook},
};

/// One moment of a world, complete enough to be rendered elsewhere.
#[derive(Clone, Debug, Default)]
pub struct Moment {
    /// The tick.
    pub tick: u64,
    /// The latest command that had begun to move its body.
    pub command: u64,
    /// When this was, ns of the monotonic clock.
    pub seen_nanos: u64,
    /// All that can be drawn, in a fixed order.
    pub instances: Vec<Instance>,
    /// What is pointed out.
    pub highlights: Vec<Highlight>,
    /// Whether the lights are on, a room each.
    pub lit: [bool; RoomId::ALL.len()],
    /// Where each body is, and where its eye.
    pub bodies: Vec<Standing>,
    /// What the mission shows to the people who watch, instead of their body.
    pub shot: Option<Outlook>,
}

/// Where a body stands and looks.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// On the floor, m.
    pub position_m: [f32; 3],
    /// Its eye, m.
    pub eye_m: [f32; 3],
    /// Heading, rad.
    pub yaw_rad: f32,
    /// Pitch of the head, rad.
    pub head_pitch_rad: f32,
}

/// The id of an object in the id plane.
pub const fn object_instance_id(object: cohabit_cdf::ObjectId) -> u32 {
    object.0 + 1
}

/// The id of a body in the id plane.
pub const fn body_instance_id(body: BodyId) -> u32 {
    Thing::FIRST_BODY + body.0
}

const HIGHLIGHT_COLOR: [u8; 3] = [255, 196, 61];

/// An unhurried pace, m/s: at this speed a person's legs swing fully.
const PACE_M_S: f32 = 1.3;

/// How a body looks at a tick. Its way so far is not known, so its legs and wheels keep step with the clock, and rest
/// while it stands.
fn look_of(body: &BodyView, tick: u64) -> Look {
    let pace = (body.speed_m_s / PACE_M_S).clamp(-1.0, 1.0);
    // Long enough to hide where it begins anew.
    let seconds = (tick % (3600 * 60)) as f32 * (DT_NANOS as f32 * 1e-9);
    let way_m = if pace == 0.0 { 0.0 } else { seconds * PACE_M_S.copysign(pace) };
    let (head_pitch_rad, arm, holds) = (body.head_pitch_rad, body.arm, body.held.is_some());
    match body.kind {
        BodyKind::Robot => Look::Robot { head_pitch_rad, arm, holds, rolled_m: way_m },
        BodyKind::Person => {
            Look::Person { outfit: body.id.0, head_pitch_rad, arm, holds, walked_m: way_m, pace: pace.abs() }
        }
    }
}

/// All objects of a world as they look now.
pub fn furnishings(world: &World) -> impl Iterator<Item = Instance> + '_ {
    world.objects().map(|object| Instance {
        id: object_instance_id(object.id),
        look: match object.leads_to {
            Some(era) => Look::Gate { class: object.class, future: era == Era::Future },
            None => Look::Object(object.class),
        },
        position_m: object.position_m.to_array(),
        rotation: object.rotation.to_array(),
        scale: object.scale,
        flags: object.flags,
        fluid: object.fluid,
        color: object.color,
        opened: object.opened,
        running: object.running,
        room: object.room,
        visible: !object.hidden,
    })
}

impl Moment {
    /// Captures an engine's world.
    pub fn capture(engine: &Engine, seen_nanos: u64) -> Self {
        let world = engine.world();
        let bodies = world.bodies().map(|body| Instance {
            id: body_instance_id(body.id),
            look: look_of(&body, world.tick()),
            position_m: body.position_m.to_array(),
            rotation: glam::Quat::from_rotation_z(body.yaw_rad).to_array(),
            scale: [1.0; 3],
            flags: body.flags,
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: body.room,
            visible: true,
        });
        Self {
            tick: world.tick(),
            command: engine.latest_started(),
            seen_nanos,
            instances: bodies.chain(furnishings(world)).collect(),
            highlights: engine
                .highlighted()
                .map(|object| Highlight { id: object_instance_id(object), color: HIGHLIGHT_COLOR })
                .collect(),
            lit: RoomId::ALL.map(|room| world.room_lit(room)),
            bodies: world
                .bodies()
                .map(|body| Standing {
                    position_m: body.position_m.to_array(),
                    eye_m: body.eye.to_array(),
                    yaw_rad: body.yaw_rad,
                    head_pitch_rad: body.head_pitch_rad,
                })
                .collect(),
            shot: engine.shown().and_then(|target| shot::outlook(target, world)),
        }
    }
}

//! The world as the renderer sees it.

use cohabit_bus::message::Thing;
use cohabit_cdf::{
    BodyId, BodyKind, Color, Fluid, RoomId, StateFlags,
    mission::Era,
    model::{Drive, Material},
};
use cohabit_render::{Highlight, Instance, Look};
use cohabit_world::{BodyView, ObjectView, World};
use glam::{Quat, Vec3};

use crate::{
    appearance::Visible,
    motion::{Gait, Motion, Pour},
    shot::{self, Outlook},
    standing::Standing,
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
    /// Whether the lights are on, for each room of the floor plan.
    pub lit: Vec<(RoomId, bool)>,
    /// Where each body is, and where its eye.
    pub bodies: Vec<Standing>,
    /// What the mission shows to the people who watch, instead of their body.
    pub shot: Option<Outlook>,
    /// How often the time had leapt before: a camera does not follow a body from one time to another.
    pub leaps: u64,
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

/// How a body looks that has moved like that; `arm` is how far its arm reaches.
fn look_of(body: &BodyView, gait: Gait, arm: f32) -> Look {
    let (head_pitch_rad, holds) = (body.head_pitch_rad, body.held.is_some());
    match body.kind {
        BodyKind::Robot => Look::Robot { head_pitch_rad, arm, holds, rolled_m: gait.way_m },
        BodyKind::Person => {
            let pace = (gait.pace_m_s / PACE_M_S).abs().min(1.0);
            Look::Person { outfit: body.id.0, head_pitch_rad, arm, holds, walked_m: gait.way_m, pace }
        }
    }
}

/// Whether what is in an object is seen though it is shut: its door or lid is clear.
fn has_clear_door(world: &World, object: &ObjectView<'_>) -> bool {
    let model = world.catalog().model(object.class);
    let opens = |name: &str| model.joints.iter().any(|joint| joint.id == name && joint.driven_by == Drive::Open);
    let mut parts = model.parts.iter().filter(|part| part.material == Material::Clear);
    parts.any(|part| part.joint.as_deref().is_some_and(opens))
}

/// Whether an object is drawn: also what lies hidden behind a clear door.
fn is_visible(world: &World, object: &ObjectView<'_>) -> bool {
    if !object.hidden {
        return true;
    }
    let parent = object.parent.filter(|_| world.exists(object.id)).and_then(|parent| world.object(parent));
    parent.is_some_and(|parent| (parent.hidden || has_clear_door(world, &parent)) && is_visible(world, &parent))
}

/// How far the stream begins above what it falls into, and how far from its middle what is poured from is held, m.
const FALL_M: f32 = 0.12;
const ASIDE_M: f32 = 0.07;
/// How far what is poured from is tilted, rad.
const TILT_RAD: f32 = 1.75;
/// How far into a thing a stream falls, as a share of its height.
const BOTTOM: f32 = 0.25;

/// The middle of the upper side of an object, m.
fn brim_m(world: &World, object: &ObjectView<'_>) -> Vec3 {
    let height_m = world.catalog().class(object.class).size_m[2] * object.scale[2];
    object.position_m + object.rotation * Vec3::Z * height_m
}

/// Lifts and tilts what is poured from, and adds what flows.
fn show_pour(world: &World, pour: &Pour, instances: &mut Vec<Instance>) {
    let (Some(into), Some(body)) = (world.object(pour.into), world.body(pour.body)) else { return };
    let brim = brim_m(world, &into);
    let tilt = pour.tilt(world.tick());
    let from = pour.from.and_then(|from| instances.iter_mut().find(|one| one.id == object_instance_id(from)));
    if let Some(from) = from {
        let away = (body.position_m - into.position_m).with_z(0.0).normalize_or(Vec3::X);
        let (held, over) = (Vec3::from_array(from.position_m), brim + away * ASIDE_M + Vec3::Z * FALL_M);
        let turn = Quat::from_axis_angle(Vec3::Z.cross(-away), TILT_RAD * tilt);
        from.position_m = held.lerp(over, tilt).to_array();
        from.rotation = (turn * Quat::from_array(from.rotation)).to_array();
    }
    if pour.flows(world.tick()) {
        let depth_m = (brim.z - into.position_m.z) * (1.0 - BOTTOM);
        instances.push(Instance {
            // A part of what it fills.
            id: object_instance_id(pour.into),
            look: Look::Stream { height_m: FALL_M + depth_m },
            position_m: (brim + Vec3::Z * FALL_M).to_array(),
            rotation: Quat::IDENTITY.to_array(),
            scale: [1.0; 3],
            flags: StateFlags::default(),
            fluid: pour.fluid,
            color: Color::Original,
            opened: 0.0,
            running: 1.0,
            room: into.room,
            visible: true,
        });
    }
}

/// How far a body's arm is stretched out: also while it pours, though its command is done.
fn arm_of(body: &BodyView, motion: &Motion, tick: u64) -> f32 {
    let pours = motion.pours().iter().filter(|pour| pour.body == body.id);
    pours.fold(body.arm, |arm, pour| arm.max(pour.tilt(tick)))
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
        visible: is_visible(world, &object),
    })
}

impl Moment {
    /// Captures a world.
    pub fn capture(visible: Visible<'_>, seen_nanos: u64) -> Self {
        let Visible { world, appearance } = visible;
        let motion = appearance.motion();
        let bodies = world.bodies().map(|body| Instance {
            id: body_instance_id(body.id),
            look: look_of(&body, motion.gait(body.id), arm_of(&body, motion, world.tick())),
            position_m: body.position_m.to_array(),
            rotation: Quat::from_rotation_z(body.yaw_rad).to_array(),
            scale: [1.0; 3],
            flags: body.flags,
            fluid: Fluid::None,
            color: Color::Original,
            opened: 0.0,
            running: 0.0,
            room: body.room,
            visible: true,
        });
        let mut instances: Vec<Instance> = bodies.chain(furnishings(world)).collect();
        for pour in motion.pours() {
            show_pour(world, pour, &mut instances);
        }
        Self {
            tick: world.tick(),
            command: appearance.latest_started(),
            seen_nanos,
            instances,
            highlights: appearance
                .highlighted()
                .map(|object| Highlight { id: object_instance_id(object), color: HIGHLIGHT_COLOR })
                .collect(),
            lit: world.lights().collect(),
            bodies: world
                .bodies()
                .map(|body| Standing {
                    position_m: body.position_m.to_array(),
                    eye_m: body.eye.to_array(),
                    yaw_rad: body.yaw_rad,
                    head_pitch_rad: body.head_pitch_rad,
                })
                .collect(),
            shot: appearance.shown(world.tick()).and_then(|target| shot::outlook(target, world)),
            leaps: 0,
        }
    }
}

#[cfg(test)]
mod tests;

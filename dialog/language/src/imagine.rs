//! What the robot expects of its own steps, so that the rest of a sentence is understood in the light of its beginning.

use cohabit_cdf::{Action, Fluid, GoToTarget, ObjectId, Verb, state::StateFlag};

use crate::{known::Known, process::Devices};

/// How far it stands from what it acts on, m.
const REACH_M: f32 = 0.8;

/// Changes `scene` as the action is expected to.
pub(crate) fn apply(scene: &mut Known, action: &Action, devices: &Devices) {
    match *action {
        Action::Move { distance_m } => {
            let (sin, cos) = scene.robot.yaw_rad.sin_cos();
            scene.robot.position_m[0] += distance_m * cos;
            scene.robot.position_m[1] += distance_m * sin;
        }
        Action::Rotate { yaw_rad } => scene.robot.yaw_rad += yaw_rad,
        Action::GoTo { target: GoToTarget::Object(object) } => walk(scene, object),
        Action::GoTo { target: GoToTarget::Room(room) | GoToTarget::Viewpoint(room, _) } => {
            if scene.robot.room != room {
                scene.robot.room = room;
                scene.objects.iter_mut().for_each(|object| object.visible = false);
            }
        }
        Action::PickUp { object } => {
            walk(scene, object);
            scene.robot.held = Some(object);
            if let Some(object) = scene.object_mut(object) {
                object.parent = None;
                object.flags.set(StateFlag::PickedUp, true);
            }
        }
        Action::Place { receptacle } => place(scene, receptacle),
        Action::Interact { verb, object } => {
            walk(scene, object);
            interact(scene, verb, object, devices);
        }
        Action::GoTo { .. }
        | Action::Look { .. }
        | Action::LookAround
        | Action::Highlight { .. }
        | Action::Stop
        | Action::Drive { .. } => {}
    }
}

/// Stands before the object, facing it from where it came.
fn walk(scene: &mut Known, object: ObjectId) {
    let Some(target) = scene.object(object) else { return };
    let distance = scene.distance_m(target);
    let (position, room) = (target.position_m, target.room);
    if distance > REACH_M {
        let keep = REACH_M / distance;
        scene.robot.yaw_rad += scene.object(object).map_or(0.0, |target| scene.bearing_rad(target));
        let [x, y, _] = &mut scene.robot.position_m;
        *x = position[0] + (*x - position[0]) * keep;
        *y = position[1] + (*y - position[1]) * keep;
    }
    scene.robot.room = room;
    carry(scene);
}

fn carry(scene: &mut Known) {
    let robot = scene.robot.clone();
    if let Some(object) = robot.held.and_then(|held| scene.object_mut(held)) {
        object.position_m = robot.position_m;
        object.room = robot.room;
    }
}

fn place(scene: &mut Known, receptacle: ObjectId) {
    walk(scene, receptacle);
    let position = scene.object(receptacle).map(|object| (object.position_m, object.room));
    let Some(held) = scene.robot.held.take() else { return };
    if let (Some(object), Some((position_m, room))) = (scene.object_mut(held), position) {
        object.parent = Some(receptacle);
        object.position_m = position_m;
        object.room = room;
        object.flags.set(StateFlag::PickedUp, false);
    }
}

fn interact(scene: &mut Known, verb: Verb, id: ObjectId, devices: &Devices) {
    let held = scene.robot.held;
    let held_fluid = held.and_then(|held| scene.object(held)).map(|object| object.fluid);
    let Some(object) = scene.object_mut(id) else { return };
    match verb {
        Verb::Open => object.flags.set(StateFlag::Opened, true),
        Verb::Close => object.flags.set(StateFlag::Opened, false),
        Verb::Break => object.flags.set(StateFlag::Broken, true),
        Verb::Scan => object.flags.set(StateFlag::Scanned, true),
        Verb::Examine => object.flags.set(StateFlag::Examined, true),
        Verb::Toggle => {
            let on = devices.stays_on(object.class) && !object.has(StateFlag::Toggled);
            object.flags.set(StateFlag::Toggled, on);
        }
        Verb::Pour => match held_fluid.unwrap_or_default() {
            Fluid::None => object.flags.set(StateFlag::Cereal, true),
            fluid => object.fluid = fluid,
        },
        Verb::Fill => {
            if let Some(object) = held.and_then(|held| scene.object_mut(held)) {
                object.fluid = cohabit_cdf::Fluid::Water;
            }
        }
        Verb::Clean => {
            if let Some(object) = held.and_then(|held| scene.object_mut(held)) {
                object.flags.set(StateFlag::Dirty, false);
            }
        }
        Verb::Throw => scene.robot.held = None,
    }
}

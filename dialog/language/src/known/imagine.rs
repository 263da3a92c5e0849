//! What the robot expects of its own steps, so that the rest of a sentence is understood in the light of its beginning: the table of
//! actions and devices says what they change, and only where the robot then stands is worked out here.

use cohabit_cdf::{Action, ActionKind, GoToTarget, ObjectId};

use crate::known::{Known, process::Devices, symbols};

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
        Action::PickUp { .. } | Action::Place { .. } | Action::Interact { .. } => {
            if let Some((kind, object)) = ActionKind::of(action) {
                walk(scene, object);
                symbols::act(scene, kind, object, &devices.catalog);
            }
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
    let (distance, bearing) = (scene.distance_m(target), scene.bearing_rad(target));
    let (position, room) = (target.position_m, target.room);
    if distance > REACH_M {
        let keep = REACH_M / distance;
        scene.robot.yaw_rad += bearing;
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

/// The object that an action is about.
pub(crate) const fn object_of(action: &Action) -> Option<ObjectId> {
    match *action {
        Action::PickUp { object } | Action::Interact { object, .. } | Action::Highlight { object } => Some(object),
        Action::Place { receptacle } => Some(receptacle),
        Action::GoTo { target: cohabit_cdf::GoToTarget::Object(object) } => Some(object),
        _ => None,
    }
}

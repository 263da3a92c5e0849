//! What the robot expects of its own steps, so that the rest of a sentence is understood in the light of its beginning: the table of
//! actions and devices says what they change, and only where the robot then stands is worked out here.

use cohabit_cdf::{Action, ActionKind, GoToTarget, ObjectId};

use crate::known::{Known, KnownObject, process::Devices, symbols};

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
        Action::PickUp { .. } | Action::Place { .. } | Action::PlaceBeside { .. } | Action::Interact { .. } => {
            if let Some((kind, object)) = ActionKind::of(action) {
                let held = scene.robot.held;
                walk(scene, object);
                symbols::act(scene, kind, object, &devices.catalog);
                stand_beside(scene, held, action);
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

/// What was put beside another thing is where that is, as near as can be told.
fn stand_beside(scene: &mut Known, put: Option<ObjectId>, action: &Action) {
    let beside = action.beside().and_then(|beside| scene.object(beside));
    let Some(position_m) = beside.map(|beside| beside.position_m) else { return };
    let is_put = |object: &&mut KnownObject| object.parent.is_some() && object.parent == action.receptacle();
    if let Some(object) = put.and_then(|put| scene.object_mut(put)).filter(is_put) {
        object.position_m = position_m;
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
        Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => Some(receptacle),
        Action::GoTo { target: cohabit_cdf::GoToTarget::Object(object) } => Some(object),
        _ => None,
    }
}

//! All that is true, as somebody would know it who is everywhere: questions are answered from it.

use std::f32::consts::FRAC_PI_4;

use cohabit_cdf::BodyId;
use cohabit_language::{Known, KnownObject, KnownRobot, within_half_turn};
use cohabit_world::{ObjectView, World};

/// What a body faces within this angle is in front of it, rad: as the oracle has it.
const AHEAD_RAD: f32 = FRAC_PI_4;

/// All there is, of which `body` is the robot; nothing, if there is no such body. What is in front of it in its room, and not in
/// something shut, is visible.
pub(crate) fn everything(world: &World, body: BodyId) -> Option<Known> {
    let view = world.body(body)?;
    let robot =
        KnownRobot { position_m: view.position_m.to_array(), yaw_rad: view.yaw_rad, room: view.room, held: view.held };
    let present = world.objects().filter(|object| world.exists(object.id));
    let objects = present.map(|object| known(&object, &robot)).collect();
    let rooms = world.layout().rooms.iter().map(|room| room.id).collect();
    Some(Known { rooms, ..Known::new(robot, objects) })
}

fn known(object: &ObjectView<'_>, robot: &KnownRobot) -> KnownObject {
    let position_m = object.position_m.to_array();
    let [x, y, z, w] = object.rotation.to_array();
    KnownObject {
        id: object.id,
        instance: object.instance.to_owned(),
        class: object.class,
        room: object.room,
        position_m,
        yaw_rad: (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
        flags: object.flags,
        fluid: object.fluid,
        color: object.color,
        parent: object.parent,
        text: object.text.to_owned(),
        visible: !object.hidden && object.room == robot.room && is_ahead(robot, position_m),
        is_hidden: object.hidden,
        works: object.works,
        in_mission: object.in_mission,
    }
}

fn is_ahead(robot: &KnownRobot, position_m: [f32; 3]) -> bool {
    let [dx, dy] = [0, 1].map(|axis| position_m[axis] - robot.position_m[axis]);
    within_half_turn(dy.atan2(dx) - robot.yaw_rad).abs() <= AHEAD_RAD
}

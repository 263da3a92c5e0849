//! What the robot knows, from the state as the simulator publishes it.

use cohabit_bus::message::{NONE, ObjectRecord, StateView};
use cohabit_cdf::{BodyId, ClassId, Color, Fluid, ObjectId, RoomId, state::StateFlags};
use cohabit_language::{Known, KnownGoal, KnownObject, KnownRobot};

/// Half the angle in which the robot sees what is in its room, rad.
const HALF_VIEW_RAD: f32 = 0.9;

/// What `body` knows; `None` if there is no such body.
pub fn known(state: StateView<'_>, body: BodyId) -> Option<Known> {
    let record = state.bodies.iter().find(|record| record.body == body.0)?;
    let robot = KnownRobot {
        position_m: record.position_m,
        yaw_rad: record.yaw_rad,
        room: RoomId::from_index(record.room)?,
        held: object_id(record.held),
    };
    let objects = state.objects.iter().filter_map(|object| known_object(state, &robot, object)).collect();
    let goals = state
        .goals
        .iter()
        .filter(|goal| goal.hidden == 0)
        .map(|goal| KnownGoal { text: goal.description.as_str().to_owned(), met: goal.met == 1 })
        .collect();
    Some(Known { robot, objects, goals })
}

fn object_id(index: u32) -> Option<ObjectId> {
    (index != NONE).then_some(ObjectId(index))
}

fn known_object(state: StateView<'_>, robot: &KnownRobot, object: &ObjectRecord) -> Option<KnownObject> {
    let room = RoomId::from_index(u32::from(object.room))?;
    let note = state.notes.iter().find(|note| note.object == object.object);
    Some(KnownObject {
        id: ObjectId(object.object),
        instance: object.instance.as_str().to_owned(),
        class: ClassId(object.class),
        room,
        position_m: object.position_m,
        flags: StateFlags(object.flags),
        fluid: Fluid::ALL.get(usize::from(object.fluid)).copied().unwrap_or_default(),
        color: Color::ALL.get(usize::from(object.color)).copied().unwrap_or_default(),
        parent: object_id(object.parent),
        text: note.map_or_else(String::new, |note| note.text.as_str().to_owned()),
        visible: object.hidden == 0 && room == robot.room && in_view(robot, object.position_m),
        works: object_id(object.works),
        in_mission: object.in_mission != 0,
    })
}

fn in_view(robot: &KnownRobot, position_m: [f32; 3]) -> bool {
    let [dx, dy] = [position_m[0] - robot.position_m[0], position_m[1] - robot.position_m[1]];
    let bearing = (dy.atan2(dx) - robot.yaw_rad).rem_euclid(std::f32::consts::TAU);
    bearing.min(std::f32::consts::TAU - bearing) < HALF_VIEW_RAD
}

//! A scene for tests: two mugs and a bowl in the break room, before a robot that looks along x.

use cohabit_cdf::{Catalog, ObjectId, RoomId};
use cohabit_language::{Known, KnownObject, KnownRobot};

/// The scene, of things of the built-in catalogue.
pub(crate) fn scene(catalog: &Catalog) -> Known {
    let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held: None };
    let instances = ["CoffeeMug_Boss_1", "CoffeeMug_Yellow_1", "Bowl_01_1"];
    let places_m = [[1.0, 0.0, 0.8], [2.0, 2.0, 0.8], [0.0, -3.0, 0.8]];
    let objects = (0..).zip(instances).zip(places_m);
    let objects = objects.map(|((id, instance), position_m)| object(catalog, id, instance, position_m));
    Known::new(robot, objects.collect())
}

fn object(catalog: &Catalog, id: u32, instance: &str, position_m: [f32; 3]) -> KnownObject {
    let class = catalog.class_of_instance(instance).unwrap();
    let object = KnownObject::new(ObjectId(id), instance.to_owned(), class, RoomId::BREAK_ROOM, position_m);
    KnownObject { visible: true, in_mission: true, ..object }
}

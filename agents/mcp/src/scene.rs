//! A scene for tests: two mugs and a bowl in the break room, before a robot that looks along x.

use cohabit_cdf::{Catalog, Color, Fluid, ObjectId, RoomId, StateFlags};
use cohabit_language::{Known, KnownObject, KnownRobot};

/// The scene, of things of the built-in catalogue.
pub(crate) fn scene(catalog: &Catalog) -> Known {
    let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held: None };
    let instances = ["CoffeeMug_Boss_1", "CoffeeMug_Yellow_1", "Bowl_01_1"];
    let places_m = [[1.0, 0.0, 0.8], [2.0, 2.0, 0.8], [0.0, -3.0, 0.8]];
    let objects = (0..).zip(instances).zip(places_m);
    let objects = objects.map(|((id, instance), position_m)| object(catalog, id, instance, position_m));
    Known {
        robot,
        objects: objects.collect(),
        mission: String::new(),
        goals: Vec::new(),
        rooms: Vec::new(),
        floor: None,
        person: None,
    }
}

fn object(catalog: &Catalog, id: u32, instance: &str, position_m: [f32; 3]) -> KnownObject {
    KnownObject {
        id: ObjectId(id),
        instance: instance.to_owned(),
        class: catalog.class_of_instance(instance).unwrap(),
        room: RoomId::BREAK_ROOM,
        position_m,
        yaw_rad: 0.0,
        flags: StateFlags::default(),
        fluid: Fluid::None,
        color: Color::Original,
        parent: None,
        text: String::new(),
        visible: true,
        is_hidden: false,
        works: None,
        in_mission: true,
    }
}

//! Office scenes: a built-in floor plan, with the things of a mission that nobody wrote.

use cohabit_cdf::{
    Catalog, Color, Fluid, Layout, ObjectId, Property, RoomId,
    state::{StateFlag, StateFlags},
};
use cohabit_language::{Known, KnownObject, KnownRobot, within_half_turn};

use crate::chance::Chance;

/// Things that missions bring.
const MISSION_OBJECTS: std::ops::Range<usize> = 3..12;
/// Half the angle in which the robot sees what is in its room, rad, as the dialog service has it.
const HALF_VIEW_RAD: f32 = 0.9;

/// Draws a scene on the floor plan `layout`.
pub fn draw(catalog: &Catalog, layout: &Layout, chance: &mut Chance) -> Known {
    let mut objects = KnownObject::furniture(catalog, layout);
    add_mission(catalog, &mut objects, chance);
    for object in &mut objects {
        draw_states(catalog, object, chance);
    }
    let viewpoint = chance.pick(&layout.viewpoints);
    let mut robot = KnownRobot {
        position_m: [viewpoint.at_m[0], viewpoint.at_m[1], 0.0],
        yaw_rad: chance.share() * std::f32::consts::TAU,
        room: viewpoint.room,
        held: None,
    };
    if chance.happens(0.25) {
        let carried: Vec<usize> =
            (0..objects.len()).filter(|at| objects[*at].in_mission && is_carried(catalog, &objects[*at])).collect();
        if !carried.is_empty() {
            let held = &mut objects[*chance.pick(&carried)];
            (held.room, held.position_m, held.parent) = (robot.room, robot.position_m, None);
            robot.held = Some(held.id);
        }
    }
    for object in &mut objects {
        let [dx, dy] = [object.position_m[0] - robot.position_m[0], object.position_m[1] - robot.position_m[1]];
        let bearing_rad = within_half_turn(dy.atan2(dx) - robot.yaw_rad);
        object.visible = object.room == robot.room && bearing_rad.abs() < HALF_VIEW_RAD;
    }
    Known::new(robot, objects)
}

fn is_carried(catalog: &Catalog, object: &KnownObject) -> bool {
    catalog.class(object.class).has(Property::Pickupable)
}

/// Puts things on and into the furniture, some of them twice, some painted; some furniture is the mission's own too.
fn add_mission(catalog: &Catalog, objects: &mut Vec<KnownObject>, chance: &mut Chance) {
    let takes = |object: &&KnownObject| {
        let class = catalog.class(object.class);
        class.receptacle.as_ref().is_some_and(|receptacle| receptacle.keys.is_empty())
            && !class.has(Property::Pickupable)
    };
    let places: Vec<(ObjectId, RoomId, [f32; 3])> =
        objects.iter().filter(takes).map(|object| (object.id, object.room, object.position_m)).collect();
    let classes: Vec<usize> =
        (0..catalog.classes().len()).filter(|at| catalog.classes()[*at].has(Property::Pickupable)).collect();
    let count = chance.within(MISSION_OBJECTS);
    while objects.iter().filter(|object| object.in_mission).count() < count {
        let class = cohabit_cdf::ClassId(*chance.pick(&classes) as u16);
        let copies = if chance.happens(0.3) { 2 } else { 1 };
        for copy in 0..copies {
            let (parent, room, at) = *chance.pick(&places);
            let id = ObjectId(objects.iter().map(|object| object.id.0 + 1).max().unwrap_or(0));
            let painted = chance.happens(if copies > 1 { 0.5 } else { 0.15 });
            objects.push(KnownObject {
                id,
                instance: format!("{}_{}", catalog.class(class).id, 1 + copy),
                class,
                room,
                position_m: [at[0] + chance.share() - 0.5, at[1] + chance.share() - 0.5, at[2] + 0.8],
                flags: StateFlags::default(),
                fluid: Fluid::None,
                color: if painted { *chance.pick(&Color::ALL) } else { Color::Original },
                parent: Some(parent),
                text: String::new(),
                visible: false,
                works: None,
                is_hidden: false,
                yaw_rad: 0.0,
                in_mission: true,
            });
        }
    }
    // Machines and furniture that the mission's goals are about.
    let named: Vec<usize> = (0..objects.len())
        .filter(|at| {
            let class = catalog.class(objects[*at].class);
            [Property::Toggleable, Property::Openable, Property::Receptacle].iter().any(|property| class.has(*property))
        })
        .collect();
    for _ in 0..chance.within(1..6) {
        objects[*chance.pick(&named)].in_mission = true;
    }
}

fn draw_states(catalog: &Catalog, object: &mut KnownObject, chance: &mut Chance) {
    let class = catalog.class(object.class);
    let states = [
        (Property::Openable, StateFlag::Opened, 0.25),
        (Property::Toggleable, StateFlag::Toggled, 0.2),
        (Property::Breakable, StateFlag::Broken, 0.1),
        (Property::Dirtyable, StateFlag::Dirty, 0.3),
    ];
    for (property, flag, share) in states {
        if class.has(property) && chance.happens(share) {
            object.flags.set(flag, true);
        }
    }
    if class.has(Property::Fillable) && class.has(Property::Pickupable) && chance.happens(0.25) {
        object.fluid = *chance.pick(&[Fluid::Water, Fluid::Milk, Fluid::Coffee]);
    }
}

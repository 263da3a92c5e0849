//! The built-in floor plans, with the whole catalogue's words: things are named by their class.

use std::sync::{Arc, OnceLock};

use cohabit_cdf::{Catalog, Color, Fluid, Layout, ObjectId, RoomId, state::StateFlags};
use cohabit_language::{Known, KnownObject, KnownRobot, Language};

/// `plan OfficeLayout2 Lab1; add Bowl_01 on TableRound_02; Bowl_01 broken`: that floor plan, all of which the robot knows,
/// as it stands at the first viewpoint of that room; `None` where the marks are of no floor plan.
pub fn talk(marks: &[&str]) -> Option<(&'static Language, Known)> {
    static LANGUAGE: OnceLock<Language> = OnceLock::new();
    let (plan, marks) = marks.split_first()?;
    let (layout, room) = plan.strip_prefix("plan ")?.split_once(' ')?;
    let language = LANGUAGE.get_or_init(|| super::language(Arc::new(Catalog::builtin())));
    let mut known = furnished(language.catalog(), layout, RoomId::new(room).unwrap());
    for mark in marks {
        match mark.split(' ').collect::<Vec<_>>().as_slice() {
            ["add", class, "in" | "on", parent] => add(language.catalog(), &mut known, class, parent),
            [class, states @ ..] => {
                let object = known.objects.iter_mut().rfind(|object| object.instance == *class);
                let object = object.unwrap_or_else(|| panic!("no {class}"));
                states.iter().for_each(|state| super::set(object, state));
            }
            [] => {}
        }
    }
    Some((language, known))
}

fn furnished(catalog: &Catalog, layout: &str, room: RoomId) -> Known {
    let layout = Layout::builtin(layout).unwrap();
    let mut objects = KnownObject::furniture(catalog, &layout);
    for object in &mut objects {
        object.instance.clone_from(&catalog.class(object.class).id);
        object.visible = object.room == room;
    }
    let viewpoint = layout.viewpoints.iter().find(|viewpoint| viewpoint.room == room).unwrap();
    let [x, y] = viewpoint.at_m;
    let robot = KnownRobot { position_m: [x, y, 0.0], yaw_rad: 0.0, room, held: None };
    Known { robot, objects, mission: String::new(), goals: Vec::new(), rooms: Vec::new(), floor: None, person: None }
}

/// Puts a thing of the mission on or in the nearest of `parent`.
fn add(catalog: &Catalog, known: &mut Known, class: &str, parent: &str) {
    let here = known.robot.position_m;
    let flat_m = |object: &&KnownObject| (object.position_m[0] - here[0]).hypot(object.position_m[1] - here[1]);
    let parents = known.objects.iter().filter(|object| object.instance == parent);
    let parent = parents.min_by(|a, b| flat_m(a).total_cmp(&flat_m(b))).unwrap_or_else(|| panic!("no {parent}"));
    let id = known.objects.iter().map(|object| object.id.0 + 1).max().unwrap_or(0);
    let [x, y, z] = parent.position_m;
    known.objects.push(KnownObject {
        id: ObjectId(id),
        instance: class.to_owned(),
        class: catalog.find(class).unwrap_or_else(|| panic!("no class {class}")),
        room: parent.room,
        position_m: [x, y, z + 0.8],
        yaw_rad: 0.0,
        flags: StateFlags::default(),
        fluid: Fluid::None,
        color: Color::Original,
        parent: Some(parent.id),
        text: String::new(),
        visible: parent.room == known.robot.room,
        is_hidden: false,
        works: None,
        in_mission: true,
    });
}

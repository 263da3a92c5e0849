//! The built-in floor plans and those of homes, with all words of their catalogues: things are named by their class.

use std::sync::{Arc, OnceLock};

use cohabit_cdf::{Catalog, Layout, ObjectId, RoomId, WorldData, WorldPack};
use cohabit_language::{Known, KnownObject, KnownRobot, Language};

/// `plan OfficeLayout2 Lab1; add Bowl_01 on TableRound_02; Bowl_01 broken`: that floor plan, all of which the robot knows,
/// as it stands at the first viewpoint of that room; `None` where the marks are of no floor plan.
pub fn talk(marks: &[&str]) -> Option<(&'static Language, Known)> {
    static OFFICES: OnceLock<Language> = OnceLock::new();
    static HOMES: OnceLock<Language> = OnceLock::new();
    let (plan, marks) = marks.split_first()?;
    let (layout, room) = plan.strip_prefix("plan ")?.split_once(' ')?;
    let is_office = Layout::builtin_ids().iter().any(|id| id == layout);
    let language = if is_office {
        OFFICES.get_or_init(|| super::language(Arc::new(Catalog::builtin())))
    } else {
        HOMES.get_or_init(|| super::language(homes()))
    };
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

fn homes() -> Arc<Catalog> {
    let pack = WorldPack::builtin("homes").unwrap();
    Arc::clone(WorldData::layered(vec![pack]).unwrap().catalog())
}

fn furnished(catalog: &Catalog, layout: &str, room: RoomId) -> Known {
    let layout = Layout::find(layout, catalog).unwrap();
    let mut objects = KnownObject::furniture(catalog, &layout);
    for object in &mut objects {
        object.instance.clone_from(&catalog.class(object.class).id);
        object.visible = object.room == room;
    }
    let viewpoint = layout.viewpoints.iter().find(|viewpoint| viewpoint.room == room).unwrap();
    let [x, y] = viewpoint.at_m;
    let robot = KnownRobot { position_m: [x, y, 0.0], yaw_rad: 0.0, room, held: None };
    let mut known = Known::new(robot, objects);
    if !Layout::builtin_ids().contains(&layout.id) {
        known.rooms = layout.rooms.iter().map(|room| room.id).collect();
    }
    known
}

/// Puts a thing of the mission on or in the nearest of `parent`.
fn add(catalog: &Catalog, known: &mut Known, class: &str, parent: &str) {
    let here = known.robot.position_m;
    let flat_m = |object: &&KnownObject| (object.position_m[0] - here[0]).hypot(object.position_m[1] - here[1]);
    let parents = known.objects.iter().filter(|object| object.instance == parent);
    let parent = parents.min_by(|a, b| flat_m(a).total_cmp(&flat_m(b))).unwrap_or_else(|| panic!("no {parent}"));
    let id = known.objects.iter().map(|object| object.id.0 + 1).max().unwrap_or(0);
    let [x, y, z] = parent.position_m;
    let kind = catalog.find(class).unwrap_or_else(|| panic!("no class {class}"));
    let mut object = KnownObject::new(ObjectId(id), class.to_owned(), kind, parent.room, [x, y, z + 0.8]);
    let class = catalog.class(kind);
    (object.flags, object.fluid) = (class.states_as_built(), class.fluid_as_built());
    let (parent, visible) = (Some(parent.id), parent.room == known.robot.room);
    known.objects.push(KnownObject { parent, visible, in_mission: true, ..object });
}

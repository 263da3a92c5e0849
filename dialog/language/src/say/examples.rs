//! What can be said to the robot, by examples of what is around it.

use cohabit_cdf::{Catalog, Property};

use crate::known::{Known, KnownObject, describe};

/// Things that are named as an example where none is seen.
const THING: &str = "the mug";

/// One or two of them, where a reply has something else to say first.
pub(crate) fn hint(catalog: &Catalog, scene: &Known) -> String {
    let trip = trip(catalog, scene).map(|trip| format!("\"{trip}\" or ")).unwrap_or_default();
    let thing = thing(catalog, scene);
    format!("You can tell me, for example, {trip}\"pick up {thing}\", or ask \"what can you do?\"")
}

/// What it can do.
pub(crate) fn abilities(catalog: &Catalog, scene: &Known) -> String {
    let trip = trip(catalog, scene).map(|trip| format!("\"{trip}\", ")).unwrap_or_default();
    let thing = thing(catalog, scene);
    format!(
        "I can go to rooms and objects, pick things up and put them down, open, close, switch, fill, pour, clean, break, scan, heat, cool, \
         repair and color things. For example: {trip}\"pick up {thing}\", \"heat the mug in the microwave\", \
         \"where is the milk?\". Say \"stop\" to stop me."
    )
}

/// Another room to go to.
fn trip(catalog: &Catalog, scene: &Known) -> Option<String> {
    let here = scene.robot.room.name_in(catalog);
    scene.room_names(catalog).find(|name| *name != here).map(|name| format!("go to the {}", name.to_lowercase()))
}

/// The nearest thing in sight that can be picked up.
fn thing(catalog: &Catalog, scene: &Known) -> String {
    let is_carried = |object: &&KnownObject| object.visible && catalog.class(object.class).has(Property::Pickupable);
    let carried = scene.objects.iter().filter(is_carried);
    let nearest = carried.min_by(|one, other| scene.distance_m(one).total_cmp(&scene.distance_m(other)));
    nearest.map_or_else(|| THING.to_owned(), |object| describe::short(catalog, scene, object.id))
}

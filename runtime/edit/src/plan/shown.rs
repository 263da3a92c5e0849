//! A floor plan as the page draws it, and what the page offers for it.

use cohabit_cdf::{
    Catalog, Layout,
    catalog::Stands,
    layout::{LayoutFault, OpeningKind, Placement},
    model::{Axis, Material},
    world_pack::PlanDraft,
};
use serde_json::{Value, json};

use super::geometry::corners_m;

/// What floors and walls are of.
const MATERIALS: [Material; 9] = [
    Material::Plain,
    Material::Wood,
    Material::Tile,
    Material::Carpet,
    Material::Brick,
    Material::Metal,
    Material::Paper,
    Material::Fabric,
    Material::Ceramic,
];

/// All that there is in a plan, and what is wrong with it.
pub fn plan(draft: &PlanDraft, catalog: &Catalog) -> Value {
    let errors = draft.errors.iter().map(|error| json!({ "message": error.to_string() }));
    let faults = draft.faults.iter().map(fault);
    json!({
        "layout": draft.layout.as_ref().map(|layout| drawn(layout, catalog)),
        "faults": errors.chain(faults).collect::<Vec<_>>(),
        "is_drawn": draft.layout.is_some() && draft.errors.is_empty(),
    })
}

fn drawn(layout: &Layout, catalog: &Catalog) -> Value {
    let rooms = layout.rooms.iter().map(|room| {
        json!({
            "id": room.id,
            "name": room.id.name_in(catalog),
            "rects_m": room.rects_m,
            "floor": room.floor,
            "wall": room.wall,
        })
    });
    let openings = layout.openings.iter().map(|opening| {
        let kind = match opening.kind {
            OpeningKind::Door => "door",
            OpeningKind::Passage => "passage",
            OpeningKind::Window => "window",
        };
        json!({
            "kind": kind,
            "between": opening.between,
            "at_m": opening.at_m,
            "width_m": opening.width_m,
            "runs": if opening.wall_runs == Axis::X { "x" } else { "y" },
        })
    });
    let things = layout.placements.iter().filter(|placement| !layout.is_door(placement));
    let bounds_m = if layout.rooms.is_empty() { [0.0, 0.0, 10.0, 8.0] } else { layout.bounds_m() };
    json!({
        "wall_height_m": layout.wall_height_m,
        "bounds_m": bounds_m,
        "rooms": rooms.collect::<Vec<_>>(),
        "openings": openings.collect::<Vec<_>>(),
        "things": things.map(|placement| thing(layout, placement, catalog)).collect::<Vec<_>>(),
        "views": layout.viewpoints.iter().map(|view| json!(view)).collect::<Vec<_>>(),
        "notes": layout.note_places.iter().map(|note| json!(note)).collect::<Vec<_>>(),
    })
}

fn thing(layout: &Layout, placement: &Placement, catalog: &Catalog) -> Value {
    let class = catalog.class_of_instance(&placement.instance).map(|class| catalog.class(class));
    let [x, y, z] = layout.origin_in_world_m(placement);
    let corners = class.map(|class| corners_m(class, placement.scale, [x, y], placement.yaw_deg));
    json!({
        "instance": placement.instance,
        "name": class.map(|class| &class.name),
        "room": placement.room,
        "at_m": placement.at_m,
        "world_m": [x, y, z],
        "yaw_deg": placement.yaw_deg,
        "on": placement.on,
        "anchor": placement.anchor,
        "corners_m": corners,
        "height_m": class.map(|class| class.size_m[2] * placement.scale[2]),
    })
}

/// Something wrong, with its remedy and its place: the objects, the room or the point that it is about.
fn fault(fault: &LayoutFault) -> Value {
    let (mut things, mut room, mut at_m): (Vec<&str>, _, Option<[f32; 2]>) = (Vec::new(), None, None);
    match fault {
        LayoutFault::UnknownClass { instance, .. }
        | LayoutFault::Repeated { instance }
        | LayoutFault::OutsideRoom { instance, .. }
        | LayoutFault::Unreachable { instance }
        | LayoutFault::Crowded { instance, .. } => things.push(instance),
        LayoutFault::Overlap { instance, other } | LayoutFault::LooseLink { instance, other, .. } => {
            things.extend([instance.as_str(), other.as_str()]);
        }
        LayoutFault::BlocksOpening { instance, at_m: at, .. } => {
            things.push(instance);
            at_m = Some(*at);
        }
        LayoutFault::OpeningOffWall { at_m: at, .. } => at_m = Some(*at),
        LayoutFault::Viewpoint { room: own, at_m: at, .. } => (room, at_m) = (Some(*own), Some(*at)),
        LayoutFault::NoteOffWall { room: own, at_m: [x, y, _] } => (room, at_m) = (Some(*own), Some([*x, *y])),
        LayoutFault::NoRoom { room: own, .. }
        | LayoutFault::OutOfReach { room: own, .. }
        | LayoutFault::NoViewpoint { room: own, .. }
        | LayoutFault::NotePlaces { room: own, .. } => room = Some(*own),
    }
    let is_lack = matches!(fault, LayoutFault::NoViewpoint { .. } | LayoutFault::NotePlaces { .. });
    json!({
        "message": fault.to_string(),
        "remedy": fault.remedy(),
        "things": things,
        "room": room,
        "at_m": at_m,
        // What `complete` mends.
        "is_lack": is_lack,
    })
}

/// What can be put into plans: rooms, classes of objects, surfaces.
pub fn choices(catalog: &Catalog) -> Value {
    let rooms = catalog.rooms().all().iter().map(|room| json!({ "id": room.id, "name": room.name }));
    let classes = catalog.classes().iter().filter(|class| class.id != "Door_01").map(|class| {
        let stands = match class.stands {
            Stands::OnSurface => "surface",
            Stands::OnFloor => "floor",
            Stands::OnWall => "wall",
        };
        json!({ "id": class.id, "name": class.name, "stands": stands })
    });
    json!({
        "rooms": rooms.collect::<Vec<_>>(),
        "classes": classes.collect::<Vec<_>>(),
        "materials": MATERIALS,
    })
}

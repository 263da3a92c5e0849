//! What vending machines sell, by what is in their slots behind the glass: which button brings what out.

use cohabit_cdf::{
    Catalog,
    table::{Change, Work},
};

use crate::known::{Known, KnownObject};

/// What the button of a vending machine brings out.
pub(crate) fn brought_out<'k>(catalog: &Catalog, scene: &'k Known, button: &KnownObject) -> Option<&'k KnownObject> {
    let machine = scene.object(button.works?)?;
    let slot = slot_of_button(catalog, button)?;
    scene.contents(machine.id).find(|thing| slot_of(catalog, machine, thing) == Some(slot))
}

/// The button that brings a thing out, if it stands in a slot.
pub(crate) fn button_for<'k>(catalog: &Catalog, scene: &'k Known, thing: &KnownObject) -> Option<&'k KnownObject> {
    let machine = scene.object(thing.parent?)?;
    let slot = slot_of(catalog, machine, thing)?;
    let mut buttons = scene.objects.iter().filter(|button| button.works == Some(machine.id));
    buttons.find(|button| slot_of_button(catalog, button) == Some(slot))
}

/// The slot that a button empties.
fn slot_of_button(catalog: &Catalog, button: &KnownObject) -> Option<usize> {
    let table = catalog.table();
    let work = table.work(table.device(&catalog.class(button.class).id).work.as_deref()?)?;
    Work::changes(work).find_map(|change| match change {
        Change::Vend(_, slot) => Some(usize::from(*slot)),
        _ => None,
    })
}

/// The slot in which a thing stands: the anchors of the machine's last surface are slots, in their order. The tray lies lower.
fn slot_of(catalog: &Catalog, machine: &KnownObject, thing: &KnownObject) -> Option<usize> {
    let class = catalog.class(machine.class);
    let surfaces = class.receptacle.as_ref().map_or(&[][..], |receptacle| receptacle.surfaces.as_slice());
    let [trays @ .., slots] = surfaces else { return None };
    if trays.is_empty() || !catalog.table().device(&class.id).slots {
        return None;
    }
    let [x, y, z] = local_m(machine, thing.position_m);
    let is_in_tray = trays.iter().any(|tray| (z - tray.center_m[2]).abs() <= (z - slots.center_m[2]).abs());
    let along = |axis: usize, at: f32| {
        let count = slots.anchors[axis] as f32;
        let share = (at - slots.center_m[axis]) / slots.size_m[axis] + 0.5;
        (share * count).floor().clamp(0.0, count - 1.0) as usize
    };
    (!is_in_tray).then(|| along(0, x) * slots.anchors[1] as usize + along(1, y))
}

/// A place in the frame of a machine.
fn local_m(machine: &KnownObject, [x, y, z]: [f32; 3]) -> [f32; 3] {
    let [from_x, from_y, from_z] = machine.position_m;
    let (sin, cos) = machine.yaw_rad.sin_cos();
    let (x, y) = (x - from_x, y - from_y);
    [cos * x + sin * y, cos * y - sin * x, z - from_z]
}

//! What can be done with a kind of thing, by its properties and by the table of actions.

use cohabit_cdf::{ClassId, Property};

use crate::known::{
    describe,
    process::{Act, Devices, Process},
};

/// What can be done with a thing of this class, besides carrying it: `open it`, `put things in it`; `it` stands for the thing.
pub(crate) fn afforded(devices: &Devices, class: ClassId, it: &str) -> Vec<String> {
    let kind = devices.catalog.class(class);
    let is_carried = kind.has(Property::Pickupable);
    let inside = describe::inside(&devices.catalog, class);
    let by_property = [
        (kind.has(Property::Openable), format!("open {it}")),
        (kind.has(Property::Toggleable), format!("turn {it} on and off")),
        (kind.has(Property::Fillable), format!("fill {it}")),
        (is_carried && kind.has(Property::Heatable), format!("heat {it}")),
        (is_carried && kind.has(Property::Chillable), format!("cool {it}")),
        (is_carried && kind.has(Property::Dirtyable), format!("wash {it}")),
        (kind.has(Property::Cuttable), format!("cut {it}")),
        (kind.receptacle.is_some(), format!("put things {inside} {it}")),
    ];
    let mut afforded: Vec<String> = by_property.into_iter().filter_map(|(is_so, what)| is_so.then_some(what)).collect();
    for what in by_hand(devices, class).map(|process| format!("{} {it}", process.intent.verb())) {
        if !afforded.contains(&what) {
            afforded.push(what);
        }
    }
    afforded
}

/// What a hand or a tool does to things of this class in particular: a plant is watered, a shirt is ironed.
fn by_hand(devices: &Devices, class: ClassId) -> impl Iterator<Item = &Process> {
    let is_done = |process: &&Process| process.steps.iter().any(|act| matches!(act, Act::Do(_)));
    devices.processes.iter().filter(move |process| process.of.contains(&class)).filter(is_done)
}

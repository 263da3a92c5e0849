//! Circuits: which are fed, what hangs on them, and what follows when one is cut or fed again.

use cohabit_cdf::{Catalog, ObjectId, Property, RoomId, StateFlag};

use crate::{entity::Object, facts::Facts, state::State};

const PUDDLE: &str = "WaterPuddle_01";

/// Whether `circuit` is fed; no circuit never is, one that nobody switches always.
pub(crate) fn is_fed(state: &State, circuit: Option<i32>) -> bool {
    circuit.is_some_and(|circuit| state.circuits.get(&circuit).copied().unwrap_or(true))
}

/// Cuts or feeds a circuit; returns what changed by it.
///
/// What sparks stops as the power goes, and machines stop; what is overloaded works again as the power comes back.
pub(crate) fn feed(catalog: &Catalog, state: &mut State, circuit: i32, fed: bool) -> Vec<ObjectId> {
    state.circuits.insert(circuit, fed);
    let on_circuit: Vec<ObjectId> =
        state.existing().filter(|(_, object)| object.circuit == Some(circuit)).map(|(id, _)| id).collect();
    let mut changed = Vec::new();
    for id in on_circuit {
        let object = state.at_mut(id);
        let class = catalog.class(object.class);
        let before = object.flags;
        if class.has(Property::Powerable) {
            object.flags.set(StateFlag::Powered, fed);
            if fed {
                object.flags.set(StateFlag::Overloaded, false);
            } else if !catalog.table().device(&class.id).stays_without_power {
                // Some switches stay where they were put; everything else goes off, and stays off.
                object.flags.set(StateFlag::Toggled, false);
                object.run = None;
            }
        }
        if !fed {
            object.flags.set(StateFlag::Sparking, false);
        }
        if object.flags != before {
            changed.push(id);
        }
    }
    changed
}

/// Whether the lights of a room are on: its circuit is fed, and a switch in it is on if it has any.
pub(crate) fn is_lit(facts: &Facts<'_>, room: RoomId, circuit: Option<i32>) -> bool {
    let mut switches = facts.of_class_in("LightSwitch_01", room).peekable();
    let switched = switches.peek().is_none() || switches.any(|id| facts.is(id, StateFlag::Toggled));
    switched && is_fed(facts.state, circuit)
}

/// Whether it needs power and has none.
pub(crate) fn lacks_power(facts: &Facts<'_>, id: ObjectId) -> bool {
    facts.has(id, Property::Powerable) && !facts.is(id, StateFlag::Powered)
}

/// What lies on the floor and kills who steps on it: what throws sparks, and the puddles that this touches.
pub(crate) fn live_on_floor(facts: &Facts<'_>) -> Vec<ObjectId> {
    let on_floor = |object: &Object| object.pose.position.z < 0.1 && object.parent().is_none();
    let sparking = facts.state.existing().filter(|(_, object)| object.flags.has(StateFlag::Sparking));
    let mut live: Vec<ObjectId> = sparking.filter(|(_, object)| on_floor(object)).map(|(id, _)| id).collect();
    if live.is_empty() {
        return live;
    }
    let puddles = facts.state.existing().map(|(id, _)| id).filter(|id| facts.class(*id).id == PUDDLE);
    let conducts = |puddle: &ObjectId| {
        let print = facts.footprint(*puddle);
        !live.contains(puddle) && live.iter().any(|id| facts.footprint(*id).overlaps(&print))
    };
    let conducting: Vec<ObjectId> = puddles.filter(conducts).collect();
    live.extend(conducting);
    live
}

//! Circuits: which are fed, what hangs on them, and what follows when one is cut or fed again.

use cohabit_cdf::{ObjectId, Property, RoomId, StateFlag};

use crate::{facts::Facts, state::State};

/// Whether `circuit` is fed; no circuit never is, one that nobody switches always.
pub(crate) fn is_fed(state: &State, circuit: Option<i32>) -> bool {
    circuit.is_some_and(|circuit| state.circuits.get(&circuit).copied().unwrap_or(true))
}

/// Cuts or feeds a circuit; returns what changed by it.
///
/// What sparks stops as the power goes; what is overloaded works again as it comes back.
pub(crate) fn feed(
    facts_of: impl Fn(&State, ObjectId) -> bool,
    state: &mut State,
    circuit: i32,
    fed: bool,
) -> Vec<ObjectId> {
    state.circuits.insert(circuit, fed);
    let on_circuit: Vec<ObjectId> = state
        .existing()
        .filter(|(id, object)| object.circuit == Some(circuit) && facts_of(state, *id))
        .map(|(id, _)| id)
        .collect();
    for id in &on_circuit {
        let object = state.at_mut(*id);
        object.flags.set(StateFlag::Powered, fed);
        if fed {
            object.flags.set(StateFlag::Overloaded, false);
        } else {
            object.flags.set(StateFlag::Sparking, false);
            object.run = None;
        }
    }
    on_circuit
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

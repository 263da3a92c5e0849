//! What devices that are more than a change of states do: the lab's machines, portals, vending machines.

pub(crate) mod lab;
pub(crate) mod portal;
mod recipes;
pub(crate) mod vending;

use cohabit_cdf::{ClassId, ObjectId};

pub(crate) use self::vending::{behind_glass, is_slot, vended};
use crate::facts::Facts;

/// The first free instance id of a class.
fn free_instance(facts: &Facts<'_>, class: &str) -> String {
    numbered(facts, class)
}

/// The id of the next thing of a class that a machine makes.
fn product_instance(facts: &Facts<'_>, machine: ObjectId, class: ClassId) -> String {
    numbered(facts, &format!("{}_Spawned_{}", facts.object(machine).instance, facts.catalog.class(class).id))
}

/// `stem_1`, or the next number that nothing ever had.
pub(crate) fn numbered(facts: &Facts<'_>, stem: &str) -> String {
    (1_u32..)
        .map(|number| format!("{stem}_{number}"))
        .find(|instance| !facts.state.objects.iter().any(|object| object.is_called(instance)))
        .expect("invariant: fewer objects than numbers")
}

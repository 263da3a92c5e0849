//! Which classes of the catalogue are placed at random, and where things are put away.

use cohabit_cdf::{ObjectClass, Property};

/// Whether people carry it about and have a name for it.
#[must_use]
pub fn is_thing(class: &ObjectClass) -> bool {
    class.has(Property::Pickupable) && !class.name.is_empty()
}

/// What is left of another thing is called like it: nobody sends for it.
pub(crate) fn is_debris(class: &ObjectClass) -> bool {
    ["Broken", "Crushed", "Toast_", "Slice", "Lid"].iter().any(|part| class.id.contains(part))
}

/// Whether it opens, and takes whatever fits behind its door, lid or front.
#[must_use]
pub fn is_container(class: &ObjectClass) -> bool {
    let is_enclosed = class.receptacle.as_ref().is_some_and(|place| place.enclosed && place.keys.is_empty());
    is_enclosed && class.has(Property::Openable)
}

//! Lists of things, as they are told: what is in a cupboard, what the robot sees.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, ObjectId, Property};

use crate::{
    describe,
    known::{Known, KnownObject},
};

/// How many things a list names before it says `and more`.
pub(crate) const LIST: usize = 8;
/// So many more are named, too, where that is all.
const LIST_TO_END: usize = 5;

/// `a cup, two plates and 3 more`, without the first so many, which were told before.
pub(crate) fn listed(catalog: &Catalog, scene: &Known, objects: &[&KnownObject], told: usize) -> String {
    // By name, how many there are, and whether people carry them about: such come first.
    let mut counts: BTreeMap<String, (bool, usize)> = BTreeMap::new();
    for object in objects {
        let (is_carried, count) = counts.entry(describe::bare(catalog, scene, object.id)).or_default();
        *is_carried |= catalog.class(object.class).has(Property::Pickupable);
        *count += 1;
    }
    let mut counts: Vec<(String, (bool, usize))> = counts.into_iter().collect();
    counts.sort_by_key(|(_, (is_carried, _))| !is_carried);
    let left = counts.len().saturating_sub(told);
    let most = if left <= LIST + LIST_TO_END { left } else { LIST };
    let named = counts.iter().skip(told).take(most).map(|(name, (_, count))| describe::counted(name, *count));
    let more = (left > most).then(|| format!("{} more", left - most));
    let names: Vec<String> = named.chain(more).collect();
    if names.is_empty() { "nothing else".to_owned() } else { describe::list(&names, "and") }
}

/// `in the fridge there are a milk and an apple`; nothing, where nothing is known to be there.
pub(crate) fn inside(catalog: &Catalog, scene: &Known, id: ObjectId, told: usize) -> Option<String> {
    let inside: Vec<&KnownObject> = scene.contents(id).collect();
    if inside.is_empty() {
        return None;
    }
    let verb = if inside.len() > 1 { "are" } else { "is" };
    let (preposition, place) = (describe::preposition(catalog, scene, id), describe::short(catalog, scene, id));
    Some(format!("{preposition} {place} there {verb} {}", listed(catalog, scene, &inside, told)))
}

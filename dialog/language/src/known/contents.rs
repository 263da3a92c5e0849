//! Lists of things, as they are told: what is in a cupboard, what the robot sees.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, ObjectId, Property, state::StateFlag};

use crate::{
    known::{Known, KnownObject, describe, floor},
    words::prose,
};

/// How many things a list names before it says `and more`.
pub(crate) const LIST: usize = 8;
/// Of what is in a room, how many things that stand there are named before such as can be carried, and at most how many of these before
/// the rest of the others.
const FIRST_OF_EACH: usize = 4;
/// Where no more than so many kinds of things are of use in a room, the others are told, too.
const LITTLE: usize = 3;
/// How a list of what is in a room ends where there is more.
const ASK_FOR_MORE: &str = "more: ask me what else";
/// So many more are named, too, where that is all.
const LIST_TO_END: usize = 5;

/// What is left to name where all was told.
const NOTHING_ELSE: &str = "nothing else";

/// How far from a thing's rim something is still under it or behind it, m.
const BESIDE_M: f32 = 0.2;

/// What cereal is poured out of, without an end.
pub(crate) const CEREAL_BOX: &str = "Cereal_Box_01";

/// Whether there is cereal in it.
pub(crate) fn has_cereal(catalog: &Catalog, object: &KnownObject) -> bool {
    object.has(StateFlag::Cereal) || catalog.class(object.class).id == CEREAL_BOX
}

/// `is` or `are`, after `there` and before a list of so many things.
pub(crate) fn verb(count: usize, listed: &str) -> &'static str {
    if count > 1 && listed != NOTHING_ELSE { "are" } else { "is" }
}

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
    // The list before this one went on to its end where little was left.
    let told = if told > 0 && counts.len() <= told + LIST_TO_END { counts.len() } else { told };
    let left = counts.len().saturating_sub(told);
    let most = if left <= LIST + LIST_TO_END { left } else { LIST };
    let named = counts.iter().skip(told).take(most).map(|(name, (_, count))| prose::counted(name, *count));
    let more = (left > most).then(|| format!("{} more", left - most));
    let names: Vec<String> = named.chain(more).collect();
    if names.is_empty() { NOTHING_ELSE.to_owned() } else { prose::list(&names, "and") }
}

/// What stands in a room is of use by any of these.
const OF_USE: [Property; 5] =
    [Property::Receptacle, Property::Openable, Property::Toggleable, Property::Powerable, Property::Usable];

/// What people ask for of what is in a room.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Interest {
    /// Furniture and machines that can be used.
    Furniture,
    /// What can be carried, or read.
    Carried,
    /// Buttons, and decoration that affords nothing.
    Little,
}

fn interest(catalog: &Catalog, object: &KnownObject) -> Interest {
    let class = catalog.class(object.class);
    let is_part =
        object.works.is_some() && ![Property::Receptacle, Property::Powerable].iter().any(|one| class.has(*one));
    if class.has(Property::Pickupable) || !object.text.is_empty() {
        Interest::Carried
    } else if is_part || !OF_USE.iter().any(|one| class.has(*one)) {
        Interest::Little
    } else {
        Interest::Furniture
    }
}

/// What is in a room, without the first so many that were told before: the largest of what stands there and what can be carried first, and
/// what hardly anybody asks for once all else was told.
pub(crate) fn of_room(catalog: &Catalog, scene: &Known, objects: &[&KnownObject], told: usize) -> String {
    // By name: the most that people ask of one so called, how large it is, and how many there are.
    let mut kinds: BTreeMap<String, (Interest, f32, usize)> = BTreeMap::new();
    for object in objects {
        let size_m = catalog.class(object.class).size_m.into_iter().fold(0.0, f32::max);
        let of = interest(catalog, object);
        let name = describe::bare(catalog, scene, object.id);
        let (interest, largest_m, count) = kinds.entry(name).or_insert((of, size_m, 0));
        (*interest, *largest_m, *count) = (of.min(*interest), size_m.max(*largest_m), *count + 1);
    }
    let of = |wanted: Interest| {
        let mut found: Vec<(f32, String)> = (kinds.iter().filter(|(_, (interest, ..))| *interest == wanted))
            .map(|(name, (_, size_m, count))| (*size_m, prose::counted(name, *count)))
            .collect();
        found.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        found.into_iter().map(|(_, name)| name).collect::<Vec<String>>()
    };
    let (mut names, mut carried, little) = (of(Interest::Furniture), of(Interest::Carried), of(Interest::Little));
    let mut rest = names.split_off(FIRST_OF_EACH.min(names.len()));
    let last = carried.split_off(FIRST_OF_EACH.min(carried.len()));
    names.append(&mut carried);
    names.append(&mut rest);
    names.extend(last);
    if names.len() <= LITTLE {
        names.extend(little);
        return page(&names, told);
    }
    let all_told = LIST * pages(names.len());
    match told.checked_sub(all_told) {
        Some(told) => page(&little, told),
        None => page(&names, told),
    }
}

/// In how many answers so many names are told.
const fn pages(count: usize) -> usize {
    if count <= LIST + LIST_TO_END { 1 } else { 1 + pages(count - LIST) }
}

/// The names of one answer, behind the first so many.
fn page(names: &[String], told: usize) -> String {
    let left = if told < LIST * pages(names.len()) { &names[told.min(names.len())..] } else { &[] };
    let most = if left.len() <= LIST + LIST_TO_END { left.len() } else { LIST };
    let more = (left.len() > most).then(|| ASK_FOR_MORE.to_owned());
    let named: Vec<String> = left[..most].iter().cloned().chain(more).collect();
    if named.is_empty() { NOTHING_ELSE.to_owned() } else { prose::list(&named, "and") }
}

/// `under the desk there is a golf ball`: what stands on the floor where this thing does; nothing, where nothing is known to.
pub(crate) fn under(catalog: &Catalog, scene: &Known, id: ObjectId) -> Option<String> {
    let thing = scene.object(id)?;
    let [width, _, depth] = catalog.class(thing.class).size_m;
    let reach_m = 0.5 * width.max(depth) + BESIDE_M;
    let is_there = |other: &&KnownObject| {
        other.id != id
            && scene.robot.held != Some(other.id)
            && other.room == thing.room
            && other.parent.is_none()
            && thing.parent != Some(other.id)
            && catalog.class(other.class).size_m.into_iter().fold(0.0, f32::max) < reach_m
            && floor::distance_m(thing.position_m, other.position_m) < reach_m
    };
    let there: Vec<&KnownObject> = scene.objects.iter().filter(is_there).collect();
    let verb = if there.len() > 1 { "are" } else { "is" };
    let place = describe::short(catalog, scene, id);
    (!there.is_empty()).then(|| format!("on the floor by {place} there {verb} {}", listed(catalog, scene, &there, 0)))
}

/// `in the fridge there are a milk and an apple`; nothing, where nothing is known to be there.
pub(crate) fn inside(catalog: &Catalog, scene: &Known, id: ObjectId, told: usize) -> Option<String> {
    let inside: Vec<&KnownObject> = scene.contents(id).collect();
    if inside.is_empty() {
        return None;
    }
    let listed = listed(catalog, scene, &inside, told);
    let verb = verb(inside.len(), &listed);
    let (preposition, place) = (describe::preposition(catalog, scene, id), describe::short(catalog, scene, id));
    Some(format!("{preposition} {place} there {verb} {listed}"))
}

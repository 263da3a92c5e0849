//! How the robot speaks of objects and places.

use cohabit_cdf::{
    Catalog, ClassId, ClassNames, Color, Fluid, ObjectId, Property,
    state::{StateFlag, StateFlags},
};

use crate::{
    known::{Known, KnownObject, floor::distance_m, vending},
    read::phrase::Phrase,
};

/// States worth saying when they tell two objects apart.
const TELLING: [(StateFlag, &str, &str); 9] = [
    (StateFlag::Broken, "broken", "whole"),
    (StateFlag::Dirty, "dirty", "clean"),
    (StateFlag::Embiggenated, "large", "small"),
    (StateFlag::Hot, "hot", "cool"),
    (StateFlag::Cold, "cold", "warm"),
    (StateFlag::Opened, "open", "closed"),
    (StateFlag::Wet, "wet", "dry"),
    (StateFlag::Creased, "creased", "smooth"),
    (StateFlag::Folded, "folded", "unfolded"),
];

/// States by which people see a difference before anybody says anything.
const VISIBLE: [StateFlag; 7] = [
    StateFlag::Broken,
    StateFlag::Dirty,
    StateFlag::Embiggenated,
    StateFlag::Cereal,
    StateFlag::Wet,
    StateFlag::Creased,
    StateFlag::Folded,
];

/// How large something is at least by which a place is told, and how near it is to that, m.
const LANDMARK_M: f32 = 0.4;
const NEAR_M: f32 = 2.5;

/// The plain name of a class.
pub(crate) fn name(catalog: &Catalog, class: ClassId) -> String {
    catalog.names(class).plain.clone()
}

/// The colour an object is called by.
pub(crate) fn color(catalog: &Catalog, object: &KnownObject) -> String {
    match object.color {
        Color::Original => catalog.class(object.class).color.to_lowercase(),
        color => color.name().to_lowercase(),
    }
}

/// Whether two objects look the same to people.
pub(crate) fn look_alike(catalog: &Catalog, one: &KnownObject, other: &KnownObject) -> bool {
    let visible = |flags: StateFlags| VISIBLE.map(|flag| flags.has(flag));
    catalog.names(one.class).plain == catalog.names(other.class).plain
        && color(catalog, one) == color(catalog, other)
        && visible(one.flags) == visible(other.flags)
        && one.fluid == other.fluid
        && !told_by_words(catalog, one.class, other.class)
}

/// Whether a word of either class says which it is, as `red computer` and `blue computer` do.
fn told_by_words(catalog: &Catalog, one: ClassId, other: ClassId) -> bool {
    one != other && catalog.names(one).special != catalog.names(other).special
}

/// `the mug`, or `the red mug` where there is another colour of it.
pub(crate) fn short(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    format!("the {}", bare(catalog, scene, id))
}

/// The same without an article.
pub(crate) fn bare(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    let Some(object) = scene.object(id) else { return "thing".to_owned() };
    let ClassNames { plain, special } = catalog.names(object.class);
    let rivals = || scene.objects.iter().filter(|other| other.id != id && catalog.names(other.class).plain == *plain);
    let is_told_by_words = rivals().any(|other| told_by_words(catalog, object.class, other.class));
    if let Some(special) = special.as_ref().filter(|_| is_told_by_words) {
        return special.clone();
    }
    let color_of = color(catalog, object);
    let has_color = !color_of.is_empty() && !plain.contains(&color_of);
    if has_color && rivals().any(|other| color(catalog, other) != color_of) {
        return format!("{color_of} {plain}");
    }
    plain.clone()
}

/// `in the fridge`, `on the green desk in the main office`, or nothing for what stands on the floor here.
pub(crate) fn location(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    let Some(object) = scene.object(id) else { return String::new() };
    if scene.robot.held == Some(id) {
        return "in my hand".to_owned();
    }
    let mut parts = Vec::new();
    if let Some(parent) = object.parent.and_then(|parent| scene.object(parent)) {
        // What cannot be carried stands on a cupboard, not in it.
        let is_fixed = !catalog.class(object.class).has(Property::Pickupable) && parent.id != id;
        let is_part = catalog.class(parent.class).receptacle.as_ref().is_some_and(|place| !place.keys.is_empty());
        let preposition = if is_fixed && !is_part { "on" } else { inside(catalog, parent.class) };
        parts.push(format!("{preposition} {}", told(catalog, scene, parent.id)));
    }
    if object.room != scene.robot.room {
        parts.push(format!("in the {}", object.room.name_in(catalog)));
    }
    parts.join(" ")
}

/// `the table next to the printer`, where several in its room are called alike; else `the table`.
pub(crate) fn told(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    let the = short(catalog, scene, id);
    let Some(object) = scene.object(id) else { return the };
    match landmark(catalog, scene, object).filter(|_| !is_only_one(catalog, scene, object)) {
        Some(landmark) => format!("{the} next to {}", short(catalog, scene, landmark)),
        None => the,
    }
}

/// Whether nothing else in its room is called as it is.
fn is_only_one(catalog: &Catalog, scene: &Known, object: &KnownObject) -> bool {
    let plain = &catalog.names(object.class).plain;
    let is_other = |other: &&KnownObject| {
        other.id != object.id && other.room == object.room && catalog.names(other.class).plain == *plain
    };
    let mut others = scene.objects.iter().filter(is_other).peekable();
    others.peek().is_none() || {
        let bare_name = bare(catalog, scene, object.id);
        others.all(|other| bare(catalog, scene, other.id) != bare_name)
    }
}

/// What stands nearest to a thing and is easy to see: large, fixed, and the only one called so in its room.
fn landmark(catalog: &Catalog, scene: &Known, object: &KnownObject) -> Option<ObjectId> {
    let distance = |other: &KnownObject| distance_m(object.position_m, other.position_m);
    let is_seen = |other: &KnownObject| {
        let class = catalog.class(other.class);
        let is_fixed = ![Property::Pickupable, Property::Decor].into_iter().any(|property| class.has(property));
        is_fixed && class.size_m.into_iter().fold(0.0, f32::max) >= LANDMARK_M
    };
    let mut near: Vec<&KnownObject> = scene
        .objects
        .iter()
        .filter(|other| other.id != object.id && other.room == object.room && other.parent.is_none() && is_seen(other))
        .filter(|other| {
            distance(other) <= NEAR_M && catalog.names(other.class).plain != catalog.names(object.class).plain
        })
        .collect();
    near.sort_by(|one, other| distance(one).total_cmp(&distance(other)));
    near.into_iter().find(|other| is_only_one(catalog, scene, other)).map(|other| other.id)
}

/// What it looks like, in a word or two: `broken red`.
pub(crate) fn look(catalog: &Catalog, object: &KnownObject) -> String {
    let states = TELLING.iter().take(3).filter(|(flag, ..)| object.has(*flag)).map(|(_, yes, _)| (*yes).to_owned());
    let words: Vec<String> = states.chain([color(catalog, object)]).filter(|word| !word.is_empty()).collect();
    words.join(" ")
}

/// Where it is, in a few words that hold wherever the robot stands: its room, or in this room what it is on.
pub(crate) fn place(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    let Some(object) = scene.object(id) else { return String::new() };
    if object.room == scene.robot.room {
        location(catalog, scene, id)
    } else {
        format!("in the {}", object.room.name_in(catalog))
    }
}

/// Whether things are in it or on it.
pub(crate) fn inside(catalog: &Catalog, class: ClassId) -> &'static str {
    let class = catalog.class(class);
    if class.has(Property::Fillable) && !class.has(Property::Receptacle) {
        return "in";
    }
    let is_enclosed =
        class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed || !receptacle.keys.is_empty());
    let is_hollow = ["Box", "Sink", "Toaster", "Machine", "Maker", "Trash", "Jar", "Printer"]
        .iter()
        .any(|word| class.name.contains(word));
    if is_enclosed || is_hollow { "in" } else { "on" }
}

/// How what a thing carries lies: in it or on it.
pub(crate) fn preposition(catalog: &Catalog, scene: &Known, id: ObjectId) -> &'static str {
    scene.object(id).map_or("on", |object| inside(catalog, object.class))
}

/// `the milk in the fridge`.
pub(crate) fn full(catalog: &Catalog, scene: &Known, id: ObjectId) -> String {
    let location = location(catalog, scene, id);
    let short = short(catalog, scene, id);
    if location.is_empty() { short } else { format!("{short} {location}") }
}

/// A description of each candidate that tells it from the others.
pub(crate) fn apart(catalog: &Catalog, scene: &Known, candidates: &[ObjectId]) -> Vec<String> {
    let objects: Vec<&KnownObject> = candidates.iter().filter_map(|id| scene.object(*id)).collect();
    objects
        .iter()
        .map(|object| {
            let mut adjectives = Vec::new();
            for (flag, yes, no) in TELLING {
                if objects.iter().any(|other| other.has(flag) != object.has(flag)) {
                    adjectives.push(if object.has(flag) { yes } else { no });
                }
            }
            let place = location(catalog, scene, object.id);
            let fluid =
                if objects.iter().any(|other| other.fluid != object.fluid) { contents(object.fluid) } else { "" };
            // Buttons look alike, and people want what comes out.
            let brings = vending::brought_out(catalog, scene, object);
            let brings = brings.map(|thing| format!("for the {}", bare(catalog, scene, thing.id))).unwrap_or_default();
            let name = bare(catalog, scene, object.id);
            let text = format!("the {} {name} {brings} {fluid} {place}", adjectives.join(" "));
            text.split_whitespace().collect::<Vec<_>>().join(" ")
        })
        .collect()
}

/// The same, of things that are not as `phrase` says: by what they differ in from that.
pub(crate) fn apart_from(catalog: &Catalog, scene: &Known, candidates: &[ObjectId], phrase: &Phrase) -> Vec<String> {
    let named = apart(catalog, scene, candidates);
    named
        .into_iter()
        .zip(candidates.iter().filter_map(|id| scene.object(*id)))
        .map(|(name, object)| {
            let color_of = color(catalog, object);
            let is_colored = phrase.color.is_some() && !color_of.is_empty() && !name.contains(&color_of);
            let name = match name.strip_prefix("the ").filter(|_| is_colored) {
                Some(bare) => format!("the {color_of} {bare}"),
                None => name,
            };
            let room = object.room.name_in(catalog);
            if is_same(&name, &phrase.text) { format!("{name} here in the {room}") } else { name }
        })
        .collect()
}

/// Whether a name says nothing that `said` does not say.
pub(crate) fn is_same(name: &str, said: &str) -> bool {
    let has = |word: &str| word == "the" || said.split(' ').any(|one| one == word);
    name.split(' ').all(has)
}

const fn contents(fluid: Fluid) -> &'static str {
    match fluid {
        Fluid::None => "that is empty",
        Fluid::Water => "with water",
        Fluid::Milk => "with milk",
        Fluid::Coffee => "with coffee",
    }
}

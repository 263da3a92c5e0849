//! How the robot speaks of objects and places.

use cohabit_cdf::{
    Catalog, ClassId, ClassNames, Color, Fluid, ObjectId, Property,
    state::{StateFlag, StateFlags},
};

use crate::{
    known::{Known, KnownObject},
    phrase::Phrase,
    token::NUMBERS,
};

/// States worth saying when they tell two objects apart.
const TELLING: [(StateFlag, &str, &str); 6] = [
    (StateFlag::Broken, "broken", "whole"),
    (StateFlag::Dirty, "dirty", "clean"),
    (StateFlag::Embiggenated, "large", "small"),
    (StateFlag::Hot, "hot", "cool"),
    (StateFlag::Cold, "cold", "warm"),
    (StateFlag::Opened, "open", "closed"),
];

/// States by which people see a difference before anybody says anything.
const VISIBLE: [StateFlag; 4] = [StateFlag::Broken, StateFlag::Dirty, StateFlag::Embiggenated, StateFlag::Cereal];

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
        parts.push(format!("{preposition} {}", short(catalog, scene, parent.id)));
    }
    if object.room != scene.robot.room {
        parts.push(format!("in the {}", object.room.name_in(catalog)));
    }
    parts.join(" ")
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
            let text = format!("the {} {} {fluid} {place}", adjectives.join(" "), bare(catalog, scene, object.id));
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

/// Whether a name is of several things: `the glass doors`, not `the stack of papers`.
fn is_plural(name: &str) -> bool {
    let head = name.split(" of ").next().unwrap_or(name);
    head.ends_with('s') && !head.ends_with("ss")
}

/// What an answer says beside its yes or no, as a sentence.
pub(crate) fn without_yes(text: &str) -> String {
    sentence(text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, ")).unwrap_or(text))
}

/// `is` or `are`, after a name.
pub(crate) fn is(name: &str) -> &'static str {
    if is_plural(name) { "are" } else { "is" }
}

/// `was` or `were`, after a name.
pub(crate) fn was(name: &str) -> &'static str {
    if is_plural(name) { "were" } else { "was" }
}

/// What stands for a name: `it` or `them`.
pub(crate) fn it(name: &str) -> &'static str {
    if is_plural(name) { "them" } else { "it" }
}

/// `a, b and c`; `last` is the word before the last one.
pub(crate) fn list(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [head @ .., tail] => format!("{} {last} {tail}", head.join(", ")),
    }
}

/// Nouns that take no article.
const MASS: [&str; 8] = ["milk", "bread", "coffee", "water", "cereal", "toast", "jelly", "peanut butter"];

/// A noun with its indefinite article, or `some` where it takes none.
pub(crate) fn indefinite(noun: &str) -> String {
    // `milk from the fridge`
    let is_joint = |word: &&str| ["of", "from", "in", "on", "with", "by", "at", "next", "that"].contains(word);
    let head = noun.split(' ').take_while(|word| !is_joint(word)).collect::<Vec<_>>().join(" ");
    let is_plural = head.ends_with('s') && !head.ends_with("ss");
    if is_plural
        || MASS.iter().any(|mass| head.strip_suffix(mass).is_some_and(|rest| rest.is_empty() || rest.ends_with(' ')))
    {
        return format!("some {noun}");
    }
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

/// So many of a noun, in words: `an apple`, `two apples`.
pub(crate) fn counted(noun: &str, count: usize) -> String {
    if count < 2 {
        return indefinite(noun);
    }
    let number = NUMBERS.get(count).map_or_else(|| count.to_string(), |number| (*number).to_owned());
    if MASS.contains(&noun) {
        return format!("{number} times {noun}");
    }
    format!("{number} {}", plural(noun))
}

/// Several of a noun.
pub(crate) fn plural(noun: &str) -> String {
    const VOWEL_Y: [&str; 4] = ["ay", "ey", "oy", "uy"];
    const HISSING: [&str; 5] = ["ss", "x", "z", "ch", "sh"];
    let ends = |endings: &[&str]| endings.iter().any(|ending| noun.ends_with(ending));
    if let Some(stem) = noun.strip_suffix("fe").or_else(|| noun.strip_suffix('f').filter(|_| ends(&["lf"]))) {
        return format!("{stem}ves");
    }
    if let Some(stem) = noun.strip_suffix('y').filter(|_| !ends(&VOWEL_Y)) {
        return format!("{stem}ies");
    }
    match noun {
        _ if ends(&HISSING) => format!("{noun}es"),
        _ if noun.ends_with('s') => noun.to_owned(),
        _ => format!("{noun}s"),
    }
}

/// The text with a capital letter at its start and a full stop at its end.
pub(crate) fn sentence(text: &str) -> String {
    let text = text.trim();
    let mut characters = text.chars();
    let Some(first) = characters.next() else { return String::new() };
    let ending = if text.trim_end_matches('"').ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{}{}{ending}", first.to_uppercase(), characters.as_str())
}

/// A sentence as the rest of another one: with a small letter at its start, unless that begins `I`.
pub(crate) fn within_sentence(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) if !text.starts_with("I ") => first.to_lowercase().chain(characters).collect(),
        _ => text.to_owned(),
    }
}

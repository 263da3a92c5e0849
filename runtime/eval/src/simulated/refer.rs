//! How people name a thing that they see: by its noun, and what tells it from others of that name.

use cohabit_cdf::{Catalog, Color, ObjectId, RoomId};
use cohabit_generate::Chance;
use cohabit_language::{Known, KnownObject};

use super::Style;

/// Colours that are said by mistake.
const COLORS: [&str; 5] = ["red", "green", "blue", "yellow", "white"];

/// What may be said of a thing beside its noun.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Quality {
    Color,
    Place,
    Room,
}

/// `the red mug on the desk in the main office`: as much of it as is needed, or less, or wrong.
pub(super) fn describe(id: ObjectId, truth: &Known, catalog: &Catalog, style: Style, chance: &mut Chance) -> String {
    let Some(object) = truth.object(id) else { return "it".to_owned() };
    let noun = noun(object, catalog, chance);
    let qualities = if chance.is(style.vagueness) { Vec::new() } else { telling(object, truth, catalog) };
    let mistaken = qualities.first().filter(|_| chance.is(style.mistakes)).copied();
    let mut text = vec!["the".to_owned()];
    if qualities.contains(&Quality::Color) {
        let right = color(object, catalog);
        let wrong = COLORS.iter().find(|one| **one != right).map_or(right.clone(), |one| (*one).to_owned());
        text.push(if mistaken == Some(Quality::Color) { wrong } else { right });
    }
    text.push(noun);
    if let Some(parent) =
        object.parent.and_then(|parent| truth.object(parent)).filter(|_| qualities.contains(&Quality::Place))
    {
        let encloses = catalog.class(parent.class).receptacle.as_ref().is_some_and(|place| place.enclosed);
        let name = self::noun(parent, catalog, &mut chance.clone());
        text.push(format!("{} the {name}", if encloses { "in" } else { "on" }));
    }
    if qualities.contains(&Quality::Room) {
        let mut rooms: Vec<RoomId> = truth.objects.iter().map(|other| other.room).collect();
        rooms.sort();
        let other = rooms.into_iter().find(|room| *room != object.room).unwrap_or(object.room);
        let room = if mistaken == Some(Quality::Room) { other } else { object.room };
        text.push(format!("in the {}", room.name_in(catalog)));
    }
    text.join(" ")
}

/// What tells it from the others of its name, as little as will do.
fn telling(object: &KnownObject, truth: &Known, catalog: &Catalog) -> Vec<Quality> {
    let name = |object: &KnownObject| catalog.class(object.class).name.to_lowercase();
    let mut rivals: Vec<&KnownObject> =
        truth.objects.iter().filter(|other| other.id != object.id && name(other) == name(object)).collect();
    let mut qualities = Vec::new();
    for quality in [Quality::Color, Quality::Place, Quality::Room] {
        let before = rivals.len();
        let is_same = |other: &&KnownObject| match quality {
            Quality::Color => color(other, catalog) == color(object, catalog),
            Quality::Place => place(other, truth, catalog) == place(object, truth, catalog),
            Quality::Room => other.room == object.room,
        };
        let left: Vec<&KnownObject> = rivals.iter().copied().filter(|other| is_same(other)).collect();
        let can_be_said = quality != Quality::Place || object.parent.is_some();
        if left.len() < before && can_be_said {
            qualities.push(quality);
            rivals = left;
        }
    }
    qualities
}

fn place(object: &KnownObject, truth: &Known, catalog: &Catalog) -> Option<String> {
    object.parent.and_then(|parent| truth.object(parent)).map(|parent| catalog.class(parent.class).name.to_lowercase())
}

fn noun(object: &KnownObject, catalog: &Catalog, chance: &mut Chance) -> String {
    let class = catalog.class(object.class);
    let name = class.name.to_lowercase();
    match chance.pick(&class.words).filter(|_| chance.clone().is(0.3)) {
        Some(word) => word.clone(),
        None => name,
    }
}

fn color(object: &KnownObject, catalog: &Catalog) -> String {
    match object.color {
        Color::Original => catalog.class(object.class).color.to_lowercase(),
        color => color.name().to_lowercase(),
    }
}

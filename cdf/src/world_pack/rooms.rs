//! The rooms that packs declare: each has an id and a name of its own, and floor plans have no others.

use std::collections::BTreeSet;

use super::PackError;
use crate::{
    layout::Layout,
    room::{MOST_ROOMS, RoomEntry, RoomId, Rooms},
};

/// What a pack says of rooms can be said and drawn.
pub(super) fn check(file: &str, rooms: &[RoomEntry]) -> Vec<PackError> {
    let mut errors = Vec::new();
    for (index, room) in rooms.iter().enumerate() {
        for words in room.names().chain(room.kind.iter().map(String::as_str)).filter(|words| !is_said(words)) {
            let reason = format!("`{words}` is no name of a room");
            let remedy = "write small letters, digits and spaces, 64 bytes at most";
            errors.push(PackError::at(file, &format!("room[{index}]"), reason, remedy));
        }
        if let Some(color) = room.color.as_deref().filter(|color| !is_color(color)) {
            let reason = format!("`{color}` is no colour");
            errors.push(PackError::at(file, &format!("room[{index}].color"), reason, "write it as #rrggbb"));
        }
    }
    errors
}

fn is_said(words: &str) -> bool {
    let fits = words.chars().all(|c| c.is_lowercase() || c.is_ascii_digit() || matches!(c, ' ' | '\''));
    fits && !words.trim().is_empty() && words.len() <= 64
}

/// Whether it is written as `#rrggbb`.
pub(super) fn is_color(text: &str) -> bool {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    digits.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

/// Adds the rooms that a pack declares to those there are.
pub(super) fn add(file: &str, rooms: &mut Rooms, own: &[RoomEntry]) -> Vec<PackError> {
    let mut errors = Vec::new();
    for (index, room) in own.iter().enumerate() {
        let fault = |at: &str, reason: String, remedy: &str| {
            PackError::at(file, &format!("room[{index}].{at}"), reason, remedy)
        };
        let others = || rooms.all().iter().filter(|other| other.id != room.id);
        let (id, name) = (room.id, &room.name);
        if let Some(other) = others().find(|other| other.id.id().eq_ignore_ascii_case(id.id())) {
            let reason = format!("`{id}` and the room `{}` differ in capital letters alone", other.id);
            errors.push(fault("id", reason, "give it another id"));
        }
        if let Some(other) = others().find(|other| other.name == *name) {
            let reason = format!("the room `{}` is called `{name}` too", other.id);
            errors.push(fault("name", reason, "give it another name"));
        }
        rooms.add(room.clone());
        if rooms.all().len() > MOST_ROOMS {
            let remedy = format!("at most {MOST_ROOMS} in a world, with the {} built-in ones", RoomId::BUILTIN.len());
            errors.push(fault("id", format!("`{id}` is one room too many"), &remedy));
            return errors;
        }
    }
    errors.extend(words_of_two(file, rooms, own));
    errors
}

/// Words of a pack's rooms that another room has. A room's name may be a word of another one: it is then meant by its name.
fn words_of_two(file: &str, rooms: &Rooms, own: &[RoomEntry]) -> Vec<PackError> {
    let mut errors = Vec::new();
    for (index, room) in own.iter().enumerate() {
        for word in &room.words {
            let is_same = |other: &str| is_same_word(word, other);
            let is_called_so = |other: &&RoomEntry| {
                let is_later = own[index + 1..].iter().any(|later| later.id == other.id);
                // What both have as a word is said of the later one.
                is_same(other.id.id())
                    || is_same(&other.name)
                    || !is_later && other.words.iter().any(|own| is_same(own))
            };
            if let Some(other) = rooms.all().iter().filter(|other| other.id != room.id).find(is_called_so) {
                let reason = format!("the rooms `{}` and `{}` are both called `{word}`", room.id, other.id);
                let at = format!("room[{index}].words");
                errors.push(PackError::at(file, &at, reason, "write words that belong to this room alone"));
            }
        }
    }
    errors
}

fn is_same_word(one: &str, other: &str) -> bool {
    let words = |text: &str| text.split_whitespace().map(str::to_lowercase).collect::<Vec<_>>();
    words(one) == words(other)
}

/// All rooms of a floor plan are known.
pub(super) fn check_plan(file: &str, plan: &Layout, rooms: &Rooms) -> Vec<PackError> {
    let own = plan.rooms.iter().map(|room| room.id);
    let joined = plan.openings.iter().flat_map(|opening| opening.between);
    let placed = plan.placements.iter().map(|placement| placement.room);
    let seen = plan.viewpoints.iter().map(|viewpoint| viewpoint.room);
    let noted = plan.note_places.iter().map(|place| place.room);
    let all = own.chain(joined).chain(placed).chain(seen).chain(noted);
    let unknown: BTreeSet<RoomId> = all.filter(|room| rooms.get(*room).is_none()).collect();
    let error = |room: RoomId| {
        let remedy = format!("declare it as a `[[room]]` of `world.toml`, or take one of {}", rooms.listed());
        PackError::at(file, &format!("room `{room}`"), "there is no such room".to_owned(), &remedy)
    };
    unknown.into_iter().map(error).collect()
}

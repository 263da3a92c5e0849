//! The rooms that packs declare: each has an id and a name of its own, and floor plans have no others.

use super::PackError;
use crate::{
    layout::Layout,
    room::{MOST_ROOMS, RoomEntry, RoomId, Rooms},
};

/// What a pack says of rooms can be said and drawn.
pub(super) fn check(file: &str, rooms: &[RoomEntry]) -> Result<(), PackError> {
    for (index, room) in rooms.iter().enumerate() {
        if let Some(words) = room.names().chain(room.kind.iter().map(String::as_str)).find(|words| !is_said(words)) {
            let reason = format!("`{words}` is no name of a room");
            let remedy = "write small letters, digits and spaces, 64 bytes at most";
            return Err(PackError::at(file, &format!("room[{index}]"), reason, remedy));
        }
        if let Some(color) = room.color.as_deref().filter(|color| !is_color(color)) {
            let reason = format!("`{color}` is no colour");
            return Err(PackError::at(file, &format!("room[{index}].color"), reason, "write it as #rrggbb"));
        }
    }
    Ok(())
}

fn is_said(words: &str) -> bool {
    let fits = words.chars().all(|c| c.is_lowercase() || c.is_ascii_digit() || matches!(c, ' ' | '\''));
    fits && !words.trim().is_empty() && words.len() <= 64
}

fn is_color(text: &str) -> bool {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    digits.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

/// Adds the rooms that a pack declares to those there are.
pub(super) fn add(file: &str, rooms: &mut Rooms, own: &[RoomEntry]) -> Result<(), PackError> {
    for (index, room) in own.iter().enumerate() {
        let fault = |at: &str, reason: String, remedy: &str| {
            Err(PackError::at(file, &format!("room[{index}].{at}"), reason, remedy))
        };
        let others = || rooms.all().iter().filter(|other| other.id != room.id);
        let (id, name) = (room.id, &room.name);
        if let Some(other) = others().find(|other| other.id.id().eq_ignore_ascii_case(id.id())) {
            let reason = format!("`{id}` and the room `{}` differ in capital letters alone", other.id);
            return fault("id", reason, "give it another id");
        }
        if let Some(other) = others().find(|other| other.name == *name) {
            return fault("name", format!("the room `{}` is called `{name}` too", other.id), "give it another name");
        }
        rooms.add(room.clone());
        if rooms.all().len() > MOST_ROOMS {
            let remedy = format!("at most {MOST_ROOMS} in a world, with the {} built-in ones", RoomId::BUILTIN.len());
            return fault("id", format!("`{id}` is one room too many"), &remedy);
        }
    }
    Ok(())
}

/// All rooms of a floor plan are known.
pub(super) fn check_plan(file: &str, plan: &Layout, rooms: &Rooms) -> Result<(), PackError> {
    let own = plan.rooms.iter().map(|room| room.id);
    let joined = plan.openings.iter().flat_map(|opening| opening.between);
    let placed = plan.placements.iter().map(|placement| placement.room);
    let seen = plan.viewpoints.iter().map(|viewpoint| viewpoint.room);
    let noted = plan.note_places.iter().map(|place| place.room);
    match own.chain(joined).chain(placed).chain(seen).chain(noted).find(|room| rooms.get(*room).is_none()) {
        Some(room) => {
            let remedy = format!("declare it as a `[[room]]` of `world.toml`, or take one of {}", rooms.listed());
            Err(PackError::at(file, &format!("room `{room}`"), "there is no such room".to_owned(), &remedy))
        }
        None => Ok(()),
    }
}

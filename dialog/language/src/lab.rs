//! `the lab`: there are two, and only the room the robot is in or an answer tells which.

use cohabit_cdf::RoomId;

use crate::{ask, known::Known, lexicon::Lexicon, understanding::Understanding};

/// The two labs, as they are called in full.
const LABS: [RoomId; 2] = [RoomId::Lab1, RoomId::Lab2];

/// Asks which one is meant.
pub(crate) fn question() -> Understanding {
    ask::which_lab(&LABS.map(|room| format!("the {}", room.name())))
}

/// The lab that is meant if nobody can be asked: the one with the nearest thing.
pub(crate) fn guessed(scene: &Known) -> RoomId {
    let in_labs = scene.objects.iter().filter(|object| LABS.contains(&object.room));
    let nearest = in_labs.min_by(|one, other| scene.distance_m(one).total_cmp(&scene.distance_m(other)));
    nearest.map_or(LABS[0], |object| object.room)
}

/// Where a bare `lab` stands, if one does: no part of `quantum lab`, `lab 2` or `lab table`.
pub(crate) fn bare(lexicon: &Lexicon, words: &[String]) -> Option<usize> {
    let mut at = 0;
    while at < words.len() {
        let rest = &words[at..];
        let room = lexicon.rooms.longest(rest).map_or(0, |(length, _)| length);
        let noun = lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
        if room == 0 && noun == 0 && matches!(rest[0].as_str(), "lab" | "laboratory") {
            return Some(at);
        }
        at += room.max(noun).max(1);
    }
    None
}

/// The words with the bare `lab` at `at` named in full.
pub(crate) fn named(words: &[String], at: usize, room: RoomId) -> Vec<String> {
    let mut named = words[..at].to_vec();
    named.extend(room.name().split(' ').map(str::to_owned));
    named.extend_from_slice(&words[at + 1..]);
    named
}

/// The lab meant without asking: the one the robot is in.
pub(crate) fn here(room: RoomId) -> Option<RoomId> {
    LABS.contains(&room).then_some(room)
}

/// The lab that an answer names.
pub(crate) fn answered(lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
    (0..words.len()).find_map(|at| {
        let (_, room) = lexicon.rooms.longest(&words[at..])?;
        here(*room)
    })
}

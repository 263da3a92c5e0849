//! `the lab`: there are two, and only the room the robot is in or an answer tells which.

use cohabit_cdf::RoomId;

use crate::{
    lexicon::Lexicon,
    understanding::{Clarification, Understanding},
};

/// The two labs, as they are called in full.
const LABS: [RoomId; 2] = [RoomId::Lab1, RoomId::Lab2];

/// Asks which one is meant.
pub(crate) fn question() -> Understanding {
    let names = LABS.map(|room| format!("the {}", room.name()));
    Understanding::Question {
        kind: Clarification::Reference,
        about: "lab".to_owned(),
        text: format!("Which lab do you mean: {}?", names.join(" or ")),
        candidates: Vec::new(),
        options: names.to_vec(),
    }
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

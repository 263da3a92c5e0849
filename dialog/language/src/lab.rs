//! `the lab`: there are two, and only the room the robot is in or an answer tells which.

use std::collections::BTreeSet;

use cohabit_cdf::{Catalog, Property, RoomId};

use crate::{
    ask,
    known::{Known, KnownObject},
    lexicon::Lexicon,
    token,
    understanding::Understanding,
};

/// The two labs, as they are called in full.
const LABS: [RoomId; 2] = [RoomId::LAB1, RoomId::LAB2];

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

/// The lab that other words name in full: `take it to the robotics lab. Do you know where that lab is?`
pub(crate) fn beside(lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
    (0..words.len()).find_map(|at| lexicon.rooms.longest(&words[at..]).and_then(|(_, room)| here(*room)))
}

/// The lab that an answer names, counts, or describes by what only one of the two is known to have.
pub(crate) fn answered(lexicon: &Lexicon, scene: &Known, words: &[String]) -> Option<RoomId> {
    let named = (0..words.len()).find_map(|at| lexicon.rooms.longest(&words[at..]).map(|(_, room)| *room));
    // Or it was no lab that was meant.
    if named.is_some() {
        return named;
    }
    let counted = (0..words.len()).find_map(|at| {
        let rest = &words[at..];
        let ordinal = lexicon.ordinals.longest(rest).map(|(_, ordinal)| *ordinal);
        let is_titled = at > 0 && lexicon.titles.exact(&words[at - 1..at]).is_some();
        let number = rest.first().and_then(|word| token::digits(word)).or_else(|| {
            let (_, number) = lexicon.numbers.longest(rest)?;
            (is_titled || words.len() == 1).then_some(*number)
        });
        ordinal.or(number.map(|number| number as i32))
    });
    match counted {
        Some(1) => Some(LABS[0]),
        Some(2 | -1) => Some(LABS[1]),
        _ => told_by_things(lexicon, scene, words).or_else(|| told_by_word(lexicon, words)),
    }
}

/// `the physics one`: a word that only one lab is called by.
fn told_by_word(lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
    words.iter().filter(|word| !lexicon.is_small_word(word)).find_map(|word| {
        let rooms: BTreeSet<RoomId> = lexicon.rooms.with_word(word).copied().collect();
        rooms.first().copied().filter(|room| rooms.len() == 1 && here(*room).is_some())
    })
}

/// The lab that what follows its name describes: `lab with the laser in it`.
pub(crate) fn described(lexicon: &Lexicon, scene: &Known, after: &[String]) -> Option<RoomId> {
    let (first, rest) = after.split_first()?;
    let end = rest.iter().position(|word| token::is_punctuation(word) || word == "and").unwrap_or(rest.len());
    let is_description = matches!(first.as_str(), "with" | "where" | "that" | "which" | "having" | "containing");
    is_description.then(|| told_by_things(lexicon, scene, &rest[..end])).flatten()
}

/// The lab that has a piece of furniture, or a machine, that is named somewhere and stands nowhere else: `take it to the lab and put it in the laser`.
pub(crate) fn furnished(lexicon: &Lexicon, catalog: &Catalog, scene: &Known, words: &[String]) -> Option<RoomId> {
    (0..words.len()).find_map(|at| {
        let (_, namings) = lexicon.classes.longest(&words[at..])?;
        let is_named = |object: &&KnownObject| namings.iter().any(|naming| naming.class == object.class);
        let mut rooms = scene.objects.iter().filter(is_named).map(|object| {
            let is_fixed = !catalog.class(object.class).has(Property::Pickupable);
            here(object.room).filter(|_| is_fixed)
        });
        let first = rooms.next()??;
        rooms.all(|room| room == Some(first)).then_some(first)
    })
}

fn told_by_things(lexicon: &Lexicon, scene: &Known, words: &[String]) -> Option<RoomId> {
    (0..words.len()).find_map(|at| {
        let (_, namings) = lexicon.classes.longest(&words[at..])?;
        let is_named = |object: &&KnownObject| namings.iter().any(|naming| naming.class == object.class);
        let rooms: BTreeSet<RoomId> = scene
            .objects
            .iter()
            .filter(is_named)
            .map(|object| object.room)
            .filter(|room| here(*room).is_some())
            .collect();
        rooms.first().copied().filter(|_| rooms.len() == 1)
    })
}

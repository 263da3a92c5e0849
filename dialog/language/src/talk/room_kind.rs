//! `the lab`, where there are several: only the room the robot is in, what else is said, or an answer tells which.

use std::collections::BTreeSet;

use cohabit_cdf::{Catalog, Property, RoomId};

use crate::{
    known::{Known, KnownObject},
    say::ask,
    understanding::Understanding,
    words::{lexicon::Lexicon, token},
};

/// Words that stand for one room of a kind.
pub(crate) struct RoomKind {
    /// Where they stand.
    pub(crate) at: usize,
    length: usize,
    name: String,
    /// The rooms of the kind that there are, in the order of the world's rooms: at least one.
    rooms: Vec<RoomId>,
}

/// The kind that stands alone in what is said, if one does: no part of `quantum lab`, `lab 2` or `lab table`.
pub(crate) fn bare(lexicon: &Lexicon, scene: &Known, words: &[String]) -> Option<RoomKind> {
    let mut at = 0;
    while at < words.len() {
        let rest = &words[at..];
        // A room that this floor plan lacks may be called as several are together that it has: `the bedroom`.
        let is_here = |(_, room): &(usize, &RoomId)| {
            scene.may_have_room(**room) || standing_at(lexicon, scene, words, at).is_none()
        };
        let room = lexicon.rooms.longest(rest).filter(is_here).map_or(0, |(length, _)| length);
        let noun = lexicon.classes.longest(rest).map_or(0, |(length, _)| length);
        if room == 0
            && noun == 0
            && let Some(kind) = standing_at(lexicon, scene, words, at)
        {
            return Some(kind);
        }
        at += room.max(noun).max(1);
    }
    None
}

/// The kind whose words stand at `at`.
pub(crate) fn standing_at(lexicon: &Lexicon, scene: &Known, words: &[String], at: usize) -> Option<RoomKind> {
    let (length, all) = lexicon.room_kinds.longest(words.get(at..)?)?;
    let rooms: Vec<RoomId> = all.iter().copied().filter(|room| scene.may_have_room(*room)).collect();
    let name = words[at..at + length].join(" ");
    (!rooms.is_empty()).then_some(RoomKind { at, length, name, rooms })
}

/// The room of some kind that words name in full: `take it to the robotics lab. Do you know where that lab is?`
pub(crate) fn beside(lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
    (0..words.len()).find_map(|at| {
        let (_, room) = lexicon.rooms.longest(&words[at..])?;
        lexicon.rooms_of_kinds.contains(room).then_some(*room)
    })
}

impl RoomKind {
    /// Asks which one is meant.
    pub(crate) fn question(&self, catalog: &Catalog) -> Understanding {
        let names: Vec<String> = self.rooms.iter().map(|room| format!("the {}", room.name_in(catalog))).collect();
        ask::which_room(&self.name, &names)
    }

    /// The room that is meant if nobody can be asked: the one with the nearest thing.
    pub(crate) fn guessed(&self, scene: &Known) -> RoomId {
        let there = scene.objects.iter().filter(|object| self.rooms.contains(&object.room));
        let nearest = there.min_by(|one, other| scene.distance_m(one).total_cmp(&scene.distance_m(other)));
        nearest.map_or(self.rooms[0], |object| object.room)
    }

    /// What is said after it.
    pub(crate) fn after<'w>(&self, words: &'w [String]) -> &'w [String] {
        words.get(self.at + self.length..).unwrap_or_default()
    }

    /// The words with the room named in full.
    pub(crate) fn named(&self, words: &[String], room: RoomId, catalog: &Catalog) -> Vec<String> {
        let mut named = words[..self.at].to_vec();
        named.extend(token::words(room.name_in(catalog)));
        named.extend_from_slice(self.after(words));
        named
    }

    /// The room meant without asking: the one the robot is in, or the only one of the kind.
    pub(crate) fn here(&self, room: RoomId) -> Option<RoomId> {
        let only = || self.rooms.first().copied().filter(|_| self.rooms.len() == 1);
        self.has(room).or_else(only)
    }

    /// The room, if it is of the kind.
    pub(crate) fn has(&self, room: RoomId) -> Option<RoomId> {
        self.rooms.contains(&room).then_some(room)
    }

    /// The room of the kind that other words name in full.
    pub(crate) fn beside(&self, lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
        (0..words.len()).find_map(|at| lexicon.rooms.longest(&words[at..]).and_then(|(_, room)| self.has(*room)))
    }

    /// The room that an answer names, counts, or describes by what only one of the kind is known to have.
    pub(crate) fn answered(&self, lexicon: &Lexicon, scene: &Known, words: &[String]) -> Option<RoomId> {
        let named = (0..words.len()).find_map(|at| lexicon.rooms.longest(&words[at..]).map(|(_, room)| *room));
        // Or it was none of the kind that was meant.
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
        let place = counted.and_then(|count| match count {
            -1 => self.rooms.len().checked_sub(1),
            _ => usize::try_from(count).ok()?.checked_sub(1),
        });
        let by_count = place.and_then(|place| self.rooms.get(place)).copied();
        by_count.or_else(|| self.told_by_things(lexicon, scene, words)).or_else(|| self.told_by_word(lexicon, words))
    }

    /// `the physics one`: a word that only one room is called by.
    fn told_by_word(&self, lexicon: &Lexicon, words: &[String]) -> Option<RoomId> {
        words.iter().filter(|word| !lexicon.is_small_word(word)).find_map(|word| {
            let rooms: BTreeSet<RoomId> = lexicon.rooms.with_word(word).copied().collect();
            rooms.first().copied().filter(|room| rooms.len() == 1 && self.has(*room).is_some())
        })
    }

    /// The room that what follows describes: `lab with the laser in it`.
    pub(crate) fn described(&self, lexicon: &Lexicon, scene: &Known, after: &[String]) -> Option<RoomId> {
        let (first, rest) = after.split_first()?;
        let end = rest.iter().position(|word| token::is_punctuation(word) || word == "and").unwrap_or(rest.len());
        let is_description = matches!(first.as_str(), "with" | "where" | "that" | "which" | "having" | "containing");
        is_description.then(|| self.told_by_things(lexicon, scene, &rest[..end])).flatten()
    }

    /// The room that has a piece of furniture, or a machine, that is named somewhere and stands nowhere else: `take it to the lab and put it in the laser`.
    pub(crate) fn furnished(
        &self,
        lexicon: &Lexicon,
        catalog: &Catalog,
        scene: &Known,
        words: &[String],
    ) -> Option<RoomId> {
        (0..words.len()).find_map(|at| {
            let (_, namings) = lexicon.classes.longest(&words[at..])?;
            let is_named = |object: &&KnownObject| namings.iter().any(|naming| naming.class == object.class);
            let mut rooms = scene.objects.iter().filter(is_named).map(|object| {
                let is_fixed = !catalog.class(object.class).has(Property::Pickupable);
                self.has(object.room).filter(|_| is_fixed)
            });
            let first = rooms.next()??;
            rooms.all(|room| room == Some(first)).then_some(first)
        })
    }

    fn told_by_things(&self, lexicon: &Lexicon, scene: &Known, words: &[String]) -> Option<RoomId> {
        (0..words.len()).find_map(|at| {
            let (_, namings) = lexicon.classes.longest(&words[at..])?;
            let is_named = |object: &&KnownObject| namings.iter().any(|naming| naming.class == object.class);
            let rooms: BTreeSet<RoomId> = scene
                .objects
                .iter()
                .filter(is_named)
                .map(|object| object.room)
                .filter(|room| self.has(*room).is_some())
                .collect();
            rooms.first().copied().filter(|_| rooms.len() == 1)
        })
    }
}

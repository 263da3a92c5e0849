//! The phrases of a request, by their part in it.

use cohabit_cdf::ObjectId;
use serde::{Deserialize, Serialize};

use crate::{
    read::{
        clause::Clause,
        phrase::{Phrase, Place},
    },
    words::lexicon::Preposition,
};

/// A phrase in a request.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) struct Slot {
    pub(crate) clause: usize,
    pub(crate) role: Role,
}

/// What part a phrase plays in its clause.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Role {
    Object(usize),
    Place(usize),
}

impl Slot {
    /// A place that was left out gets a phrase, for the answer that says it.
    pub(crate) fn make_room(self, clauses: &mut [Clause]) {
        if let (Role::Place(index), Some(clause)) = (self.role, clauses.get_mut(self.clause))
            && clause.places.len() == index
        {
            clause.places.push((Preposition::In, Place::Object(Phrase::default())));
        }
    }
}

/// The phrase at a place of a request.
pub(crate) fn phrase(clauses: &[Clause], slot: Slot) -> Option<&Phrase> {
    let clause = clauses.get(slot.clause)?;
    match slot.role {
        Role::Object(index) => clause.objects.get(index),
        Role::Place(index) => match clause.places.get(index) {
            Some((_, Place::Object(phrase))) => Some(phrase),
            _ => None,
        },
    }
}

/// A request with this object meant at a place of it.
pub(crate) fn with_chosen(mut clauses: Vec<Clause>, slot: Slot, object: ObjectId) -> Vec<Clause> {
    if let Some(phrase) = phrase_mut(&mut clauses, slot) {
        phrase.chosen = Some(object);
    }
    clauses
}

pub(crate) fn phrase_mut(clauses: &mut [Clause], slot: Slot) -> Option<&mut Phrase> {
    let clause = clauses.get_mut(slot.clause)?;
    match slot.role {
        Role::Object(index) => clause.objects.get_mut(index),
        Role::Place(index) => match clause.places.get_mut(index) {
            Some((_, Place::Object(phrase))) => Some(phrase),
            _ => None,
        },
    }
}

/// The things that a request names, in the order of its slots.
pub(crate) fn named(clause: &Clause) -> Vec<&Phrase> {
    let places = clause.places.iter().filter_map(|(_, place)| match place {
        Place::Object(phrase) => Some(phrase),
        _ => None,
    });
    clause.objects.iter().chain(places).collect()
}

/// The same, to be changed.
pub(crate) fn named_mut(clause: &mut Clause) -> impl Iterator<Item = &mut Phrase> {
    let places = clause.places.iter_mut().filter_map(|(_, place)| match place {
        Place::Object(phrase) => Some(phrase),
        _ => None,
    });
    clause.objects.iter_mut().chain(places)
}

/// Whether a clause names two things, or several together.
pub(crate) fn is_of_two(clause: &Clause) -> bool {
    let named = phrases(clause);
    let is_several = |(_, phrase): &(Role, &Phrase)| phrase.is_all || phrase.is_many();
    named.len() == 2 || named.len() == 1 && named.iter().any(is_several)
}

/// What is to be swapped, and what for.
pub(crate) fn phrases(clause: &Clause) -> Vec<(Role, &Phrase)> {
    let objects = clause.objects.iter().enumerate().map(|(index, phrase)| (Role::Object(index), phrase));
    let others = clause.places.iter().enumerate().filter_map(|(index, place)| match place {
        (Preposition::With | Preposition::For | Preposition::To, Place::Object(phrase)) => {
            Some((Role::Place(index), phrase))
        }
        _ => None,
    });
    objects.chain(others).collect()
}

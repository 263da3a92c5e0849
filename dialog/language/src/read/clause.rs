//! Clauses: one verb with its objects, places, direction and amount.

use cohabit_cdf::{Catalog, Fluid, Property};
use serde::{Deserialize, Serialize};

use crate::{
    read::phrase::{Phrase, Place},
    words::{
        intent::Intent,
        lexicon::{Direction, Manner, NamedRoom, Preposition, Pronoun},
    },
};

/// One request.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Clause {
    pub(crate) intent: Intent,
    pub(crate) objects: Vec<Phrase>,
    pub(crate) places: Vec<(Preposition, Place)>,
    pub(crate) direction: Option<Direction>,
    pub(crate) amount: Option<Amount>,
    pub(crate) color: Option<String>,
    pub(crate) fluid: Option<Fluid>,
    /// Words that mean nothing to the robot.
    pub(crate) unknown: Vec<String>,
    /// Whether it has a noun that found no place in it.
    pub(crate) has_stray_noun: bool,
    /// The verb as it was said.
    pub(crate) verb: String,
    #[serde(default)]
    pub(crate) manner: Option<Manner>,
    /// Whether it says by what means the request before it is to be carried out.
    #[serde(default)]
    pub(crate) is_means: bool,
    /// Whether it was wished for rather than asked for.
    #[serde(default)]
    pub(crate) is_wish: bool,
    /// Whether it is done by who goes out: `on your way out`.
    #[serde(default)]
    pub(crate) is_leaving: bool,
}

impl Clause {
    /// The request to find an object.
    pub(crate) fn find(phrase: Phrase) -> Self {
        Self::about(Intent::Find, "find", phrase)
    }

    /// No request, but what is spoken of from here on.
    pub(crate) fn mention(phrase: Phrase) -> Self {
        Self::about(Intent::Mention, "", phrase)
    }

    pub(crate) fn names_any(&self) -> bool {
        !self.objects.is_empty() || !self.places.is_empty()
    }

    /// The room that is to be looked over: `look in the kitchen`.
    pub(crate) fn looked_over(&self) -> Option<&NamedRoom> {
        let is_turned = !matches!(self.direction, None | Some(Direction::Around));
        if is_turned || !matches!(self.intent, Intent::Look | Intent::LookAround) {
            return None;
        }
        match self.places.as_slice() {
            [(Preposition::In, Place::Room(room))] => Some(room),
            _ => None,
        }
    }

    /// The thing that was named last.
    pub(crate) fn last_phrase(&mut self) -> Option<&mut Phrase> {
        let place = self.places.iter_mut().rev().find_map(|(_, place)| match place {
            Place::Object(phrase) => Some(phrase),
            _ => None,
        });
        match self.intent {
            Intent::GoTo | Intent::Place | Intent::Bring => place.or(self.objects.last_mut()),
            _ => self.objects.last_mut().or(place),
        }
    }

    pub(crate) fn about(intent: Intent, verb: &str, phrase: Phrase) -> Self {
        Self { objects: vec![phrase], ..Self::new(intent, verb) }
    }

    pub(crate) fn new(intent: Intent, verb: &str) -> Self {
        Self {
            intent,
            objects: Vec::new(),
            places: Vec::new(),
            direction: None,
            amount: None,
            color: None,
            fluid: None,
            unknown: Vec::new(),
            has_stray_noun: false,
            verb: verb.to_owned(),
            manner: None,
            is_means: false,
            is_wish: false,
            is_leaving: false,
        }
    }
}

/// How far, or how much.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) enum Amount {
    Meters(f32),
    Degrees(f32),
    Bare(f32),
}

/// What a part of an utterance turned out to be.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    Clause(Clause),
    /// Something that is not to be done, and what it is about.
    Forbidden(Option<Phrase>),
    /// An object without a verb.
    Fragment(Phrase),
    /// Something spoken of in passing.
    Mention(Phrase),
    /// Talk that asks for nothing; the words it does not know.
    Aside(Vec<String>),
    /// What is asked for, but not understood; the words it does not know.
    Unclear(Vec<String>),
}

/// The request to put a thing where it is said to be.
pub(crate) fn placing(mut phrase: Phrase) -> Option<Clause> {
    let place = phrase.relations.pop()?.to;
    Some(Clause {
        places: vec![(Preposition::In, Place::Object(place))],
        ..Clause::about(Intent::Place, "put", phrase)
    })
}

/// `pick up the mug and the bowl and put them on the desk` is one errand: each is carried there in its turn.
pub(crate) fn joined(clauses: Vec<Clause>) -> Vec<Clause> {
    let mut joined: Vec<Clause> = Vec::with_capacity(clauses.len());
    for mut clause in clauses {
        let says_them = |phrase: &Phrase| phrase.pronoun == Some(Pronoun::Things);
        let is_errand = matches!(clause.intent, Intent::Place | Intent::Bring) && clause.objects.iter().all(says_them);
        let gathers = |before: &mut Clause| {
            let is_several = before.objects.len() > 1 || before.objects.iter().any(|phrase| phrase.is_all);
            before.intent == Intent::PickUp && is_several
        };
        if is_errand && let Some(before) = joined.pop_if(gathers) {
            clause.objects = before.objects;
        }
        // `put it, put it there`
        let is_begun = |before: &mut Clause| {
            before.intent == clause.intent
                && before.objects == clause.objects
                && before.places.is_empty()
                && !clause.places.is_empty()
                && !clause.objects.is_empty()
        };
        joined.pop_if(is_begun);
        // `left, turn left!` is one turn.
        let is_same = |before: &mut Clause| {
            before.verb.is_empty() && before.intent == clause.intent && before.direction == clause.direction
        };
        if clause.intent == Intent::Turn {
            joined.pop_if(is_same);
        }
        joined.push(clause);
    }
    joined
}

/// `fill the bowl with cereal`: what can be carried is poured into it.
pub(crate) fn poured(catalog: &Catalog, mut clause: Clause) -> Clause {
    let is_carried =
        |phrase: &Phrase| phrase.namings.iter().any(|naming| catalog.class(naming.class).has(Property::Pickupable));
    if clause.intent == Intent::Fill
        && let [filled] = clause.objects.as_slice()
        && let [(Preposition::With, Place::Object(what))] = clause.places.as_slice()
        && is_carried(what)
    {
        let (filled, what) = (filled.clone(), what.clone());
        clause.intent = Intent::Pour;
        clause.objects = vec![what];
        clause.places = vec![(Preposition::In, Place::Object(filled))];
    }
    clause
}

pub(crate) const fn takes_objects(intent: Intent) -> bool {
    !matches!(intent, Intent::Stop | Intent::Travel | Intent::Turn | Intent::Look | Intent::LookAround)
}

//! From a referring expression to an object: candidates are filtered by what was said, then ranked by how probable
//! each is.

pub(crate) mod confidence;
mod described;
pub(crate) mod focus;
pub(crate) mod judge;
mod likely;
mod told;
pub(crate) mod want;

use cohabit_cdf::{Catalog, Fluid, ObjectId, state::StateFlag};

use crate::{
    ground::{
        confidence::{Features, Referent, Referents},
        focus::Focus,
        judge::Judge,
        want::{Miss, Want},
    },
    known::{Known, KnownObject},
    read::phrase::Phrase,
    understanding::Asking,
    words::{
        intent::Intent,
        lexicon::{Pronoun, StateWord},
    },
};

/// Candidates that are less probable than this part of the best are not named in an answer.
const PLAUSIBLE: f32 = 0.3;
/// What is named by less than this below the best is not offered instead.
const WORSE_NAME: f32 = 0.2;
/// How near `next to` is, m.
pub(crate) const NEAR_M: f32 = 1.5;

/// Grounds phrases in a scene.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) scene: &'a Known,
    pub(crate) focus: &'a Focus,
    pub(crate) judge: Judge<'a>,
}

/// The candidates for a referring expression, by whether all that was said of them holds.
pub(crate) struct Described<'a> {
    /// All of the kind that was named, and of use for what is wanted.
    base: Vec<&'a KnownObject>,
    /// Those that are as described.
    left: Vec<&'a KnownObject>,
}

impl<'a> Ground<'a> {
    /// The one object that is meant.
    pub(crate) fn one(&self, phrase: &Phrase, want: &Want<'_>) -> Result<ObjectId, Miss> {
        if let Some(chosen) = phrase.chosen {
            return Ok(chosen);
        }
        // `the thing on the table` is described, `it` is not.
        if phrase.pronoun == Some(Pronoun::Thing) && phrase.is_described() {
            return self.one(&Phrase { pronoun: None, ..phrase.clone() }, want);
        }
        if let Some(pronoun) = phrase.pronoun.filter(|pronoun| *pronoun != Pronoun::One) {
            return self.referent(pronoun, want).ok_or(Miss::NoReferent);
        }
        let described = match self.described(phrase, want) {
            Err(Miss::Mismatch(others)) if self.judge.asking == Asking::Never && !others.is_empty() => {
                return Ok(others[0]);
            }
            described => described?,
        };
        if let Some(picked) = self.by_position(phrase, &described.left) {
            return Ok(picked);
        }
        self.decide(phrase, want, &self.likelier_places(phrase, want, described))
    }

    /// Of places for a thing: a table is no desk where there are both, and where it is taken from is meant only where nothing else in
    /// that room is called so.
    fn likelier_places(&self, phrase: &Phrase, want: &Want<'_>, described: Described<'a>) -> Described<'a> {
        let Some(origin) = want.origin.and_then(|id| self.scene.object(id)) else { return described };
        let Described { mut base, left } = described;
        let weight = |object: &KnownObject| phrase.naming(object.class).unwrap_or(1.0);
        let is_there = |object: &&KnownObject| object.room == origin.room;
        let best = left.iter().copied().filter(is_there).map(weight).fold(0.0, f32::max);
        let is_called_so = |object: &&KnownObject| !is_there(object) || weight(object) > best - WORSE_NAME;
        let mut kept: Vec<&KnownObject> = left.iter().copied().filter(is_called_so).collect();
        let is_other = |object: &&KnownObject| object.id != origin.id;
        let fits = |object: &&KnownObject| is_there(object) && is_other(object) && weight(object) >= weight(origin);
        if kept.iter().any(fits) {
            kept.retain(is_other);
        }
        let is_gone = |object: &KnownObject| {
            left.iter().any(|one| one.id == object.id) && kept.iter().all(|one| one.id != object.id)
        };
        base.retain(|object| !is_gone(object));
        Described { base, left: kept }
    }

    /// All objects that may well be meant, the likeliest first: for answers about each of them.
    pub(crate) fn plausible(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<ObjectId>, Miss> {
        if phrase.chosen.is_none() && phrase.is_many() && !self.focus.group.is_empty() {
            return Ok(self.focus.group.clone());
        }
        if phrase.chosen.is_some() || phrase.pronoun.is_some() {
            return self.one(phrase, want).map(|one| vec![one]);
        }
        let described = self.described(phrase, want)?;
        if let Some(picked) = self.by_position(phrase, &described.left) {
            return Ok(vec![picked]);
        }
        let groups = self.told_apart(&self.ranked(phrase, want, &described));
        Ok(rivals(&groups, PLAUSIBLE))
    }

    /// What may be meant, with its features and probabilities.
    pub(crate) fn referents(&self, phrase: &Phrase, want: &Want<'_>) -> Option<Referents> {
        let described = self.described(phrase, want).ok()?;
        let features: Vec<Features> = described.base.iter().map(|object| self.features(phrase, want, object)).collect();
        let doubt = self.doubt(phrase, &features);
        let (probabilities, none) = self.judge.weights.probabilities(&features, &doubt);
        let mut candidates: Vec<Referent> = (described.base.iter().zip(features).zip(probabilities))
            .map(|((object, features), probability)| Referent { object: object.id, features, probability })
            .collect();
        candidates
            .sort_by(|one, other| other.probability.total_cmp(&one.probability).then(one.object.cmp(&other.object)));
        Some(Referents { candidates, doubt, none })
    }

    /// All objects that are meant: those of the room, if there are any.
    pub(crate) fn all(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<ObjectId>, Miss> {
        let mut left = self.each(phrase, want)?;
        keep_if_any(&mut left, |object| object.room == self.scene.robot.room);
        let most = phrase.count.map_or(left.len(), usize::from);
        Ok(left.iter().take(most).map(|object| object.id).collect())
    }

    /// All objects that the words mean most, wherever they are.
    pub(crate) fn everywhere(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<ObjectId>, Miss> {
        let left = self.each(phrase, want)?;
        let weight = |object: &KnownObject| phrase.naming(object.class).unwrap_or(1.0);
        let best = left.iter().map(|object| weight(object)).fold(0.0, f32::max);
        Ok(left.iter().filter(|object| weight(object) > best - WORSE_NAME).map(|object| object.id).collect())
    }

    /// All that is as described, the nearest first.
    fn each(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<&'a KnownObject>, Miss> {
        if phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_described() && !phrase.is_all {
            return Err(Miss::Unknown);
        }
        let Described { mut left, .. } = self.described(phrase, want)?;
        left.sort_by(|one, other| {
            self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)).then(one.id.cmp(&other.id))
        });
        Ok(left)
    }

    /// Those of `candidates` that an answer such as `the red one` or `on the desk` means.
    pub(crate) fn narrow(&self, phrase: &Phrase, candidates: &[ObjectId]) -> Vec<ObjectId> {
        let base: Vec<&KnownObject> = candidates.iter().filter_map(|id| self.scene.object(*id)).collect();
        let phrase = &Self::compared(phrase, &base);
        if let Some(ordinal) = phrase.ordinal
            && phrase.side.is_none()
        {
            return at_ordinal(&base, ordinal).into_iter().collect();
        }
        let mut left: Vec<&KnownObject> = base
            .into_iter()
            .filter(|object| self.is_named(phrase, object) && self.is_as_said(phrase, object))
            .collect();
        left.retain(|object| phrase.states.iter().all(|state| self.is_in_state(object, *state)));
        self.keep_nearest(phrase, &mut left);
        match self.by_position(phrase, &left) {
            Some(one) => vec![one],
            None => left.iter().map(|object| object.id).collect(),
        }
    }
}

/// Those whose probability is more than this part of the best's.
fn rivals(groups: &[(f32, &KnownObject)], part: f32) -> Vec<ObjectId> {
    let best = groups.first().map_or(0.0, |(probability, _)| *probability);
    groups.iter().filter(|(probability, _)| *probability >= best * part).map(|(_, object)| object.id).collect()
}

fn keep_if_any<T>(list: &mut Vec<T>, keep: impl Fn(&T) -> bool) {
    if list.iter().any(&keep) {
        list.retain(keep);
    }
}

fn at_ordinal(list: &[&KnownObject], ordinal: i32) -> Option<ObjectId> {
    let index = match usize::try_from(ordinal) {
        Ok(number) => number.checked_sub(1)?,
        Err(_) => list.len().checked_sub(1)?,
    };
    list.get(index).map(|object| object.id)
}

/// Whether an adjective of state is true of an object.
pub(crate) fn has_state(object: &KnownObject, state: StateWord) -> bool {
    match state {
        StateWord::Flag(flag, value) => object.has(flag) == value,
        StateWord::Filled(value) => (object.fluid != Fluid::None || object.has(StateFlag::Cereal)) == value,
    }
}

/// Whether the object's state makes sense of the request; `None` where state says nothing.
pub(crate) fn fitting_state(intent: Intent, object: &KnownObject) -> Option<bool> {
    match intent {
        Intent::Open => Some(!object.has(StateFlag::Opened)),
        Intent::Close => Some(object.has(StateFlag::Opened)),
        Intent::TurnOn => Some(!object.has(StateFlag::Toggled)),
        Intent::TurnOff => Some(object.has(StateFlag::Toggled)),
        Intent::Repair => Some(object.has(StateFlag::Broken) || object.has(StateFlag::Eaten)),
        Intent::Break => Some(!object.has(StateFlag::Broken)),
        Intent::Cut => Some(!object.has(StateFlag::Cut)),
        Intent::Clean => Some(object.has(StateFlag::Dirty)),
        Intent::Dry => Some(object.has(StateFlag::Wet)),
        Intent::Water => Some(!object.has(StateFlag::Wet)),
        Intent::Iron => Some(object.has(StateFlag::Creased)),
        Intent::Fold => Some(!object.has(StateFlag::Folded)),
        Intent::Unfold => Some(object.has(StateFlag::Folded)),
        Intent::Pour => Some(object.fluid != Fluid::None),
        Intent::Fill => Some(object.fluid == Fluid::None),
        _ => None,
    }
}

//! What pronouns and positions pick out: `it`, `there`, the second, the leftmost, the biggest.

use cohabit_cdf::{ObjectId, state::StateFlag};

use crate::{
    ground::{self, Ground, WORSE_NAME, want::Want},
    known::KnownObject,
    read::phrase::Phrase,
    words::{
        intent::Intent,
        lexicon::{Pronoun, Side, StateWord},
    },
};

/// By how much the volume of what was made bigger is taken to grow.
const ENLARGED: f32 = 4.0;
/// What measures less than the most by more than this factor is not said to be so: a lamp on a table is no tall one where another stands
/// on the floor.
const LESS_SO: f32 = 1.5;

impl Ground<'_> {
    /// The object that `it`, `there` and such stand for.
    pub(crate) fn referent(&self, pronoun: Pronoun, want: &Want<'_>) -> Option<ObjectId> {
        let held = self.scene.robot.held.filter(|held| Some(*held) != want.exclude);
        if pronoun != Pronoun::Place && want.held_first && held.is_some() {
            return held;
        }
        let affords = |id: &ObjectId| {
            let Some(object) = self.scene.object(*id) else { return false };
            let class = self.catalog.class(object.class);
            want.affordances.is_empty() || want.affordances.iter().any(|affordance| class.has(*affordance))
        };
        let is_free = |id: &ObjectId| {
            let is_held = self.scene.robot.held == Some(*id) && matches!(want.intent, Intent::PickUp | Intent::GoTo);
            Some(*id) != want.exclude && !is_held
        };
        let place = self.focus.place.into_iter();
        let mut spoken = self.focus.recent.clone();
        spoken.retain(|id| pronoun != Pronoun::Place || Some(*id) != self.focus.place);
        let at = if pronoun == Pronoun::Place { 0 } else { spoken.len() };
        // `put the bread in the toaster and turn it on`: the place is meant where nothing else spoken of fits.
        spoken.splice(at..at, place);
        spoken.retain(is_free);
        let fits = spoken.iter().find(|id| affords(id) && self.suits(want.intent, **id));
        let fitting = fits.or_else(|| spoken.iter().find(|id| affords(id))).copied();
        let fitting = fitting.or_else(|| held.filter(|held| affords(held)));
        fitting.or_else(|| self.only_one_in_need(want)).or_else(|| spoken.first().copied()).or(held)
    }

    /// `shut it`, where nothing was spoken of: the only thing in the room that is open.
    fn only_one_in_need(&self, want: &Want<'_>) -> Option<ObjectId> {
        if !matches!(
            want.intent,
            Intent::Close | Intent::TurnOff | Intent::Repair | Intent::Clean | Intent::Dry | Intent::Iron
        ) {
            return None;
        }
        let is_in_need = |object: &&KnownObject| {
            object.room == self.scene.robot.room
                && ground::fitting_state(want.intent, object) == Some(true)
                && want.affordances.iter().any(|affordance| self.catalog.class(object.class).has(*affordance))
        };
        let mut in_need = self.scene.objects.iter().filter(is_in_need);
        in_need.next().filter(|_| in_need.next().is_none()).map(|object| object.id)
    }

    /// Whether its state makes sense of the request: one closes what is open.
    fn suits(&self, intent: Intent, id: ObjectId) -> bool {
        self.scene.object(id).is_some_and(|object| ground::fitting_state(intent, object) != Some(false))
    }

    /// The leftmost, second, nearest and so on of those that are left.
    pub(crate) fn by_position(&self, phrase: &Phrase, left: &[&KnownObject]) -> Option<ObjectId> {
        let mut near: Vec<&KnownObject> = left.to_vec();
        ground::keep_if_any(&mut near, |object| object.room == self.scene.robot.room);
        near.sort_by(|one, other| {
            let (one_at, other_at) = (self.scene.bearing_rad(one), self.scene.bearing_rad(other));
            other_at.total_cmp(&one_at).then(one.id.cmp(&other.id))
        });
        let by_distance = |one: &&&KnownObject, other: &&&KnownObject| {
            self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)).then(one.id.cmp(&other.id))
        };
        if let Some(ordinal) = phrase.ordinal {
            return ground::at_ordinal(&near, ordinal);
        }
        let picked = match phrase.side? {
            Side::Left => near.first().copied(),
            Side::Right => near.last().copied(),
            Side::Middle => near.get(near.len() / 2).copied(),
            Side::Nearest => near.iter().min_by(by_distance).copied(),
            Side::Farthest => near.iter().max_by(by_distance).copied(),
            side @ (Side::Biggest
            | Side::Smallest
            | Side::Tallest
            | Side::Longest
            | Side::Shortest
            | Side::Heaviest
            | Side::Lightest) => return self.by_measure(left, side),
            // What hangs elsewhere is neither above nor below what is here.
            side @ (Side::Upper | Side::Lower) => return self.by_measure(&near, side),
            Side::Front | Side::Behind | Side::Other => None,
        };
        picked.map(|object| object.id)
    }

    /// The biggest, the tallest, the upper one and such, where one alone is.
    fn by_measure(&self, left: &[&KnownObject], side: Side) -> Option<ObjectId> {
        let most = left.iter().map(|object| self.measure(object, side)).fold(f32::NEG_INFINITY, f32::max);
        let mut best = left.iter().filter(|object| self.measure(object, side) >= most);
        let one = best.next()?;
        best.next().is_none().then_some(one.id)
    }

    /// Drops from those that are as described, and from all of the kind, what is much less tall, little or long than the most so of those
    /// that are called so as much, where that was said.
    pub(crate) fn drop_of_other_size(
        &self,
        phrase: &Phrase,
        left: &mut Vec<&KnownObject>,
        base: &mut Vec<&KnownObject>,
    ) {
        let weight = |object: &KnownObject| phrase.naming(object.class).unwrap_or(1.0);
        for side in phrase.sizes.iter().copied() {
            let best = left.iter().map(|object| weight(object)).fold(0.0, f32::max);
            let called = left.iter().filter(|object| weight(object) > best - WORSE_NAME);
            let most = called.map(|object| self.measure(object, side)).fold(f32::NEG_INFINITY, f32::max);
            // Of what is the more so the smaller it is, the measure is below zero.
            let enough = if most < 0.0 { most * LESS_SO } else { most / LESS_SO };
            let is_other = |object: &&&KnownObject| self.measure(object, side) < enough;
            let dropped: Vec<ObjectId> = left.iter().filter(is_other).map(|object| object.id).collect();
            left.retain(|object| !dropped.contains(&object.id));
            base.retain(|object| !dropped.contains(&object.id));
        }
    }

    /// By what things are compared that are said to be more so than others.
    fn measure(&self, object: &KnownObject, side: Side) -> f32 {
        let class = self.catalog.class(object.class);
        let larger = if object.has(StateFlag::Embiggenated) { ENLARGED } else { 1.0 };
        let volume = || class.size_m.iter().product::<f32>() * larger;
        let longest = || class.size_m.iter().copied().fold(0.0, f32::max) * larger.cbrt();
        match side {
            Side::Biggest => volume(),
            Side::Smallest => -volume(),
            Side::Tallest => class.size_m[2] * larger.cbrt(),
            Side::Longest => longest(),
            Side::Shortest => -longest(),
            Side::Heaviest => class.mass_kg * larger,
            Side::Lightest => -class.mass_kg * larger,
            Side::Upper => object.position_m[2],
            Side::Lower => -object.position_m[2],
            _ => 0.0,
        }
    }

    /// `the big one` of things that no machine made bigger: the bigger one.
    pub(crate) fn compared(phrase: &Phrase, among: &[&KnownObject]) -> Phrase {
        let says_size = |state: &StateWord| matches!(state, StateWord::Flag(StateFlag::Embiggenated, _));
        let said = phrase.states.iter().copied().find(says_size);
        let is_made = among.iter().any(|object| object.has(StateFlag::Embiggenated));
        let mut phrase = phrase.clone();
        if let Some(StateWord::Flag(_, is_big)) = said
            && !is_made
            && phrase.side.is_none()
        {
            phrase.states.retain(|state| !says_size(state));
            phrase.side = Some(if is_big { Side::Biggest } else { Side::Smallest });
        }
        phrase
    }
}

//! From a referring expression to an object: candidates are filtered by what was said, then ranked by how probable
//! each is.

use cohabit_cdf::{Catalog, ClassId, Color, Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    confidence::{Doubt, Feature, Features, Referent, Referents},
    context::Focus,
    describe,
    intent::Intent,
    judge::Judge,
    known::{self, Known, KnownObject},
    lexicon::{Naming, Pronoun, Side, StateWord},
    phrase::{Phrase, Relation, RelationKind},
    understanding::Asking,
};

/// How far away counts, at most, m, and the unit in which it is counted.
const FARTHEST_M: f32 = 30.0;
const DISTANCE_UNIT_M: f32 = 10.0;
/// How much what was spoken of counts, the latest first.
const RECENCY: [f32; 3] = [1.0, 2.0 / 3.0, 1.0 / 3.0];

/// Candidates that are less probable than this part of the best are not asked about, nor named in an answer.
const RIVAL: f32 = 0.1;
const PLAUSIBLE: f32 = 0.3;
/// Most candidates that a question is about.
const MOST_RIVALS: usize = 32;

/// Most things of which one may be what a strange word means.
const MOST_STRANGERS: usize = 4;

/// What is named by less than this below the best is not offered instead.
const WORSE_NAME: f32 = 0.2;

/// What is named by no more than this is named by a word for many things.
const VAGUE_NAME: f32 = 0.6;

/// How near `next to` is, m.
/// By how much the volume of what was made bigger is taken to grow.
const ENLARGED: f32 = 4.0;
pub(crate) const NEAR_M: f32 = 1.5;

/// What is nearer to something than others by more than this is the one that is next to it, m.
const NEARER_M: f32 = 0.15;

/// How far `left of` reaches, m.
const BESIDE_M: f32 = 2.0;
/// How likely the likeliest must be meant to count if it is in the room, whatever is elsewhere.
const HERE: f32 = 0.3;

/// How near a fixed thing such as a button is to the machine it is `on`, m.
const PART_M: f32 = 0.8;

/// How far to the side `in front of you` reaches, rad.
const FRONT_RAD: f32 = 0.9;

/// What the object is wanted for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Want<'a> {
    pub(crate) intent: Intent,
    pub(crate) affordances: &'a [Property],
    /// The only classes that will do, if any is among the candidates.
    pub(crate) classes: &'a [ClassId],
    pub(crate) exclude: Option<ObjectId>,
    /// Whether what is held is meant first.
    pub(crate) held_first: bool,
    /// Of a place that something is to be put: what it is taken from.
    pub(crate) origin: Option<ObjectId>,
}

impl<'a> Want<'a> {
    pub(crate) fn object(intent: Intent) -> Self {
        Self {
            intent,
            affordances: intent.affordances(),
            classes: &[],
            exclude: None,
            held_first: intent.is_about_held(),
            origin: None,
        }
    }

    pub(crate) fn place(intent: Intent, affordances: &'a [Property], exclude: Option<ObjectId>) -> Self {
        Self { intent, affordances, classes: &[], exclude, held_first: false, origin: None }
    }
}

/// Why no object was found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Miss {
    /// Nobody knows where such a thing is.
    Unseen,
    /// There are such things, but none as described.
    Mismatch(Vec<ObjectId>),
    /// Several, which can be told apart; or one that is too doubtful to act on.
    Several(Vec<ObjectId>),
    /// A pronoun, and nothing was spoken of.
    NoReferent,
    /// The words are not known.
    Unknown,
    /// There is one, but the robot has hardly looked about the room that it is in: people may mean another.
    Hasty,
}

/// Grounds phrases in a scene.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) scene: &'a Known,
    pub(crate) focus: &'a Focus,
    pub(crate) judge: Judge<'a>,
}

/// The candidates for a referring expression, by whether all that was said of them holds.
struct Described<'a> {
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
        if phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_described() && !phrase.is_all {
            return Err(Miss::Unknown);
        }
        let Described { mut left, .. } = self.described(phrase, want)?;
        keep_if_any(&mut left, |object| object.room == self.scene.robot.room);
        left.sort_by(|one, other| {
            self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)).then(one.id.cmp(&other.id))
        });
        let most = phrase.count.map_or(left.len(), usize::from);
        Ok(left.iter().take(most).map(|object| object.id).collect())
    }

    /// Those of `candidates` that an answer such as `the red one` or `on the desk` means.
    pub(crate) fn narrow(&self, phrase: &Phrase, candidates: &[ObjectId]) -> Vec<ObjectId> {
        let base: Vec<&KnownObject> = candidates.iter().filter_map(|id| self.scene.object(*id)).collect();
        if let Some(ordinal) = phrase.ordinal
            && phrase.side.is_none()
        {
            return at_ordinal(&base, ordinal).into_iter().collect();
        }
        let mut left: Vec<&KnownObject> = base
            .into_iter()
            .filter(|object| self.is_named(phrase, object) && self.is_as_said(phrase, object))
            .collect();
        left.retain(|object| phrase.states.iter().all(|state| has_state(object, *state)));
        self.keep_nearest(phrase, &mut left);
        match self.by_position(phrase, &left) {
            Some(one) => vec![one],
            None => left.iter().map(|object| object.id).collect(),
        }
    }

    fn described(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Described<'a>, Miss> {
        let mut base: Vec<&KnownObject> = self
            .scene
            .objects
            .iter()
            .filter(|object| self.is_candidate(phrase, object) && !phrase.excluded.contains(&object.id))
            .collect();
        // A noun that means nothing may be anything, whatever its colour.
        if phrase.is_empty() && !phrase.unknown.is_empty() {
            return Err(self.perhaps(phrase, want));
        }
        if base.is_empty() {
            return Err(if phrase.is_empty() && !phrase.says_something() { Miss::Unknown } else { Miss::Unseen });
        }
        keep_if_any(&mut base, |object| Some(object.id) != want.exclude);
        self.keep_affording(phrase, &mut base, want);
        let mut left = base.clone();
        left.retain(|object| self.is_as_said(phrase, object));
        if let Some(color) = &phrase.color {
            // What was given that colour, then what has it by nature, then what is only called so.
            let is_plain = |object: &KnownObject| color == "white" && self.is_plain_twin(object);
            let by_nature = |object: &KnownObject| shade_of(&describe::color(self.catalog, object)) == color;
            keep_if_any(&mut left, |object| by_nature(object) || is_plain(object));
            keep_if_any(&mut left, |object| object.color.name().eq_ignore_ascii_case(color));
        }
        if left.is_empty() {
            left = self.plain_ones(phrase, &base);
        }
        // `the banana over there` points, where nothing was spoken of that it is on.
        let points = |relation: &Relation| relation.to.pronoun == Some(Pronoun::Place);
        if left.is_empty() && phrase.relations.iter().any(points) {
            let mut bare = phrase.clone();
            bare.relations.retain(|relation| !points(relation));
            return self.described(&bare, want);
        }
        if left.is_empty()
            && let Some(found) = self.described_otherwise(phrase, want)
        {
            return Ok(found);
        }
        if left.is_empty() {
            self.keep_best_named(phrase, &mut base);
            return Err(Miss::Mismatch(base.iter().map(|object| object.id).collect()));
        }
        for state in &phrase.states {
            keep_if_any(&mut left, |object| has_state(object, *state));
        }
        self.keep_nearest(phrase, &mut left);
        self.keep_at_side(phrase, &mut left);
        self.keep_at_side(phrase, &mut base);
        Ok(Described { base, left })
    }

    /// What the words may mean besides, where nothing is as they say at first: `the mug on the table that is yellow`, of a yellow
    /// mug; `the shelf that is red`, of a red wall shelf.
    fn described_otherwise(&self, phrase: &Phrase, want: &Want<'_>) -> Option<Described<'a>> {
        if let Some(other) = phrase.with_late_look() {
            return self.described(&other, want).ok();
        }
        let best = phrase.namings.iter().max_by(|one, other| one.weight.total_cmp(&other.weight))?;
        let name = describe::name(self.catalog, best.class);
        let kind = name.rsplit(' ').next().filter(|kind| phrase.text.split(' ').any(|word| word == *kind))?;
        let ends = |name: &String| name.to_lowercase().strip_suffix(kind).is_some_and(|before| before.ends_with(' '));
        let is_kind = |object: &&KnownObject| {
            let class = self.catalog.class(object.class);
            std::iter::once(&class.name).chain(&class.words).any(ends)
        };
        let mut base: Vec<&KnownObject> = self.scene.objects.iter().filter(is_kind).collect();
        let affords = |object: &KnownObject| {
            let class = self.catalog.class(object.class);
            want.affordances.is_empty() || want.affordances.iter().any(|affordance| class.has(*affordance))
        };
        base.retain(|object| {
            Some(object.id) != want.exclude && !phrase.excluded.contains(&object.id) && affords(object)
        });
        let left: Vec<&KnownObject> = base.iter().filter(|object| self.is_as_said(phrase, object)).copied().collect();
        (!left.is_empty()).then_some(Described { base, left })
    }

    /// What a word may mean that nobody taught it: what is where it is said to be, to be asked about.
    fn perhaps(&self, phrase: &Phrase, want: &Want<'_>) -> Miss {
        let is_placed = |relation: &Relation| relation.kind == RelationKind::Inside && relation.to.unknown.is_empty();
        if self.judge.asking == Asking::Never || phrase.is_all || !phrase.relations.iter().any(is_placed) {
            return Miss::Unknown;
        }
        let thing = Phrase { unknown: Vec::new(), ..phrase.clone() };
        match self.described(&thing, want) {
            Ok(Described { left, .. }) if left.len() <= MOST_STRANGERS => {
                Miss::Several(left.iter().map(|object| object.id).collect())
            }
            _ => Miss::Unknown,
        }
    }

    /// `the mug next to the apple`: of several, the one that is nearest to it.
    fn keep_nearest(&self, phrase: &Phrase, objects: &mut Vec<&KnownObject>) {
        let Some(near) = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Near) else { return };
        let others: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|other| self.is_loosely(&near.to, other)).collect();
        let apart_m = |object: &KnownObject| {
            let others = others.iter().filter(|other| other.id != object.id && other.room == object.room);
            others.map(|other| known::distance_m(other.position_m, object.position_m)).fold(f32::INFINITY, f32::min)
        };
        let least_m = objects.iter().map(|object| apart_m(object)).fold(f32::INFINITY, f32::min);
        keep_if_any(objects, |object| apart_m(object) <= least_m + NEARER_M);
    }

    /// Keeps what is before the robot, behind it, or other than what was spoken of last, as was said.
    fn keep_at_side(&self, phrase: &Phrase, objects: &mut Vec<&KnownObject>) {
        match phrase.side {
            Some(Side::Front) => keep_if_any(objects, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() < FRONT_RAD
            }),
            Some(Side::Behind) => keep_if_any(objects, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() > FRONT_RAD
            }),
            Some(Side::Other) => {
                let last = self.focus.recent.iter().find(|id| objects.iter().any(|object| object.id == **id)).copied();
                keep_if_any(objects, |object| Some(object.id) != last);
            }
            _ => {}
        }
    }

    /// Keeps what the words mean most, the nearest first: a trophy is a cup only where there is no other.
    fn keep_best_named(&self, phrase: &Phrase, base: &mut Vec<&KnownObject>) {
        let weight = |object: &KnownObject| phrase.naming(object.class).unwrap_or(1.0);
        let best = base.iter().map(|object| weight(object)).fold(0.0, f32::max);
        base.retain(|object| weight(object) > best - WORSE_NAME);
        base.sort_by(|one, other| self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)));
    }

    /// Drops what does not afford what is wanted, unless nothing does.
    fn keep_affording(&self, phrase: &Phrase, base: &mut Vec<&KnownObject>, want: &Want<'_>) {
        if !want.classes.is_empty() {
            keep_if_any(base, |object| want.classes.contains(&object.class));
        }
        if !want.affordances.is_empty() {
            keep_if_any(base, |object| {
                let class = self.catalog.class(object.class);
                want.affordances.iter().any(|affordance| class.has(*affordance))
            });
        }
        // `pick up another mug`
        let is_another = phrase.is_any || phrase.side == Some(Side::Other);
        if want.intent == Intent::PickUp && is_another {
            keep_if_any(base, |object| Some(object.id) != self.scene.robot.held);
        }
    }

    fn is_candidate(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if phrase.is_empty() || phrase.pronoun == Some(Pronoun::One) && phrase.namings.is_empty() {
            // `the red one`: one of the kind spoken of last, or anything that is red.
            let last = self.focus.recent.first().and_then(|id| self.scene.object(*id));
            return match (last, phrase.pronoun) {
                (Some(last), Some(Pronoun::One)) => {
                    self.catalog.names(last.class).plain == self.catalog.names(object.class).plain
                }
                (None, Some(Pronoun::One)) if !self.focus.group.is_empty() => self.focus.group.contains(&object.id),
                _ => phrase.says_something(),
            };
        }
        self.is_named(phrase, object)
    }

    /// Whether its class, instance id or fluid is the one said; true where none is.
    fn is_named(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if let Some(instance) = &phrase.instance {
            let class = &self.catalog.class(object.class).id;
            return object.instance.eq_ignore_ascii_case(instance) || class.eq_ignore_ascii_case(instance);
        }
        let is_fluid = phrase.fluid.is_some_and(|fluid| fluid == object.fluid);
        let says_nothing = phrase.namings.is_empty() && phrase.fluid.is_none();
        says_nothing || is_fluid || phrase.naming(object.class).is_some()
    }

    /// Colour, room and relations: what must hold.
    fn is_as_said(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        phrase.color.as_ref().is_none_or(|color| self.has_color(object, color))
            && phrase.room.is_none_or(|room| object.room == room)
            && (!phrase.is_here || object.room == self.scene.robot.room)
            && phrase.relations.iter().all(|relation| self.is_related(object, relation))
            && !phrase.not.iter().any(|other| self.is_loosely(other, object))
    }

    fn has_color(&self, object: &KnownObject, color: &str) -> bool {
        let color_of = describe::color(self.catalog, object);
        if color == "white" && self.is_plain_twin(object) {
            return true;
        }
        if color_of == color || color_of.split_whitespace().any(|word| shade_of(word) == color) {
            return true;
        }
        // Names and words may say the colour too, as in `red computer`.
        let class = self.catalog.class(object.class);
        object.color == Color::Original
            && std::iter::once(&class.name)
                .chain(&class.words)
                .any(|words| words.split_whitespace().any(|word| word.eq_ignore_ascii_case(color)))
    }

    /// `the white apple` among red ones: the one that nobody coloured.
    fn plain_ones(&self, phrase: &Phrase, base: &[&'a KnownObject]) -> Vec<&'a KnownObject> {
        if phrase.color.as_deref() != Some("white") {
            return Vec::new();
        }
        let plain = Phrase { color: None, ..phrase.clone() };
        let fits = |object: &&&KnownObject| object.color == Color::Original && self.is_as_said(&plain, object);
        base.iter().filter(fits).copied().collect()
    }

    /// Whether it is the unpainted one of several of its kind: `white`, where the others are red and blue.
    fn is_plain_twin(&self, object: &KnownObject) -> bool {
        let is_painted_twin = |other: &KnownObject| {
            other.class == object.class && other.color != Color::Original && other.in_mission == object.in_mission
        };
        object.color == Color::Original && self.scene.objects.iter().any(is_painted_twin)
    }

    fn is_related(&self, object: &KnownObject, relation: &Relation) -> bool {
        if relation.to.pronoun == Some(Pronoun::Place) && self.focus.place.is_none() {
            return self.focus.room.is_none_or(|room| object.room == room);
        }
        let fits = |other: &KnownObject| other.id != object.id && self.is_loosely(&relation.to, other);
        match relation.kind {
            RelationKind::Inside => {
                let is_held = self.scene.robot.held == Some(object.id);
                let is_part = |other: &KnownObject| {
                    fits(other) && known::distance_m(other.position_m, object.position_m) < PART_M
                };
                let is_fixed = !self.catalog.class(object.class).has(Property::Pickupable);
                !is_held && self.scene.ancestors(object.id).any(fits)
                    || is_fixed && self.scene.objects.iter().any(|other| object.works == Some(other.id) && fits(other))
                    || is_fixed && self.scene.objects.iter().any(is_part)
            }
            RelationKind::Has => {
                self.has_poured(object, &relation.to)
                    || self.scene.contents(object.id).any(fits)
                    || self.scene.objects.iter().any(|other| fits(other) && self.stands_by(object, other))
            }
            // What works nothing may be for anything.
            RelationKind::For => object.works.is_none_or(|worked| self.scene.object(worked).is_some_and(fits)),
            RelationKind::LeftOf | RelationKind::RightOf => self.scene.objects.iter().any(|other| {
                let is_left = self.scene.bearing_rad(object) > self.scene.bearing_rad(other);
                fits(other)
                    && other.room == object.room
                    && known::distance_m(other.position_m, object.position_m) < BESIDE_M
                    && is_left == (relation.kind == RelationKind::LeftOf)
            }),
            RelationKind::Near => self.scene.objects.iter().any(|other| {
                fits(other)
                    && other.room == object.room
                    && known::distance_m(other.position_m, object.position_m) < NEAR_M
            }),
        }
    }

    /// Whether furniture has other furniture beside it, as `the desk with the blue chair` has.
    fn stands_by(&self, object: &KnownObject, other: &KnownObject) -> bool {
        let is_carried = |object: &KnownObject| self.catalog.class(object.class).has(Property::Pickupable);
        !is_carried(object)
            && !is_carried(other)
            && other.room == object.room
            && known::distance_m(other.position_m, object.position_m) < NEAR_M
    }

    /// Whether what a phrase names was poured into an object: `the mug with coffee`.
    fn has_poured(&self, object: &KnownObject, phrase: &Phrase) -> bool {
        let is_cereal = |naming: &Naming| self.catalog.class(naming.class).name.contains("Cereal");
        phrase.fluid.is_some_and(|fluid| fluid != Fluid::None && object.fluid == fluid)
            || object.has(StateFlag::Cereal) && phrase.namings.iter().any(is_cereal)
    }

    /// Whether an object could be the one a relation speaks of.
    fn is_loosely(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if let Some(chosen) = phrase.chosen {
            return chosen == object.id;
        }
        match phrase.pronoun {
            Some(Pronoun::One) | None => {}
            Some(Pronoun::Place) => return self.focus.place == Some(object.id),
            Some(Pronoun::Thing) if phrase.is_described() => {}
            Some(_) => return self.focus.recent.first() == Some(&object.id) || self.focus.place == Some(object.id),
        }
        let is_meant =
            !phrase.is_empty() && self.is_named(phrase, object) || phrase.is_empty() && phrase.says_something();
        is_meant && self.is_as_said(phrase, object) && phrase.states.iter().all(|state| has_state(object, *state))
    }

    /// The object that `it`, `there` and such stand for.
    fn referent(&self, pronoun: Pronoun, want: &Want<'_>) -> Option<ObjectId> {
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
        if !matches!(want.intent, Intent::Close | Intent::TurnOff | Intent::Repair | Intent::Clean) {
            return None;
        }
        let is_in_need = |object: &&KnownObject| {
            object.room == self.scene.robot.room
                && fitting_state(want.intent, object) == Some(true)
                && want.affordances.iter().any(|affordance| self.catalog.class(object.class).has(*affordance))
        };
        let mut in_need = self.scene.objects.iter().filter(is_in_need);
        in_need.next().filter(|_| in_need.next().is_none()).map(|object| object.id)
    }

    /// Whether its state makes sense of the request: one closes what is open.
    fn suits(&self, intent: Intent, id: ObjectId) -> bool {
        self.scene.object(id).is_some_and(|object| fitting_state(intent, object) != Some(false))
    }

    /// The leftmost, second, nearest and so on of those that are left.
    fn by_position(&self, phrase: &Phrase, left: &[&KnownObject]) -> Option<ObjectId> {
        let mut near: Vec<&KnownObject> = left.to_vec();
        keep_if_any(&mut near, |object| object.room == self.scene.robot.room);
        near.sort_by(|one, other| {
            let (one_at, other_at) = (self.scene.bearing_rad(one), self.scene.bearing_rad(other));
            other_at.total_cmp(&one_at).then(one.id.cmp(&other.id))
        });
        let by_distance = |one: &&&KnownObject, other: &&&KnownObject| {
            self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)).then(one.id.cmp(&other.id))
        };
        if let Some(ordinal) = phrase.ordinal {
            return at_ordinal(&near, ordinal);
        }
        let picked = match phrase.side? {
            Side::Left => near.first().copied(),
            Side::Right => near.last().copied(),
            Side::Middle => near.get(near.len() / 2).copied(),
            Side::Nearest => near.iter().min_by(by_distance).copied(),
            Side::Farthest => near.iter().max_by(by_distance).copied(),
            Side::Biggest | Side::Smallest => return self.by_size(left, phrase.side == Some(Side::Biggest)),
            Side::Front | Side::Behind | Side::Other => None,
        };
        picked.map(|object| object.id)
    }

    /// The biggest or the smallest, where one alone is.
    fn by_size(&self, left: &[&KnownObject], is_biggest: bool) -> Option<ObjectId> {
        let size = |object: &KnownObject| {
            let volume: f32 = self.catalog.class(object.class).size_m.iter().product();
            let larger = if object.has(StateFlag::Embiggenated) { ENLARGED } else { 1.0 };
            if is_biggest { volume * larger } else { -volume * larger }
        };
        let best = left.iter().max_by(|one, other| size(one).total_cmp(&size(other)))?;
        let is_alone = left.iter().filter(|object| size(object) >= size(best)).count() == 1;
        is_alone.then_some(best.id)
    }

    /// The likeliest candidate, or all between which it would cost too much to guess.
    fn decide(&self, phrase: &Phrase, want: &Want<'_>, described: &Described<'a>) -> Result<ObjectId, Miss> {
        let ranked = self.ranked(phrase, want, described);
        let Some((_, best)) = ranked.first().copied() else { return Err(Miss::Unseen) };
        let may_settle = self.judge.repairs == 0
            && self.judge.asking == Asking::Unsure
            && !self.judge.is_for_good(want.intent, best.class);
        // The only one that is as described.
        let is_sole = described.left.len() == 1 && phrase.is_described() && phrase.unknown.is_empty();
        if may_settle && is_sole {
            return Ok(best.id);
        }
        if let Some(spoken) = self.spoken_of_kind(phrase, &described.left) {
            return Ok(spoken);
        }
        // Nothing but what is in the hand can be poured at once.
        let is_held = want.intent == Intent::Pour && self.scene.robot.held == Some(best.id);
        if is_held && phrase.naming(best.class).is_some() {
            return Ok(best.id);
        }
        let groups = self.told_apart(&ranked);
        let probability = groups.first().map_or(0.0, |(probability, _)| *probability);
        let rival = groups.get(1).map_or(0.0, |(probability, _)| *probability);
        if let Some(here) = self.likely_here(phrase, &groups).filter(|_| may_settle) {
            return Ok(here);
        }
        if !phrase.is_any && self.judge.asks(want.intent, best.class, probability, rival) {
            return Err(Miss::Several(rivals(&groups, RIVAL)));
        }
        Ok(best.id)
    }

    /// `the table`, where the likeliest is in the room, and no other one there is likely: who means one elsewhere says where.
    fn likely_here(&self, phrase: &Phrase, groups: &[(f32, &KnownObject)]) -> Option<ObjectId> {
        let is_here = |object: &KnownObject| object.room == self.scene.robot.room;
        let ((probability, likeliest), others) = groups.split_first()?;
        let is_meant = *probability >= HERE && phrase.room.is_none() && !phrase.is_described() && is_here(likeliest);
        let has_rival = others.iter().any(|(other, object)| is_here(object) && *other >= probability * RIVAL);
        (is_meant && !has_rival).then_some(likeliest.id)
    }

    /// `the machine`, after the coffee machine was spoken of: a word for many things means the one at hand.
    fn spoken_of_kind(&self, phrase: &Phrase, left: &[&KnownObject]) -> Option<ObjectId> {
        let is_kind = !phrase.namings.is_empty() && phrase.namings.iter().all(|naming| naming.weight <= VAGUE_NAME);
        let mut spoken = self.focus.place.iter().chain(&self.focus.recent);
        spoken.find(|id| is_kind && !phrase.is_all && left.iter().any(|object| object.id == **id)).copied()
    }

    /// Those that are as described, with the probability of each, the likeliest first.
    fn ranked(&self, phrase: &Phrase, want: &Want<'_>, described: &Described<'a>) -> Vec<(f32, &'a KnownObject)> {
        let features: Vec<Features> = described.base.iter().map(|object| self.features(phrase, want, object)).collect();
        let (probabilities, _) = self.judge.weights.probabilities(&features, &self.doubt(phrase, &features));
        let is_left = |object: &KnownObject| described.left.iter().any(|left| left.id == object.id);
        let mut ranked: Vec<(f32, &KnownObject)> =
            probabilities.into_iter().zip(described.base.iter().copied()).filter(|(_, one)| is_left(one)).collect();
        // What is called white because others of its kind are painted may be none of the base.
        let others = described.left.iter().filter(|left| described.base.iter().all(|object| object.id != left.id));
        ranked.extend(others.map(|object| (0.0, *object)));
        ranked.sort_by(|(one, a), (other, b)| other.total_cmp(one).then(a.id.cmp(&b.id)));
        ranked
    }

    /// One of each kind that can be told apart in words, with the probability that it is one of that kind.
    fn told_apart(&self, ranked: &[(f32, &'a KnownObject)]) -> Vec<(f32, &'a KnownObject)> {
        let mut groups: Vec<(f32, &KnownObject)> = Vec::new();
        for (probability, object) in ranked {
            match groups.iter().position(|(_, seen)| self.is_told_alike(seen, object)) {
                Some(at) => groups[at].0 += probability,
                None if groups.len() < MOST_RIVALS => groups.push((*probability, object)),
                None => {}
            }
        }
        groups
    }

    /// Whether the same words describe both: they look alike, and so does what they are on.
    fn is_told_alike(&self, one: &KnownObject, other: &KnownObject) -> bool {
        let parent = |object: &KnownObject| object.parent.and_then(|parent| self.scene.object(parent));
        let is_same_place = one.room == other.room
            && match (parent(one), parent(other)) {
                (None, None) => true,
                (Some(one), Some(other)) => one.id == other.id || describe::look_alike(self.catalog, one, other),
                _ => false,
            };
        is_same_place && (describe::look_alike(self.catalog, one, other) || self.are_called_alike(one, other))
    }

    /// Whether each is also called by the name of the other, and of the same color, as the pieces of one worktop are.
    fn are_called_alike(&self, one: &KnownObject, other: &KnownObject) -> bool {
        let is_called = |class: ClassId, name: ClassId| {
            let (class, name) = (self.catalog.class(class), &self.catalog.class(name).name);
            std::iter::once(&class.name).chain(&class.words).any(|word| word.eq_ignore_ascii_case(name))
        };
        let [first, second] = [one, other].map(|object| self.catalog.class(object.class));
        let is_alike = first.tint.is_some() && first.tint == second.tint && !first.has(Property::Pickupable);
        is_alike && is_called(one.class, other.class) && is_called(other.class, one.class)
    }

    fn doubt(&self, phrase: &Phrase, candidates: &[Features]) -> Doubt {
        let has_mission = self.scene.objects.iter().any(|object| object.in_mission);
        Doubt::new(self.judge.repairs, phrase.unknown.len(), has_mission, candidates)
    }

    /// Whether it is behind a closed door: people speak of what they see.
    fn is_hidden(&self, object: &KnownObject) -> bool {
        let is_carried = self.catalog.class(object.class).has(Property::Pickupable);
        is_carried
            && self.scene.ancestors(object.id).next().is_some_and(|parent| {
                let class = self.catalog.class(parent.class);
                let encloses = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
                encloses && class.has(Property::Openable) && !parent.has(StateFlag::Opened)
            })
    }

    /// What speaks for a candidate, and against it.
    fn features(&self, phrase: &Phrase, want: &Want<'_>, object: &KnownObject) -> Features {
        let is_held = self.scene.robot.held == Some(object.id);
        let is_here = object.room == self.scene.robot.room;
        let is_sought = want.intent == Intent::Find;
        let distance = self.scene.distance_m(object).min(FARTHEST_M) / DISTANCE_UNIT_M;
        let is_at = |place| self.scene.ancestors(object.id).any(|parent| parent.id == place);
        let recent = self.focus.recent.iter().position(|id| *id == object.id);
        let unrelated = phrase.relations.iter().filter(|relation| !self.is_related(object, relation)).count();
        let is_elsewhere = phrase.room.is_some_and(|room| object.room != room) || phrase.is_here && !is_here;
        let mut features = Features::default();
        features.set(Feature::Name, phrase.naming(object.class).unwrap_or(1.0));
        features
            .set_if(Feature::ColorMismatch, phrase.color.as_ref().is_some_and(|color| !self.has_color(object, color)));
        features.set_if(Feature::StateMismatch, phrase.states.iter().any(|state| !has_state(object, *state)));
        features.set_if(Feature::RoomMismatch, is_elsewhere);
        features.set(Feature::RelationMismatch, unrelated as f32);
        features.set_if(Feature::SameRoom, is_here);
        features.set_if(Feature::SameRoomSought, is_here && is_sought);
        features.set_if(Feature::Visible, object.visible || is_held);
        features.set_if(Feature::HeldFirst, is_held && want.held_first);
        features.set_if(Feature::StateFits, fitting_state(want.intent, object) == Some(true));
        features.set_if(Feature::AtPlace, self.focus.place.is_some_and(is_at));
        features.set_if(Feature::Hidden, self.is_hidden(object));
        features.set_if(Feature::InMission, object.in_mission);
        features.set(Feature::Recency, recent.and_then(|at| RECENCY.get(at)).copied().unwrap_or_default());
        features.set(Feature::Distance, distance);
        features.set(Feature::DistanceSought, if is_sought { distance } else { 0.0 });
        features
    }
}

/// Those whose probability is more than this part of the best's.
fn rivals(groups: &[(f32, &KnownObject)], part: f32) -> Vec<ObjectId> {
    let best = groups.first().map_or(0.0, |(probability, _)| *probability);
    groups.iter().filter(|(probability, _)| *probability >= best * part).map(|(_, object)| object.id).collect()
}

/// The colour that people's words for it come to: the catalogue tells silver from grey.
fn shade_of(color: &str) -> &str {
    match color {
        "grey" | "silver" => "gray",
        "beige" | "copper" => "brown",
        color => color,
    }
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
        Intent::Clean => Some(object.has(StateFlag::Dirty)),
        Intent::Pour => Some(object.fluid != Fluid::None),
        Intent::Fill => Some(object.fluid == Fluid::None),
        _ => None,
    }
}

//! From a referring expression to an object: candidates are filtered by what was said, then scored.

use cohabit_cdf::{Catalog, ClassId, Color, Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    context::Focus,
    describe,
    intent::Intent,
    known::{self, Known, KnownObject},
    lexicon::{Pronoun, Side, StateWord},
    phrase::{Phrase, Relation, RelationKind},
};

/// How much each feature counts. A metre of way counts `PER_METER`; the rest is in proportion to what it outweighs:
/// being in the same room outweighs 8 m, having been spoken of outweighs 5 m.
const NAME: f32 = 3.0;
const SAME_ROOM: f32 = 2.0;
const VISIBLE: f32 = 1.0;
const HELD: f32 = 6.0;
const FITTING_STATE: f32 = 1.5;
const AT_PLACE: f32 = 1.5;
const HIDDEN: f32 = 1.5;
const RECENT: [f32; 3] = [1.2, 0.8, 0.4];
const PER_METER: f32 = 0.25;
const FARTHEST_M: f32 = 30.0;
/// The share that nearness has in what is to be found.
const FIND: f32 = 0.5;
/// What the mission is about outweighs what stands around, also where its name fits a little less.
const IN_MISSION: f32 = 6.0;

/// Two candidates whose scores differ by less are a tie; the robot then asks, or guesses where little is at stake.
const MARGIN: f32 = 0.5;
const MARGIN_HARMLESS: f32 = 0.3;

/// What is named by less than this below the best is not offered instead.
const WORSE_NAME: f32 = 0.2;

/// How near `next to` is, m.
const NEAR_M: f32 = 1.5;

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
}

impl<'a> Want<'a> {
    pub(crate) fn object(intent: Intent) -> Self {
        Self {
            intent,
            affordances: intent.affordances(),
            classes: &[],
            exclude: None,
            held_first: intent.is_about_held(),
        }
    }

    pub(crate) fn place(intent: Intent, affordances: &'a [Property], exclude: Option<ObjectId>) -> Self {
        Self { intent, affordances, classes: &[], exclude, held_first: false }
    }
}

/// Why no object was found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Miss {
    /// Nobody knows where such a thing is.
    Unseen,
    /// There are such things, but none as described.
    Mismatch(Vec<ObjectId>),
    /// Several, which look different.
    Several(Vec<ObjectId>),
    /// A pronoun, and nothing was spoken of.
    NoReferent,
    /// The words are not known.
    Unknown,
}

/// Grounds phrases in a scene.
#[derive(Clone, Copy)]
pub(crate) struct Ground<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) scene: &'a Known,
    pub(crate) focus: &'a Focus,
}

impl<'a> Ground<'a> {
    /// The one object that is meant.
    pub(crate) fn one(&self, phrase: &Phrase, want: &Want<'_>) -> Result<ObjectId, Miss> {
        if let Some(chosen) = phrase.chosen {
            return Ok(chosen);
        }
        // `the thing on the table` is described, `it` is not.
        if phrase.pronoun == Some(Pronoun::Thing) && !phrase.relations.is_empty() {
            return self.one(&Phrase { pronoun: None, ..phrase.clone() }, want);
        }
        if let Some(pronoun) = phrase.pronoun.filter(|pronoun| *pronoun != Pronoun::One) {
            return self.referent(pronoun, want).ok_or(Miss::NoReferent);
        }
        let left = self.described(phrase, want)?;
        if let Some(picked) = self.by_position(phrase, &left) {
            return Ok(picked);
        }
        self.best(phrase, want, &left)
    }

    /// All objects that are meant: those of the room, if there are any.
    pub(crate) fn all(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<ObjectId>, Miss> {
        let mut left = self.described(phrase, want)?;
        keep_if_any(&mut left, |object| object.room == self.scene.robot.room);
        left.sort_by(|one, other| {
            self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)).then(one.id.cmp(&other.id))
        });
        Ok(left.iter().map(|object| object.id).collect())
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
        match self.by_position(phrase, &left) {
            Some(one) => vec![one],
            None => left.iter().map(|object| object.id).collect(),
        }
    }

    fn described(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Vec<&'a KnownObject>, Miss> {
        let mut base: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|object| self.is_candidate(phrase, object)).collect();
        if base.is_empty() {
            return Err(if phrase.is_empty() && !phrase.says_something() { Miss::Unknown } else { Miss::Unseen });
        }
        keep_if_any(&mut base, |object| Some(object.id) != want.exclude);
        self.keep_affording(&mut base, want);
        let mut left = base.clone();
        left.retain(|object| self.is_as_said(phrase, object));
        if let Some(color) = &phrase.color {
            // What was given that colour, then what has it by nature, then what is only called so.
            let is_plain = |object: &KnownObject| color == "white" && self.is_plain_twin(object);
            let by_nature = |object: &KnownObject| describe::color(self.catalog, object) == *color;
            keep_if_any(&mut left, |object| by_nature(object) || is_plain(object));
            keep_if_any(&mut left, |object| object.color.name().eq_ignore_ascii_case(color));
        }
        if left.is_empty() {
            left = self.plain_ones(phrase, &base);
        }
        if left.is_empty() {
            self.keep_best_named(phrase, &mut base);
            return Err(Miss::Mismatch(base.iter().map(|object| object.id).collect()));
        }
        for state in &phrase.states {
            keep_if_any(&mut left, |object| has_state(object, *state));
        }
        match phrase.side {
            Some(Side::Front) => keep_if_any(&mut left, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() < FRONT_RAD
            }),
            Some(Side::Behind) => keep_if_any(&mut left, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() > FRONT_RAD
            }),
            Some(Side::Other) => {
                let last = self.focus.recent.iter().find(|id| left.iter().any(|object| object.id == **id)).copied();
                keep_if_any(&mut left, |object| Some(object.id) != last);
            }
            _ => {}
        }
        Ok(left)
    }

    /// Keeps what the words mean most, the nearest first: a trophy is a cup only where there is no other.
    fn keep_best_named(&self, phrase: &Phrase, base: &mut Vec<&KnownObject>) {
        let weight = |object: &KnownObject| phrase.naming(object.class).unwrap_or(1.0);
        let best = base.iter().map(|object| weight(object)).fold(0.0, f32::max);
        base.retain(|object| weight(object) > best - WORSE_NAME);
        base.sort_by(|one, other| self.scene.distance_m(one).total_cmp(&self.scene.distance_m(other)));
    }

    /// Drops what does not afford what is wanted, unless nothing does.
    fn keep_affording(&self, base: &mut Vec<&KnownObject>, want: &Want<'_>) {
        if !want.classes.is_empty() {
            keep_if_any(base, |object| want.classes.contains(&object.class));
        }
        if !want.affordances.is_empty() {
            keep_if_any(base, |object| {
                let class = self.catalog.class(object.class);
                want.affordances.iter().any(|affordance| class.has(*affordance))
            });
        }
        if want.intent == Intent::PickUp {
            keep_if_any(base, |object| Some(object.id) != self.scene.robot.held);
        }
    }

    fn is_candidate(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if phrase.is_empty() || phrase.pronoun == Some(Pronoun::One) && phrase.namings.is_empty() {
            // `the red one`: one of the kind spoken of last, or anything that is red.
            let last = self.focus.recent.first().and_then(|id| self.scene.object(*id));
            return match (last, phrase.pronoun) {
                (Some(last), Some(Pronoun::One)) => {
                    describe::name(self.catalog, last.class) == describe::name(self.catalog, object.class)
                }
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
    }

    fn has_color(&self, object: &KnownObject, color: &str) -> bool {
        let color_of = describe::color(self.catalog, object);
        if color == "white" && self.is_plain_twin(object) {
            return true;
        }
        if color_of == color || color_of.split_whitespace().any(|word| word == color) {
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
            RelationKind::Has => self.scene.contents(object.id).any(fits),
            RelationKind::Near => self.scene.objects.iter().any(|other| {
                fits(other)
                    && other.room == object.room
                    && known::distance_m(other.position_m, object.position_m) < NEAR_M
            }),
        }
    }

    /// Whether an object could be the one a relation speaks of.
    fn is_loosely(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if let Some(chosen) = phrase.chosen {
            return chosen == object.id;
        }
        match phrase.pronoun {
            Some(Pronoun::One) | None => {}
            Some(Pronoun::Place) => return self.focus.place == Some(object.id),
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
        let place = self.focus.place.into_iter().filter(|_| pronoun == Pronoun::Place);
        let spoken: Vec<ObjectId> = place.chain(self.focus.recent.iter().copied()).filter(is_free).collect();
        let fits = spoken.iter().find(|id| affords(id) && self.suits(want.intent, **id));
        let fitting = fits.or_else(|| spoken.iter().find(|id| affords(id))).copied();
        fitting.or_else(|| held.filter(|held| affords(held))).or_else(|| spoken.first().copied()).or(held)
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
            Side::Front | Side::Behind | Side::Other => None,
        };
        picked.map(|object| object.id)
    }

    fn best(&self, phrase: &Phrase, want: &Want<'_>, left: &[&KnownObject]) -> Result<ObjectId, Miss> {
        let mut scored: Vec<(f32, &KnownObject)> =
            left.iter().map(|object| (self.score(phrase, want, object), *object)).collect();
        scored.sort_by(|(one, a), (other, b)| other.total_cmp(one).then(a.id.cmp(&b.id)));
        let Some((top, best)) = scored.first().copied() else { return Err(Miss::Unseen) };
        let margin = if want.intent.is_harmless() { MARGIN_HARMLESS } else { MARGIN };
        let mut looks: Vec<&KnownObject> = vec![best];
        for (score, object) in &scored[1..] {
            let is_new = !looks.iter().any(|seen| describe::look_alike(self.catalog, seen, object));
            if top - score < margin && is_new {
                looks.push(object);
            }
        }
        if looks.len() > 1 {
            return Err(Miss::Several(looks.iter().map(|object| object.id).collect()));
        }
        Ok(best.id)
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

    fn score(&self, phrase: &Phrase, want: &Want<'_>, object: &KnownObject) -> f32 {
        let mut score = NAME * phrase.naming(object.class).unwrap_or(1.0);
        let is_held = self.scene.robot.held == Some(object.id);
        // Who says `find` does not mean what is before them.
        let nearness = if want.intent == Intent::Find { FIND } else { 1.0 };
        if object.room == self.scene.robot.room {
            score += SAME_ROOM * nearness;
        }
        if object.visible || is_held {
            score += VISIBLE;
        }
        if is_held && want.held_first {
            score += HELD;
        }
        if fitting_state(want.intent, object) == Some(true) {
            score += FITTING_STATE;
        }
        if self.focus.place.is_some_and(|place| self.scene.ancestors(object.id).any(|parent| parent.id == place)) {
            score += AT_PLACE;
        }
        if self.is_hidden(object) {
            score -= HIDDEN;
        }
        if object.in_mission {
            score += IN_MISSION;
        }
        let recent = self.focus.recent.iter().position(|id| *id == object.id);
        score += recent.and_then(|at| RECENT.get(at)).copied().unwrap_or_default();
        score - PER_METER * nearness * self.scene.distance_m(object).min(FARTHEST_M)
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
fn fitting_state(intent: Intent, object: &KnownObject) -> Option<bool> {
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

//! Whether a thing is as it was described: its name, look, state, and what it stands by.

use cohabit_cdf::{Color, Fluid, Property, state::StateFlag};

use crate::{
    ground::{
        self, Described, Ground, NEAR_M, WORSE_NAME,
        want::{Miss, Want},
    },
    known::{KnownObject, describe, floor, vending},
    read::phrase::{BOTH, Phrase, Relation, RelationKind},
    understanding::Asking,
    words::{
        intent::Intent,
        lexicon::{Naming, Pronoun, Side, StateWord},
    },
};

/// Most things of which one may be what a strange word means.
const MOST_STRANGERS: usize = 4;
/// What is nearer to something than others by more than this is the one that is next to it, m.
const NEARER_M: f32 = 0.15;
/// How far `left of` reaches, m.
const BESIDE_M: f32 = 2.0;
/// How near a fixed thing such as a button is to the machine it is `on`, m.
const PART_M: f32 = 0.8;
/// How far to the side `in front of you` reaches, rad.
const FRONT_RAD: f32 = 0.9;

impl<'a> Ground<'a> {
    pub(crate) fn described(&self, phrase: &Phrase, want: &Want<'_>) -> Result<Described<'a>, Miss> {
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
        ground::keep_if_any(&mut base, |object| Some(object.id) != want.exclude);
        self.keep_affording(phrase, &mut base, want);
        self.drop_stand_ins(phrase, &mut base);
        let mut left = base.clone();
        left.retain(|object| self.is_as_said(phrase, object));
        if let Some(color) = &phrase.color {
            // What was given that colour, then what has it by nature, then what is only called so.
            let is_plain = |object: &KnownObject| color == "white" && self.is_plain_twin(object);
            let by_nature = |object: &KnownObject| shade_of(&describe::color(self.catalog, object)) == color;
            ground::keep_if_any(&mut left, |object| by_nature(object) || is_plain(object));
            ground::keep_if_any(&mut left, |object| object.color.name().eq_ignore_ascii_case(color));
        }
        // `the milk` is the carton of it, rather than a glass that has some.
        if phrase.fluid.is_some() {
            ground::keep_if_any(&mut left, |object| {
                phrase.fluid == Some(object.fluid) && phrase.naming(object.class).is_some()
            });
        }
        if left.is_empty() {
            left = self.plain_ones(phrase, &base);
        }
        // `the banana over there` points, where nothing was spoken of that it is on; `the lamp in the vestibule` tells nothing to who does
        // not know that word.
        let is_strange = |to: &Phrase| !to.says_something() && !to.unknown.is_empty();
        let tells_nothing =
            |relation: &Relation| relation.to.pronoun == Some(Pronoun::Place) || is_strange(&relation.to);
        if left.is_empty() && phrase.relations.iter().any(tells_nothing) {
            let mut bare = phrase.clone();
            bare.relations.retain(|relation| !tells_nothing(relation));
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
            ground::keep_if_any(&mut left, |object| self.is_in_state(object, *state));
        }
        self.drop_of_other_size(phrase, &mut left, &mut base);
        self.keep_nearest(phrase, &mut left);
        self.keep_at_side(phrase, &mut left);
        self.keep_at_side(phrase, &mut base);
        // Who is right in where they think that it is means that one.
        let is_hinted = |object: &KnownObject| phrase.hints.iter().any(|hint| self.is_as_said(hint, object));
        if left.iter().any(|object| is_hinted(object)) {
            left.retain(|object| is_hinted(object));
            base.retain(|object| is_hinted(object));
        }
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
    pub(crate) fn keep_nearest(&self, phrase: &Phrase, objects: &mut Vec<&KnownObject>) {
        let Some(near) = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Near) else { return };
        let others: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|other| self.is_loosely(&near.to, other)).collect();
        let apart_m = |object: &KnownObject| {
            let others = others.iter().filter(|other| other.id != object.id && other.room == object.room);
            // `the table next to the plate` is the one that the plate stands on.
            let way_m = |other: &&KnownObject| {
                let carries = other.parent == Some(object.id);
                if carries { 0.0 } else { floor::distance_m(other.position_m, object.position_m) }
            };
            others.map(way_m).fold(f32::INFINITY, f32::min)
        };
        let least_m = objects.iter().map(|object| apart_m(object)).fold(f32::INFINITY, f32::min);
        ground::keep_if_any(objects, |object| apart_m(object) <= least_m + NEARER_M);
    }

    /// Keeps what is before the robot, behind it, or other than what was spoken of last, as was said.
    fn keep_at_side(&self, phrase: &Phrase, objects: &mut Vec<&KnownObject>) {
        match phrase.side {
            Some(Side::Front) => ground::keep_if_any(objects, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() < FRONT_RAD
            }),
            Some(Side::Behind) => ground::keep_if_any(objects, |object| {
                object.room == self.scene.robot.room && self.scene.bearing_rad(object).abs() > FRONT_RAD
            }),
            Some(Side::Other) => {
                let last = self.focus.recent.iter().find(|id| objects.iter().any(|object| object.id == **id)).copied();
                ground::keep_if_any(objects, |object| Some(object.id) != last);
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
            ground::keep_if_any(base, |object| want.classes.contains(&object.class));
        }
        if !want.affordances.is_empty() {
            ground::keep_if_any(base, |object| {
                let class = self.catalog.class(object.class);
                want.affordances.iter().any(|affordance| class.has(*affordance))
            });
        }
        // `pick up another mug`
        let is_another = phrase.is_any || phrase.side == Some(Side::Other);
        if want.intent == Intent::PickUp && is_another {
            ground::keep_if_any(base, |object| Some(object.id) != self.scene.robot.held);
        }
    }

    /// Drops machines that are only taken for what was named, where such a one is there: a light switch is the lamp where there is no lamp.
    fn drop_stand_ins(&self, phrase: &Phrase, base: &mut Vec<&KnownObject>) {
        let said = format!(" {} ", phrase.text);
        let is_called_so = |object: &KnownObject| {
            let class = self.catalog.class(object.class);
            let mut names = std::iter::once(&class.name).chain(&class.words);
            names.any(|name| said.contains(&format!(" {} ", name.to_lowercase())))
        };
        let is_machine = |object: &KnownObject| self.catalog.class(object.class).has(Property::Toggleable);
        let room = phrase.room.unwrap_or(self.scene.robot.room);
        let is_there = |object: &KnownObject| {
            object.room == room || !phrase.relations.is_empty() && self.is_as_said(phrase, object)
        };
        let is_it = |object: &KnownObject| is_machine(object) && is_called_so(object) && is_there(object);
        if !phrase.namings.is_empty() && base.iter().any(|object| is_it(object)) {
            let is_carried = |object: &KnownObject| self.catalog.class(object.class).has(Property::Pickupable);
            base.retain(|object| !is_machine(object) || is_carried(object) || is_called_so(object));
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

    /// Whether it is as an adjective says: what holds things is full of them, and empty without any.
    pub(crate) fn is_in_state(&self, object: &KnownObject, state: StateWord) -> bool {
        let holds_things = self.scene.contents(object.id).next().is_some();
        match state {
            StateWord::Filled(is_full) if holds_things => is_full,
            state => ground::has_state(object, state),
        }
    }

    /// Whether its class, instance id or fluid is the one said; true where none is.
    pub(crate) fn is_named(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        if let Some(instance) = &phrase.instance {
            let class = &self.catalog.class(object.class).id;
            return object.instance.eq_ignore_ascii_case(instance) || class.eq_ignore_ascii_case(instance);
        }
        let is_fluid = phrase.fluid.is_some_and(|fluid| fluid == object.fluid);
        let says_nothing = phrase.namings.is_empty() && phrase.fluid.is_none();
        !phrase.is_floor && (says_nothing || is_fluid || phrase.naming(object.class).is_some())
    }

    /// Colour, room and relations: what must hold.
    pub(crate) fn is_as_said(&self, phrase: &Phrase, object: &KnownObject) -> bool {
        phrase.color.as_ref().is_none_or(|color| self.has_color(object, color))
            && phrase.room.is_none_or(|room| object.room == room)
            && (!phrase.is_here || object.room == self.scene.robot.room)
            && phrase.relations.iter().all(|relation| self.is_related(object, relation))
            && !phrase.not.iter().any(|other| self.is_loosely(other, object))
    }

    pub(crate) fn has_color(&self, object: &KnownObject, color: &str) -> bool {
        // The catalogue has but one of the colours of a red and white machine.
        if let Some((one, other)) = color.split_once(BOTH) {
            return self.has_color(object, one) || self.has_color(object, other);
        }
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

    pub(crate) fn is_related(&self, object: &KnownObject, relation: &Relation) -> bool {
        if relation.to.pronoun == Some(Pronoun::Place) && self.focus.place.is_none() {
            return self.focus.room.is_none_or(|room| object.room == room);
        }
        if relation.to.is_floor {
            return self.scene.is_on_floor(object);
        }
        let fits = |other: &KnownObject| other.id != object.id && self.is_loosely(&relation.to, other);
        match relation.kind {
            RelationKind::Inside => {
                let is_held = self.scene.robot.held == Some(object.id);
                let is_part = |other: &KnownObject| {
                    fits(other) && floor::distance_m(other.position_m, object.position_m) < PART_M
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
            RelationKind::For => {
                object.works.is_none_or(|worked| self.scene.object(worked).is_some_and(fits))
                    || vending::brought_out(self.catalog, self.scene, object).is_some_and(fits)
            }
            RelationKind::LeftOf | RelationKind::RightOf => self.scene.objects.iter().any(|other| {
                let is_left = self.scene.bearing_rad(object) > self.scene.bearing_rad(other);
                let is_at_side = other.room == object.room
                    && floor::distance_m(other.position_m, object.position_m) < BESIDE_M
                    && is_left == (relation.kind == RelationKind::LeftOf);
                fits(other) && (is_at_side || other.parent == Some(object.id))
            }),
            // `on the counter next to the toaster`: the counter on which the toaster stands, however long it is.
            RelationKind::Near => self.scene.objects.iter().any(|other| {
                let is_near =
                    other.room == object.room && floor::distance_m(other.position_m, object.position_m) < NEAR_M;
                fits(other) && (is_near || other.parent == Some(object.id))
            }),
        }
    }

    /// Whether furniture has other furniture beside it, as `the desk with the blue chair` has.
    fn stands_by(&self, object: &KnownObject, other: &KnownObject) -> bool {
        let is_carried = |object: &KnownObject| self.catalog.class(object.class).has(Property::Pickupable);
        !is_carried(object)
            && !is_carried(other)
            && other.room == object.room
            && floor::distance_m(other.position_m, object.position_m) < NEAR_M
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
        is_meant
            && self.is_as_said(phrase, object)
            && phrase.states.iter().all(|state| self.is_in_state(object, *state))
    }
}

/// The colour that people's words for it come to: the catalogue tells silver from grey.
fn shade_of(color: &str) -> &str {
    match color {
        "grey" | "silver" => "gray",
        "beige" | "copper" => "brown",
        color => color,
    }
}

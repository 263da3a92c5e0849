//! Where what is put away goes: `put the milk away`, `tidy up the toys`.

use std::collections::BTreeMap;

use cohabit_cdf::{ClassId, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::want::Want,
    known::KnownObject,
    plan::{Fault, Planner, settle::Settled},
    read::{phrase::Relation, slot::Role},
};

/// How much less often things like it may be kept in a place than in that which has most of them.
const AS_USUAL: f32 = 0.5;

impl Planner<'_> {
    /// Puts things where such things are kept, or else on the best surface near by; what was shut is shut again in the end.
    pub(crate) fn put_away(&mut self, objects: &[ObjectId]) -> Result<(), Fault> {
        let mut shut: Vec<ObjectId> = Vec::new();
        for object in objects.iter().copied() {
            let Some(storage) = self.storage_of(object) else {
                let kinds = self.storage_kinds(object);
                if !kinds.is_empty() && self.may_find(&kinds) {
                    return Err(self.need(&kinds, "I see no place where such things are kept."));
                }
                self.put_elsewhere(object)?;
                continue;
            };
            if self.scene.object(object).is_some_and(|known| known.parent == Some(storage)) {
                self.notes.push(format!("{} is in {} already", self.the(object), self.the(storage)));
                continue;
            }
            self.hold(object)?;
            if self.is_shut(storage) {
                shut.push(storage);
            }
            self.place_on(storage);
        }
        shut.into_iter().for_each(|storage| self.interact(Verb::Close, storage, "closing"));
        Ok(())
    }

    /// `put away everything on the table`: which table, where that is not known.
    pub(crate) fn ask_what_is_cleared(&self, settled: &Settled) -> Result<(), Fault> {
        let described = settled.objects.last().filter(|_| settled.is_of_everything());
        let is_open = |one: &&Relation| one.to.chosen.is_none() && !one.to.is_floor;
        for relation in described.iter().flat_map(|object| &object.relations).filter(is_open) {
            let want = Want::place(settled.intent, &[], None);
            self.find_one(&relation.to, &want, Some(Role::Place(0)))?;
        }
        Ok(())
    }

    /// Puts a thing that has no place of its own on another surface than that where it is.
    fn put_elsewhere(&mut self, object: ObjectId) -> Result<(), Fault> {
        let from = self.taken_from(object);
        self.hold(object)?;
        match self.surface(None, from) {
            Some(surface) => {
                self.place_on(surface);
                Ok(())
            }
            None => self.put_down(None),
        }
    }

    /// The kinds of places in which the floor plans keep such things most, however many are known here.
    fn storage_kinds(&self, object: ObjectId) -> Vec<ClassId> {
        let kept = self.kept_in(object);
        let most = kept.values().copied().fold(0.0, f32::max);
        kept.into_iter().filter(|(_, share)| *share >= AS_USUAL * most).map(|(place, _)| place).collect()
    }

    /// The nearest of the places with doors in which the floor plans keep such things; that in which it is comes first.
    fn storage_of(&self, object: ObjectId) -> Option<ObjectId> {
        let within = self.scene.object(object)?.parent;
        let kept = self.kept_in(object);
        let share = |place: &KnownObject| kept.get(&place.class).copied().unwrap_or_default();
        let takes_it = |place: &&KnownObject| {
            share(place) > 0.0 && !place.has(StateFlag::Locked) && (within == Some(place.id) || self.has_room(place))
        };
        let places = || self.scene.objects.iter().filter(takes_it);
        let most = places().map(share).fold(0.0, f32::max);
        let usual = || places().filter(|place| share(place) >= AS_USUAL * most);
        let own = usual().find(|place| within == Some(place.id)).map(|place| place.id);
        own.or_else(|| self.nearest_of(usual()))
    }

    /// How often the floor plans keep such things in what encloses them, by its kind: no machine that is started.
    fn kept_in(&self, object: ObjectId) -> BTreeMap<ClassId, f32> {
        let class = self.scene.object(object).map(|known| known.class);
        let mut kept = class.map(|class| self.habits.kept_in(self.catalog, class)).unwrap_or_default();
        kept.retain(|place, _| {
            let class = self.catalog.class(*place);
            class.has(Property::Receptacle) && !class.has(Property::Toggleable) && !class.has(Property::Pickupable)
        });
        kept
    }
}

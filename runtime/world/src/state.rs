//! All that changes in a world, and nothing that does not: what a snapshot holds and a digest covers.

use std::collections::BTreeMap;

use cohabit_cdf::{BodyId, ObjectId};
use serde::{Deserialize, Serialize};

use crate::{
    body::Body,
    entity::Object,
    mission_state::{Away, Dinosaur, Gate, GoalProgress},
    report::Ending,
    solver::Physics,
};

/// The changing part of a world.
#[derive(Serialize, Deserialize)]
pub(crate) struct State {
    pub tick: u64,
    pub objects: Vec<Object>,
    pub bodies: Vec<Body>,
    /// Which circuits are fed.
    pub circuits: BTreeMap<i32, bool>,
    pub goals: Vec<GoalProgress>,
    /// Which of the mission's messages and camera movements that wait for an occasion have it now, in their order.
    pub occasions: Vec<bool>,
    /// Where the portal generators lead.
    pub portals: BTreeMap<ObjectId, Gate>,
    /// The names of the portals that objects go through; what is not here goes through all.
    pub passes: BTreeMap<ObjectId, Vec<String>>,
    /// Dinosaurs, by the objects that they are, or the generators behind which they live.
    pub dinosaurs: BTreeMap<ObjectId, Dinosaur>,
    /// What is not there yet.
    pub away: BTreeMap<ObjectId, Away>,
    pub ended: Option<(u64, Ending)>,
    pub physics: Physics,
    /// Counts changes of what blocks the way, so that paths are planned on a floor that is up to date.
    pub floor_version: u64,
}

impl State {
    /// The object at `id`, if the id is of this world.
    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.get(id.0 as usize)
    }

    /// The object at an id known to be of this world.
    pub fn at(&self, id: ObjectId) -> &Object {
        &self.objects[id.0 as usize]
    }

    /// The object at an id known to be of this world, to change it.
    pub fn at_mut(&mut self, id: ObjectId) -> &mut Object {
        &mut self.objects[id.0 as usize]
    }

    /// Ids and objects that are in the world, in order.
    pub fn existing(&self) -> impl Iterator<Item = (ObjectId, &Object)> {
        ids(self.objects.len()).zip(&self.objects).filter(|(_, object)| object.exists())
    }

    /// What stands directly in or on `parent`, in order of ids.
    pub fn children(&self, parent: ObjectId) -> impl Iterator<Item = ObjectId> + '_ {
        ids(self.objects.len()).filter(move |id| self.at(*id).parent() == Some(parent))
    }

    /// The receptacles that `id` is in, from the nearest outwards.
    pub fn ancestors(&self, id: ObjectId) -> impl Iterator<Item = ObjectId> + '_ {
        std::iter::successors(self.at(id).parent(), |id| self.at(*id).parent())
    }

    /// The object of this instance id, if it is in the world.
    pub fn find(&self, instance: &str) -> Option<ObjectId> {
        self.existing()
            .find(|(_, object)| object.instance == instance)
            .or_else(|| self.existing().find(|(_, object)| object.is_called(instance)))
            .map(|(id, _)| id)
    }

    /// The body at `id`, if the id is of this world.
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.bodies.get(id.0 as usize)
    }
}

/// The first `count` object ids.
pub(crate) fn ids(count: usize) -> impl Iterator<Item = ObjectId> {
    (0..u32::try_from(count).expect("invariant: fewer than 2^32 objects")).map(ObjectId)
}

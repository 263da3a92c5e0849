//! What rules, works and goals may read: the constant parts of a world beside a borrowed state.

use cohabit_cdf::{Catalog, ObjectClass, ObjectId, Property, RoomId, StateFlag};
use glam::{Vec2, Vec3};

use crate::{
    entity::{Object, Support},
    floor::Floor,
    geometry::Footprint,
    state::State,
};

/// A read-only view of everything.
#[derive(Clone, Copy)]
pub(crate) struct Facts<'a> {
    pub catalog: &'a Catalog,
    pub floor: &'a Floor,
    pub state: &'a State,
}

impl<'a> Facts<'a> {
    /// The object at an id of this world.
    pub fn object(&self, id: ObjectId) -> &'a Object {
        self.state.at(id)
    }

    /// Its class.
    pub fn class(&self, id: ObjectId) -> &'a ObjectClass {
        self.catalog.class(self.object(id).class)
    }

    /// What people call it, with the article: `the fridge`.
    pub fn name(&self, id: ObjectId) -> String {
        let class = self.class(id);
        let word =
            if class.name.is_empty() { class.words.first().map_or("thing", String::as_str) } else { &class.name };
        format!("the {}", word.to_lowercase())
    }

    /// Whether it affords `property`.
    pub fn has(&self, id: ObjectId, property: Property) -> bool {
        self.class(id).has(property)
    }

    /// Whether `flag` is set.
    pub fn is(&self, id: ObjectId, flag: StateFlag) -> bool {
        self.object(id).flags.has(flag)
    }

    /// Whether its contents are behind something shut.
    pub fn is_shut(&self, id: ObjectId) -> bool {
        let class = self.class(id);
        class.has(Property::Openable)
            && class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed)
            && !self.is(id, StateFlag::Opened)
    }

    /// The nearest shut receptacle around `id`.
    pub fn shut_around(&self, id: ObjectId) -> Option<ObjectId> {
        std::iter::successors(Some(id), |id| self.object(*id).parent())
            .filter(|id| self.is_within(*id))
            .filter_map(|id| self.object(id).parent())
            .find(|parent| self.is_shut(*parent))
    }

    /// Whether it is in what holds it, not on the top of that: a microwave on a cupboard is not in the cupboard.
    pub fn is_within(&self, id: ObjectId) -> bool {
        const LID_M: f32 = 0.02;
        match self.object(id).support {
            Support::On { parent, local, .. } => {
                let receptacle = self.class(parent).receptacle.as_ref();
                let enclosed = receptacle.is_some_and(|receptacle| receptacle.enclosed);
                !enclosed || local.position.z < self.size(parent).z - LID_M
            }
            _ => false,
        }
    }

    /// What is directly in or on a receptacle, less what stands on the top of a closed kind.
    pub fn held_in(&self, receptacle: ObjectId) -> Vec<ObjectId> {
        self.state.children(receptacle).filter(|child| self.is_within(*child)).collect()
    }

    /// The same at any depth, nearest first.
    pub fn contents(&self, receptacle: ObjectId) -> Vec<ObjectId> {
        let mut found = self.held_in(receptacle);
        let mut next = 0;
        while next < found.len() {
            let deeper = self.held_in(found[next]);
            found.extend(deeper);
            next += 1;
        }
        found
    }

    /// Its extent, scaled, m.
    pub fn size(&self, id: ObjectId) -> Vec3 {
        Vec3::from(self.class(id).size_m) * Vec3::from(self.object(id).scale)
    }

    /// The rectangle it covers, seen from above.
    pub fn footprint(&self, id: ObjectId) -> Footprint {
        let object = self.object(id);
        let half = self.size(id).truncate() / 2.0;
        Footprint::new(object.pose.position.truncate(), half, object.pose.yaw_rad())
    }

    /// Where to aim and reach, in the world.
    pub fn aim_point(&self, id: ObjectId) -> Vec3 {
        let object = self.object(id);
        let local = self.class(id).handle_m.map_or(Vec3::new(0.0, 0.0, self.class(id).size_m[2] / 2.0), Vec3::from);
        object.pose.point(local * Vec3::from(object.scale))
    }

    /// How far a hand at `from` has to reach to it, level, m.
    pub fn reach_to(&self, id: ObjectId, from: Vec2) -> f32 {
        self.footprint(id).distance(from).min(self.aim_point(id).truncate().distance(from))
    }

    /// The objects of a class in a room, in order of ids.
    pub fn of_class_in(&self, class: &'a str, room: RoomId) -> impl Iterator<Item = ObjectId> + 'a {
        let catalog = self.catalog;
        self.state
            .existing()
            .filter(move |(_, object)| object.room == room && catalog.class(object.class).id == class)
            .map(|(id, _)| id)
    }
}

//! A world as the table of actions and devices asks about it.

use cohabit_cdf::{
    BodyId, Catalog, Fluid, ObjectClass, ObjectId, StateFlag,
    catalog::table::{Range, View},
};

use super::{Scene, doors::opens, doors_of_buttons, is_doorway_clear, places, works};
use crate::{anchors::free_anchors, facts::Facts, works as machines, works::portal};

/// The facts as one body finds them, or as nobody does.
pub(crate) struct Observer<'a> {
    pub facts: &'a Facts<'a>,
    pub body: Option<BodyId>,
    /// What something is to be put beside, if that was said.
    pub beside: Option<ObjectId>,
}

impl View for Observer<'_> {
    fn catalog(&self) -> &Catalog {
        self.facts.catalog
    }

    fn exists(&self, id: ObjectId) -> bool {
        self.facts.object(id).exists()
    }

    fn class(&self, id: ObjectId) -> &ObjectClass {
        self.facts.class(id)
    }

    fn is(&self, id: ObjectId, flag: StateFlag) -> bool {
        self.facts.is(id, flag)
    }

    fn fluid(&self, id: ObjectId) -> Fluid {
        self.facts.object(id).fluid
    }

    fn held(&self) -> Option<ObjectId> {
        self.body.and_then(|body| self.facts.state.bodies[body.0 as usize].held)
    }

    fn parent(&self, id: ObjectId) -> Option<ObjectId> {
        self.facts.object(id).parent()
    }

    fn children(&self, id: ObjectId) -> Vec<ObjectId> {
        self.facts.state.children(id).collect()
    }

    fn inside(&self, id: ObjectId) -> Vec<ObjectId> {
        self.facts.held_in(id)
    }

    fn is_in_another_hand(&self, id: ObjectId) -> bool {
        self.facts.object(id).held_by().is_some_and(|holder| Some(holder) != self.body)
    }

    fn machine(&self, id: ObjectId) -> Option<ObjectId> {
        works(self.facts, id)
    }

    fn basin(&self) -> Option<ObjectId> {
        let scene = Scene { facts: self.facts, body: self.body?, beside: self.beside };
        scene.basin()
    }

    fn cover(&self, id: ObjectId) -> Option<ObjectId> {
        self.facts.shut_around(id)
    }

    fn is_shut(&self, id: ObjectId) -> bool {
        self.facts.is_shut(id)
    }

    fn within(&self, id: ObjectId, range: Range) -> bool {
        self.body.is_none_or(|body| {
            let body = &self.facts.state.bodies[body.0 as usize];
            let far_m = match range {
                Range::Throw => body.hand().position.distance(self.facts.aim_point(id)),
                Range::Hand | Range::Sight => self.facts.reach_to(id, body.position),
            };
            far_m <= range.metres()
        })
    }

    fn is_accessible(&self, id: ObjectId) -> bool {
        self.body.is_none_or(|body| self.facts.barrier(id, self.facts.state.bodies[body.0 as usize].position).is_none())
    }

    fn is_behind_glass(&self, id: ObjectId) -> bool {
        machines::behind_glass(self.facts, id).is_some()
    }

    fn has_room(&self, id: ObjectId) -> bool {
        !places::open_anchors(self.facts, id).is_empty()
    }

    fn has_room_for(&self, id: ObjectId, thing: ObjectId) -> bool {
        self.body.is_some_and(|body| places::best_anchor(self.facts, body, id, thing, None).is_some())
    }

    fn has_free_place(&self, id: ObjectId) -> bool {
        !free_anchors(self.facts, id).is_empty()
    }

    fn sells(&self, id: ObjectId, slot: u16) -> bool {
        machines::vended(self.facts, id, slot).is_some()
    }

    fn feeds(&self, id: ObjectId) -> bool {
        self.facts.object(id).feeds.is_some()
    }

    fn gate(&self, id: ObjectId) -> Option<bool> {
        let known = self.facts.state.portals.contains_key(&id);
        known.then(|| portal::open_gate(self.facts, id).is_some())
    }

    fn lets_pass(&self, gate: ObjectId, thing: ObjectId) -> bool {
        let gate = self.facts.state.portals.get(&gate);
        gate.is_some_and(|gate| portal::lets_pass(self.facts, gate, thing))
    }

    fn is_clear(&self, id: ObjectId) -> bool {
        is_doorway_clear(self.facts, id)
    }

    fn doors_are_clear(&self) -> bool {
        let doors = doors_of_buttons(self.facts);
        opens(self.facts, &doors) || doors.into_iter().all(|door| is_doorway_clear(self.facts, door))
    }
}

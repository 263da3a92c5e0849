//! The state of a world as symbols, for who predicts or plans: see [`SymbolicState`].

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_cdf::{
    BodyId, ObjectId, RoomId,
    symbolic::{Access, Gate, Place, SymbolicState, Thing},
};

use crate::{
    anchors::{anchors, covers},
    entity::Support,
    facts::Facts,
    mission_state, rules,
    state::ids,
    works::portal,
    world::World,
};

impl World {
    /// All that a body may find and change, as symbols; what is in reach is so from where it stands.
    ///
    /// # Panics
    /// When the body is of another world.
    #[must_use]
    pub fn symbols(&self, body: BodyId) -> SymbolicState {
        let facts = self.facts();
        let own = &self.state.bodies[body.0 as usize];
        let all: Vec<ObjectId> = ids(self.state.objects.len()).collect();
        SymbolicState {
            catalog: Arc::clone(self.catalog()),
            things: all.iter().map(|id| thing(&facts, body, *id)).collect(),
            held: own.held,
            alive: own.alive,
            circuits: self.state.circuits.clone(),
            doors: rules::doors_of_buttons(&facts),
            gates: self.state.portals.iter().map(|(id, gate)| (*id, symbolic_gate(gate))).collect(),
            passes: self.state.passes.clone(),
            eaters: eaters(&facts, &all),
            fed: self.state.dinosaurs.iter().filter(|(_, dino)| dino.fed).map(|(id, _)| *id).collect(),
        }
    }

    /// The rooms that have a door or a passage between them, with the door if there is one.
    pub fn passages(&self) -> impl Iterator<Item = ([RoomId; 2], Option<ObjectId>)> + '_ {
        self.floor.gaps.iter().map(|gap| (gap.between, gap.door_object))
    }
}

fn thing(facts: &Facts<'_>, body: BodyId, id: ObjectId) -> Thing {
    let object = facts.object(id);
    let own = &facts.state.bodies[body.0 as usize];
    let place = match object.support {
        Support::Fixed => Place::Own,
        Support::Loose => Place::Loose,
        Support::Gone => Place::Gone,
        Support::Held(holder) if holder == body => Place::Held,
        Support::Held(_) => Place::InAnotherHand,
        Support::On { parent, anchor, .. } => {
            let covered = anchor.map_or_else(|| covered(facts, id, parent), |anchor| vec![anchor]);
            Place::On { parent, anchors: covered, within: facts.is_within(id) }
        }
    };
    let access = Access {
        reach_m: facts.reach_to(id, own.position),
        throw_m: own.hand().position.distance(facts.aim_point(id)),
        is_barred: object.exists() && facts.barrier(id, own.position).is_some(),
        is_clear: rules::is_doorway_clear(facts, id),
    };
    Thing {
        instance: object.instance.clone(),
        aliases: object.aliases.clone(),
        class: object.class,
        room: object.room,
        place,
        flags: object.flags,
        fluid: object.fluid,
        color: object.color,
        scale: object.scale,
        works: rules::works(facts, id),
        circuit: object.circuit,
        feeds: object.feeds,
        yesterday: object.yesterday,
        was: object.was,
        prints: object.prints,
        touched: object.touched,
        access,
    }
}

/// The anchors that something covers which a floor plan put somewhere between them.
fn covered(facts: &Facts<'_>, id: ObjectId, parent: ObjectId) -> Vec<u16> {
    let all = anchors(facts, parent).into_iter().map(|anchor| anchor.index);
    all.filter(|index| covers(facts, id, parent, *index)).collect()
}

fn symbolic_gate(gate: &mission_state::Gate) -> Gate {
    Gate { ways: gate.ways.iter().map(|way| (way.name.clone(), way.era)).collect(), current: gate.current }
}

fn eaters(facts: &Facts<'_>, all: &[ObjectId]) -> BTreeMap<ObjectId, BTreeSet<ObjectId>> {
    let likes = |dino: ObjectId| all.iter().copied().filter(|id| portal::likes(facts, dino, *id)).collect();
    facts.state.dinosaurs.keys().map(|dino| (*dino, likes(*dino))).collect()
}

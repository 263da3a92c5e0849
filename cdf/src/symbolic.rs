//! A world as symbols: what is in which state and in or on what, with geometry boiled down to what is in reach.
//!
//! [`SymbolicState::successor`] predicts with the table of actions and devices what an action leads to. A world hands
//! its state over in this form; a planner searches in it. It knows no time: a machine has run when its action is over.

mod places;
mod successor;

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

pub use self::successor::Successor;
use crate::{
    action::ObjectId,
    catalog::{
        Catalog, ClassId, ObjectClass,
        table::{Range, View},
    },
    mission::Era,
    room::RoomId,
    state::{Color, Fluid, StateFlag, StateFlags},
};

/// Where a thing is.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Place {
    /// At its own place, on the floor or on a wall.
    Own,
    /// In or on a receptacle.
    On {
        /// Which.
        parent: ObjectId,
        /// The anchors that it takes there.
        anchors: Vec<u16>,
        /// Whether it is in it, not on the top of it.
        within: bool,
    },
    /// In the hand of the body.
    Held,
    /// In the hand of another body.
    InAnotherHand,
    /// In flight, or wherever it came to lie.
    Loose,
    /// Not in the world.
    Gone,
}

/// What geometry says of a thing, from where the body stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Access {
    /// How far a hand has to reach, m.
    pub reach_m: f32,
    /// How far a throw has to fly, m.
    pub throw_m: f32,
    /// Whether a wall, a door or a side of furniture is between.
    pub is_barred: bool,
    /// Whether nobody stands in its doorway.
    pub is_clear: bool,
}

impl Access {
    /// At hand.
    pub const AT_HAND: Self = Self { reach_m: 0.0, throw_m: 0.0, is_barred: false, is_clear: true };
}

/// One thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    /// Its id in missions.
    pub instance: String,
    /// Other ids it answers to.
    pub aliases: Vec<String>,
    /// Its class.
    pub class: ClassId,
    /// The room it is in.
    pub room: RoomId,
    /// Where it is.
    pub place: Place,
    /// Its states.
    pub flags: StateFlags,
    /// What fills it.
    pub fluid: Fluid,
    /// Its colour.
    pub color: Color,
    /// Scale of its size along x, y, z.
    pub scale: [f32; 3],
    /// What it works, or aims at.
    pub works: Option<ObjectId>,
    /// The circuit that feeds it.
    pub circuit: Option<i32>,
    /// The circuit that it switches.
    pub feeds: Option<i32>,
    /// What it was yesterday, if the mission says so.
    pub yesterday: Option<ClassId>,
    /// The thing that it was before a machine changed it.
    pub was: Option<ObjectId>,
    /// What it makes a printer print, if the mission says so.
    pub prints: Option<ClassId>,
    /// Whether anybody did something to it.
    pub touched: bool,
    /// How it can be got at.
    pub access: Access,
}

impl Thing {
    /// A thing with no states, at hand, that nothing feeds.
    #[must_use]
    pub fn new(instance: String, class: ClassId, room: RoomId, place: Place) -> Self {
        Self {
            instance,
            aliases: Vec::new(),
            class,
            room,
            place,
            flags: StateFlags::default(),
            fluid: Fluid::None,
            color: Color::Original,
            scale: [1.0; 3],
            works: None,
            circuit: None,
            feeds: None,
            yesterday: None,
            was: None,
            prints: None,
            touched: false,
            access: Access::AT_HAND,
        }
    }
}

/// A portal: the times that it leads to, by name, and which one is next or now.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Gate {
    /// The times.
    pub ways: Vec<(String, Era)>,
    /// The index of the one that counts.
    pub current: usize,
}

/// The state of a world for one body.
#[derive(Clone, Debug)]
pub struct SymbolicState {
    /// The catalogue that its classes are of.
    pub catalog: Arc<Catalog>,
    /// All things by [`ObjectId`], also those that left.
    pub things: Vec<Thing>,
    /// What the body holds.
    pub held: Option<ObjectId>,
    /// Whether the body is in order.
    pub alive: bool,
    /// Circuits that are switched, and whether they are fed.
    pub circuits: BTreeMap<i32, bool>,
    /// The doors that security buttons work.
    pub doors: Vec<ObjectId>,
    /// Portals.
    pub gates: BTreeMap<ObjectId, Gate>,
    /// The portals, by name, that things go through; what is not here goes through all.
    pub passes: BTreeMap<ObjectId, Vec<String>>,
    /// What eats what goes to it: the things that it likes.
    pub eaters: BTreeMap<ObjectId, BTreeSet<ObjectId>>,
    /// Those of them that were fed.
    pub fed: BTreeSet<ObjectId>,
}

impl SymbolicState {
    /// The thing at an id.
    ///
    /// # Panics
    /// When the id is of another world.
    #[must_use]
    pub fn thing(&self, id: ObjectId) -> &Thing {
        &self.things[id.0 as usize]
    }

    /// The ids of all things that are in the world, in order.
    pub fn existing(&self) -> impl Iterator<Item = ObjectId> + '_ {
        (0..).map(ObjectId).zip(&self.things).filter(|(_, thing)| thing.place != Place::Gone).map(|(id, _)| id)
    }

    /// Takes all things to be at hand: what a body finds that goes where it has to.
    pub fn ignore_distance(&mut self) {
        self.things.iter_mut().for_each(|thing| thing.access = Access::AT_HAND);
    }

    /// What a device aims at, or what its machine does.
    fn target(&self, device: ObjectId) -> Option<ObjectId> {
        self.thing(self.thing(device).works?).works
    }
}

impl View for SymbolicState {
    fn catalog(&self) -> &Catalog {
        &self.catalog
    }

    fn exists(&self, id: ObjectId) -> bool {
        self.thing(id).place != Place::Gone
    }

    fn class(&self, id: ObjectId) -> &ObjectClass {
        self.catalog.class(self.thing(id).class)
    }

    fn is(&self, id: ObjectId, flag: StateFlag) -> bool {
        self.thing(id).flags.has(flag)
    }

    fn fluid(&self, id: ObjectId) -> Fluid {
        self.thing(id).fluid
    }

    fn held(&self) -> Option<ObjectId> {
        self.held
    }

    fn parent(&self, id: ObjectId) -> Option<ObjectId> {
        match self.thing(id).place {
            Place::On { parent, .. } => Some(parent),
            _ => None,
        }
    }

    fn children(&self, id: ObjectId) -> Vec<ObjectId> {
        self.existing().filter(|child| self.parent(*child) == Some(id)).collect()
    }

    fn inside(&self, id: ObjectId) -> Vec<ObjectId> {
        let is_in = |child: &ObjectId| matches!(self.thing(*child).place, Place::On { parent, within: true, .. } if parent == id);
        self.existing().filter(is_in).collect()
    }

    fn is_in_another_hand(&self, id: ObjectId) -> bool {
        self.thing(id).place == Place::InAnotherHand
    }

    fn machine(&self, id: ObjectId) -> Option<ObjectId> {
        self.thing(id).works
    }

    fn basin(&self) -> Option<ObjectId> {
        let table = self.catalog.table();
        let is_at_hand = |id: &ObjectId| {
            self.cover(*id).is_none()
                && self.within(*id, Range::Hand)
                && self.is_accessible(*id)
                && !self.is(*id, StateFlag::Sparking)
        };
        let basins = self.existing().filter(|id| table.is_basin(&self.class(*id).id)).filter(is_at_hand);
        basins.min_by_key(|id| !self.is(*id, StateFlag::Toggled))
    }

    fn within(&self, id: ObjectId, range: Range) -> bool {
        let access = self.thing(id).access;
        let far = if range == Range::Throw { access.throw_m } else { access.reach_m };
        far <= range.metres()
    }

    fn is_accessible(&self, id: ObjectId) -> bool {
        !self.thing(id).access.is_barred
    }

    fn is_behind_glass(&self, id: ObjectId) -> bool {
        std::iter::successors(Some(id), |id| self.parent(*id)).any(|id| self.is_in_slot(id))
    }

    fn has_room(&self, id: ObjectId) -> bool {
        self.free_anchors(id).into_iter().any(|anchor| !self.is_slot(id, anchor.index))
    }

    fn has_room_for(&self, id: ObjectId, thing: ObjectId) -> bool {
        self.place_for(id, thing).is_some()
    }

    fn has_free_place(&self, id: ObjectId) -> bool {
        !self.free_anchors(id).is_empty()
    }

    fn sells(&self, id: ObjectId, slot: u16) -> bool {
        self.in_slot(id, slot).is_some()
    }

    fn feeds(&self, id: ObjectId) -> bool {
        self.thing(id).feeds.is_some()
    }

    fn gate(&self, id: ObjectId) -> Option<bool> {
        let known = self.gates.contains_key(&id);
        known.then(|| self.exists(id) && self.is(id, StateFlag::Toggled) && self.is_powered(id))
    }

    fn lets_pass(&self, gate: ObjectId, thing: ObjectId) -> bool {
        let Some(gate) = self.gates.get(&gate) else { return false };
        self.passes.get(&thing).is_none_or(|names| names.contains(&gate.ways[gate.current].0))
    }

    fn is_clear(&self, id: ObjectId) -> bool {
        self.thing(id).access.is_clear
    }

    fn doors_are_clear(&self) -> bool {
        let opens = self.doors.iter().any(|door| !self.is(*door, StateFlag::Opened));
        opens || self.doors.iter().all(|door| self.is_clear(*door))
    }
}

//! What an agent takes to be possible with the things that it remembers, by the table of actions.

use cohabit_bus::message::NONE;
use cohabit_cdf::{
    ActionKind, Catalog, ClassId, Fluid, ObjectClass, ObjectId, Property, StateFlag, catalog::table::View,
};

use crate::memory::{Memory, Remembered, flags};

/// What an agent tries on things that it comes across. It examines what is there to be looked at.
const TRIED: [ActionKind; 9] = [
    ActionKind::PickUp,
    ActionKind::Place,
    ActionKind::Open,
    ActionKind::Close,
    ActionKind::Toggle,
    ActionKind::Pour,
    ActionKind::Break,
    ActionKind::Clean,
    ActionKind::Examine,
];

/// The things that somebody remembers, as the table asks about them.
pub(crate) struct Known<'a> {
    pub memory: &'a Memory,
    pub catalog: &'a Catalog,
    /// What is in the hand.
    pub held: Option<ObjectId>,
}

impl Known<'_> {
    /// All that seems possible with a thing that it remembers. Whoever plays leaves alone what is live.
    pub fn afforded(&self, id: ObjectId) -> Vec<ActionKind> {
        let class = self.class(id);
        let table = self.catalog.table();
        if self.thing(id).is_none() || table.device(&class.id).dangerous {
            return Vec::new();
        }
        let makes_sense = |kind: &ActionKind| *kind != ActionKind::Examine || class.has(Property::Decor);
        let is_allowed = |kind: &ActionKind| table.judge(self, *kind, id).is_some_and(|judged| judged.is_allowed());
        TRIED.into_iter().filter(makes_sense).filter(is_allowed).collect()
    }

    fn thing(&self, id: ObjectId) -> Option<&Remembered> {
        let known = self.memory.thing(id)?;
        (usize::from(known.record.class) < self.catalog.classes().len()).then_some(known)
    }
}

/// What it never saw is nothing that it could act on.
impl View for Known<'_> {
    fn catalog(&self) -> &Catalog {
        self.catalog
    }

    fn exists(&self, id: ObjectId) -> bool {
        self.thing(id).is_some()
    }

    fn class(&self, id: ObjectId) -> &ObjectClass {
        self.catalog.class(self.thing(id).map_or(ClassId(0), |thing| ClassId(thing.record.class)))
    }

    fn is(&self, id: ObjectId, flag: StateFlag) -> bool {
        self.thing(id).is_some_and(|thing| flags(&thing.record).has(flag))
    }

    fn fluid(&self, id: ObjectId) -> Fluid {
        let fluid = self.thing(id).map_or(0, |thing| thing.record.fluid);
        Fluid::ALL.get(usize::from(fluid)).copied().unwrap_or_default()
    }

    fn held(&self) -> Option<ObjectId> {
        self.held
    }

    fn parent(&self, id: ObjectId) -> Option<ObjectId> {
        let parent = self.thing(id).map(|thing| thing.record.parent).filter(|parent| *parent != NONE)?;
        self.memory.thing(ObjectId(parent)).map(|_| ObjectId(parent))
    }

    fn children(&self, id: ObjectId) -> Vec<ObjectId> {
        self.memory.things().filter(|(_, thing)| thing.record.parent == id.0).map(|(id, _)| id).collect()
    }

    fn is_in_another_hand(&self, id: ObjectId) -> bool {
        self.held != Some(id) && self.thing(id).is_some_and(|thing| thing.record.held_by != NONE)
    }

    fn machine(&self, id: ObjectId) -> Option<ObjectId> {
        let works = self.thing(id).map(|thing| thing.record.works).filter(|works| *works != NONE)?;
        self.memory.thing(ObjectId(works)).map(|_| ObjectId(works))
    }

    fn basin(&self) -> Option<ObjectId> {
        let table = self.catalog.table();
        self.memory.things().map(|(id, _)| id).find(|id| table.is_basin(&self.class(*id).id))
    }
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::ObjectRecord;

    use super::*;

    fn check(class: &str, states: &[StateFlag], held: Option<&str>, expected: &[ActionKind]) {
        let catalog = Catalog::builtin();
        let record = |object: u32, class: &str, states: &[StateFlag]| {
            let flags = states.iter().fold(0, |flags, flag| flags | 1 << *flag as u32);
            let class = catalog.find(class).unwrap().0;
            ObjectRecord { object, class, flags, parent: NONE, held_by: NONE, works: NONE, ..ObjectRecord::default() }
        };
        let mut memory = Memory::default();
        memory.see(record(7, class, states), 1);
        if let Some(held) = held {
            memory.see(record(8, held, &[StateFlag::PickedUp]), 1);
        }
        let known = Known { memory: &memory, catalog: &catalog, held: held.map(|_| ObjectId(8)) };
        assert_eq!(known.afforded(ObjectId(7)), expected, "{class} {states:?} with {held:?}");
    }

    #[test]
    fn what_is_tried_depends_on_the_thing_its_state_and_the_hand() {
        use ActionKind::{Break, Close, Open, PickUp, Place, Toggle};
        use StateFlag::{Broken, Opened, Powered, Sparking};
        check("FridgeLower_02", &[Powered], None, &[Open]);
        check("FridgeLower_02", &[Powered, Opened], None, &[Close]);
        check("FridgeLower_02", &[Powered, Opened, Sparking], None, &[]);
        check("Bowl_01", &[], None, &[PickUp]);
        check("Bowl_01", &[], Some("Hammer"), &[Break]);
        check("Bowl_01", &[Broken], Some("Hammer"), &[]);
        check("Desk_01", &[], Some("Bowl_01"), &[Place]);
        check("LightSwitch_01", &[Powered], None, &[Toggle]);
        check("FuseBox_01", &[Powered, Opened], None, &[]);
    }
}

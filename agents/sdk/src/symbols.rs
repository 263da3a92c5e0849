//! The state of the world as symbols, kept up to date by what is published of it.
//!
//! It begins as the world began. What is published overwrites what it holds; what is not (where a portal leads, who was fed)
//! follows from the body's own deeds, by the table of actions.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_bus::message::{NONE, ObjectRecord, StateView};
use cohabit_cdf::{
    Action, ActionKind, Catalog, ClassId, Color, Fluid, ObjectId, Property, RoomId, StateFlag, StateFlags,
    symbolic::{Place, SymbolicState, Thing},
};

/// Things that may come into a world beyond those that are known: more are nonsense.
const MOST_NEW: usize = 4096;

/// What one body knows who knows everything.
#[derive(Debug)]
pub(crate) struct Symbols {
    body: u32,
    state: SymbolicState,
}

impl Symbols {
    /// The state in which the world began.
    pub fn new(body: u32, mut first: SymbolicState) -> Self {
        first.ignore_distance();
        Self { body, state: first }
    }

    /// The state as it is now.
    pub const fn state(&self) -> &SymbolicState {
        &self.state
    }

    /// The body did something: takes over what that leads to.
    pub fn did(&mut self, action: Action) {
        let about = ActionKind::of(&action).filter(|(kind, id)| *kind != ActionKind::GoTo && self.knows(id.0));
        let Some(next) = about.and_then(|(kind, id)| self.state.successor(kind, id)) else { return };
        if next.status.is_success() {
            self.state = next.state;
            self.state.ignore_distance();
        }
    }

    /// Takes in what is published.
    pub fn take_in(&mut self, view: StateView<'_>) {
        let classes = self.state.catalog.classes().len();
        let most = self.state.things.len() + MOST_NEW;
        let is_sound = |record: &&ObjectRecord| usize::from(record.class) < classes && (record.object as usize) < most;
        let records: Vec<&ObjectRecord> = view.objects.iter().filter(is_sound).collect();
        for record in &records {
            while !self.knows(record.object) {
                let thing = unknown(record, &self.state.catalog);
                self.state.things.push(thing);
            }
        }
        let there: BTreeSet<u32> = records.iter().map(|record| record.object).collect();
        for (index, thing) in (0_u32..).zip(&mut self.state.things) {
            if !there.contains(&index) {
                thing.place = Place::Gone;
            }
        }
        records.iter().for_each(|record| self.note(record));
        records.iter().for_each(|record| self.find(record));
        let own = view.bodies.iter().find(|record| record.body == self.body);
        self.state.held = own.map(|record| record.held).filter(|held| self.knows(*held)).map(ObjectId);
        // 2: a hazard has ended the mission.
        self.state.alive = view.header.ending != 2;
        self.note_circuits();
    }

    const fn knows(&self, object: u32) -> bool {
        (object as usize) < self.state.things.len()
    }

    /// Takes over what a record says of a thing itself, and whether a hand has it.
    fn note(&mut self, record: &ObjectRecord) {
        let works = Some(record.works).filter(|works| self.knows(*works)).map(ObjectId);
        let held_by_me = record.held_by == self.body;
        let room = self.state.catalog.room_at(u32::from(record.room));
        let thing = &mut self.state.things[record.object as usize];
        if thing.instance != record.instance.as_str() {
            record.instance.as_str().clone_into(&mut thing.instance);
        }
        thing.class = ClassId(record.class);
        thing.room = room.unwrap_or(thing.room);
        thing.flags = StateFlags(record.flags);
        thing.fluid = Fluid::ALL.get(usize::from(record.fluid)).copied().unwrap_or_default();
        thing.color = Color::ALL.get(usize::from(record.color)).copied().unwrap_or_default();
        // What nothing says of it follows from where it stands, as the world has worked out.
        thing.works = works.or(thing.works);
        let is_found = |parent: ObjectId| parent.0 == record.parent;
        thing.place = match &thing.place {
            _ if record.held_by != NONE => {
                if held_by_me {
                    Place::Held
                } else {
                    Place::InAnotherHand
                }
            }
            Place::Own if record.parent == NONE => Place::Own,
            place @ Place::On { parent, .. } if is_found(*parent) => place.clone(),
            _ => Place::Loose,
        };
    }

    /// Puts a thing where a record says that it stands, if it was elsewhere.
    fn find(&mut self, record: &ObjectRecord) {
        let (id, parent) = (ObjectId(record.object), ObjectId(record.parent));
        if self.state.thing(id).place == Place::Loose && record.parent != record.object && self.knows(parent.0) {
            self.state.found_on(id, parent);
        }
    }

    /// A circuit is fed where what hangs on it has power.
    fn note_circuits(&mut self) {
        let state = &mut self.state;
        let mut fed = BTreeMap::new();
        for thing in state.things.iter().filter(|thing| thing.place != Place::Gone) {
            let Some(circuit) = thing.circuit else { continue };
            if state.catalog.class(thing.class).has(Property::Powerable) {
                fed.insert(circuit, thing.flags.has(StateFlag::Powered));
            }
        }
        for (circuit, is_fed) in &mut state.circuits {
            *is_fed = fed.get(circuit).copied().unwrap_or(*is_fed);
        }
    }
}

/// A thing that came into the world, or left it before anything was heard of it.
fn unknown(record: &ObjectRecord, catalog: &Catalog) -> Thing {
    let room = catalog.room_at(u32::from(record.room)).unwrap_or(RoomId::BREAK_ROOM);
    Thing::new(String::new(), ClassId(record.class), room, Place::Gone)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_bus::{
        Text,
        message::{BodyRecord, StateHeader},
    };

    use super::*;

    const BOWL: u32 = 0;
    const TABLE: u32 = 1;

    fn symbols() -> Symbols {
        let catalog = Arc::new(Catalog::builtin());
        let thing = |class: &str, place| {
            let id = catalog.find(class).unwrap();
            let record = ObjectRecord { class: id.0, ..ObjectRecord::default() };
            Thing { instance: format!("{class}_1"), place, ..unknown(&record, &catalog) }
        };
        let things = vec![thing("Bowl_01", Place::Loose), thing("TableRound_02", Place::Own)];
        let (circuits, gates, passes, eaters) = Default::default();
        let (doors, fed) = Default::default();
        let first =
            SymbolicState { catalog, things, held: None, alive: true, circuits, doors, gates, passes, eaters, fed };
        Symbols::new(0, first)
    }

    fn records(symbols: &Symbols) -> Vec<ObjectRecord> {
        let record = |(object, thing): (u32, &Thing)| ObjectRecord {
            object,
            class: thing.class.0,
            parent: NONE,
            held_by: NONE,
            works: NONE,
            instance: Text::new(&thing.instance),
            ..ObjectRecord::default()
        };
        (0..).zip(&symbols.state.things).map(record).collect()
    }

    fn take_in(symbols: &mut Symbols, objects: &[ObjectRecord], held: u32) {
        let header = StateHeader::default();
        let bodies = [BodyRecord { held, ..BodyRecord::default() }];
        symbols.take_in(StateView { header: &header, bodies: &bodies, objects, goals: &[], notes: &[] });
    }

    fn place(symbols: &Symbols, object: u32) -> &Place {
        &symbols.state.thing(ObjectId(object)).place
    }

    #[test]
    fn things_are_where_records_say() {
        let mut symbols = symbols();
        let mut objects = records(&symbols);
        objects[0].parent = TABLE;
        take_in(&mut symbols, &objects, NONE);
        assert!(matches!(place(&symbols, BOWL), Place::On { parent: ObjectId(TABLE), within: true, .. }));
        assert_eq!(place(&symbols, TABLE), &Place::Own);
        (objects[0].parent, objects[0].held_by) = (NONE, 0);
        take_in(&mut symbols, &objects, BOWL);
        assert_eq!((place(&symbols, BOWL), symbols.state.held), (&Place::Held, Some(ObjectId(BOWL))));
        objects[0].held_by = 3;
        take_in(&mut symbols, &objects, NONE);
        assert_eq!((place(&symbols, BOWL), symbols.state.held), (&Place::InAnotherHand, None));
        take_in(&mut symbols, &objects[1..], NONE);
        assert_eq!(place(&symbols, BOWL), &Place::Gone);
    }

    #[test]
    fn what_comes_into_the_world_is_known_and_nonsense_is_not() {
        let mut symbols = symbols();
        let mut objects = records(&symbols);
        let new = ObjectRecord { object: 4, instance: Text::new("Bowl_01_2"), parent: TABLE, ..objects[0] };
        let nonsense = ObjectRecord { object: u32::MAX - 1, ..objects[0] };
        let no_class = ObjectRecord { object: 5, class: u16::MAX, ..objects[0] };
        let nowhere = ObjectRecord { parent: 7_000, ..objects[0] };
        objects.extend([new, nonsense, no_class, nowhere]);
        take_in(&mut symbols, &objects, 9_000);
        assert_eq!(symbols.state.things.len(), 5);
        assert_eq!(symbols.state.thing(ObjectId(4)).instance, "Bowl_01_2");
        assert_eq!([2, 3].map(|gap| place(&symbols, gap).clone()), [Place::Gone, Place::Gone]);
        assert_eq!(symbols.state.held, None);
    }
}

//! What an agent remembers of the things and the people that it saw.

use std::collections::BTreeMap;

use cohabit_bus::message::{BodyRecord, ObjectRecord};
use cohabit_cdf::{ObjectId, StateFlags};

use crate::eyes::Sight;

/// No office holds more; a peer that invents things must not fill the memory.
const MOST_THINGS: usize = 4096;
/// What shows fewer pixels is overlooked.
const LEAST_PIXELS: u32 = 12;

/// A thing as it was when it was last seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Remembered {
    pub record: ObjectRecord,
    /// The tick at which it was last seen.
    pub seen: u64,
    /// The tick since which it was seen in this state.
    pub since: u64,
}

/// Somebody who was seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub record: BodyRecord,
    pub seen: u64,
}

/// All that was seen, in the order of ids.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    things: BTreeMap<ObjectId, Remembered>,
    bodies: BTreeMap<u32, Met>,
}

impl Memory {
    /// Takes in what is in view at a tick.
    pub fn take_in(&mut self, sight: &Sight<'_>, tick: u64) {
        for thing in sight.things().filter(|thing| thing.seen.pixels >= LEAST_PIXELS) {
            if let Some(record) = thing.object {
                self.see(*record, tick);
            }
            if let Some(record) = thing.body {
                self.bodies.insert(record.body, Met { record: *record, seen: tick });
            }
        }
    }

    pub fn see(&mut self, record: ObjectRecord, tick: u64) {
        let id = ObjectId(record.object);
        if self.things.len() >= MOST_THINGS && !self.things.contains_key(&id) {
            return;
        }
        let thing = self.things.entry(id).or_insert(Remembered { record, seen: tick, since: tick });
        if thing.record.flags != record.flags || thing.record.parent != record.parent {
            thing.since = tick;
        }
        (thing.record, thing.seen) = (record, tick);
    }

    /// The things, in the order of their ids.
    pub fn things(&self) -> impl Iterator<Item = (ObjectId, &Remembered)> {
        self.things.iter().map(|(id, thing)| (*id, thing))
    }

    /// One of them.
    pub fn thing(&self, id: ObjectId) -> Option<&Remembered> {
        self.things.get(&id)
    }

    /// Who was seen since a tick.
    pub fn bodies_since(&self, tick: u64) -> impl Iterator<Item = &BodyRecord> {
        self.bodies.values().filter(move |met| met.seen >= tick).map(|met| &met.record)
    }

    /// A thing is not as it was, who knows how.
    pub fn forget(&mut self, id: ObjectId) {
        self.things.remove(&id);
    }
}

/// The states of a thing.
pub(crate) const fn flags(record: &ObjectRecord) -> StateFlags {
    StateFlags(record.flags)
}

/// How far two places are from each other on the floor, m.
pub(crate) fn level_m(one: [f32; 3], other: [f32; 3]) -> f32 {
    let (x, y) = (one[0] - other[0], one[1] - other[1]);
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_counts_from_when_it_was_first_seen() {
        let mut memory = Memory::default();
        let shut = ObjectRecord { object: 3, ..ObjectRecord::default() };
        let open = ObjectRecord { flags: 2, ..shut };
        for (record, tick, since) in [(shut, 1, 1), (open, 5, 5), (open, 9, 5), (shut, 10, 10)] {
            memory.see(record, tick);
            let thing = memory.thing(ObjectId(3)).unwrap();
            assert_eq!((thing.since, thing.seen), (since, tick));
        }
        memory.forget(ObjectId(3));
        assert_eq!(memory.things().count(), 0);
    }

    #[test]
    fn memory_is_bounded() {
        let mut memory = Memory::default();
        for object in 0..10_000 {
            memory.see(ObjectRecord { object, ..ObjectRecord::default() }, 0);
        }
        assert_eq!(memory.things().count(), MOST_THINGS);
    }
}

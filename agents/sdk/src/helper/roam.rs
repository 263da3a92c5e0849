//! Where a helper goes when there is nothing to do.

use cohabit_cdf::{GoToTarget, RoomId};
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Viewpoints of a room, and how many of them are visited before the next room's turn comes.
const VIEWPOINTS: u64 = 8;
const VISITS: usize = 2;

/// Goes round all rooms, again and again, each time in another order.
pub(super) struct Rounds {
    rng: ChaCha8Rng,
    rooms: Vec<RoomId>,
    /// What is left of the present round, the next place last.
    left: Vec<GoToTarget>,
}

impl Rounds {
    pub fn new(seed: u64, rooms: impl Iterator<Item = RoomId>) -> Self {
        Self { rng: ChaCha8Rng::seed_from_u64(seed), rooms: rooms.collect(), left: Vec::new() }
    }

    /// Where to go next, if there is any room; the first round begins in `room`.
    pub fn next(&mut self, room: Option<RoomId>) -> Option<GoToTarget> {
        if self.left.is_empty() {
            self.begin(room);
        }
        self.left.pop()
    }

    fn begin(&mut self, room: Option<RoomId>) {
        let mut rooms = self.rooms.clone();
        for last in (1..rooms.len()).rev() {
            rooms.swap(last, usize::try_from(self.below(last as u64 + 1)).unwrap_or(0));
        }
        if let Some(here) = room.and_then(|room| rooms.iter().position(|known| *known == room)) {
            let last = rooms.len() - 1;
            rooms.swap(here, last);
        }
        for room in rooms {
            let first = self.below(VIEWPOINTS);
            // Half a room further each time.
            let numbers = (0..VISITS as u64).map(|visit| 1 + (first + visit * VIEWPOINTS / VISITS as u64) % VIEWPOINTS);
            self.left.extend(numbers.map(|number| GoToTarget::Viewpoint(room, u8::try_from(number).unwrap_or(1))));
        }
    }

    fn below(&mut self, count: u64) -> u64 {
        self.rng.next_u64() % count
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_round_goes_through_all_rooms_from_the_present_one() {
        let mut rounds = Rounds::new(7, RoomId::BUILTIN.into_iter());
        let count = RoomId::BUILTIN.len();
        let places: Vec<_> = (0..count * VISITS).map(|_| rounds.next(Some(RoomId::LAB2))).collect();
        let rooms: Vec<_> = places
            .iter()
            .map(|place| match place {
                Some(GoToTarget::Viewpoint(room, number)) if (1..=8).contains(number) => *room,
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(rooms[0], RoomId::LAB2);
        assert_eq!(rooms.iter().collect::<BTreeSet<_>>().len(), count);
    }
}

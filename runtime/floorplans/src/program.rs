//! Which rooms a building has, and how much floor each would like to have.

use crate::{chance::Chance, kind::RoomType};

/// A room that is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    pub room: &'a RoomType,
    pub area_m2: f32,
}

/// Draws `count` rooms, those that every plan of that many rooms has first.
pub fn draw<'a>(rooms: &'a [RoomType], count: usize, chance: &mut Chance) -> Vec<Wanted<'a>> {
    let is_certain = |room: &&RoomType| room.from.is_some_and(|from| from <= count);
    let (mut chosen, mut others): (Vec<&RoomType>, Vec<&RoomType>) = rooms.iter().partition(is_certain);
    while chosen.len() < count && !others.is_empty() {
        let index = chance.weighted(others.iter().map(|room| room.weight));
        chosen.push(others.remove(index));
    }
    let mut wanted = |room: &'a RoomType| Wanted { room, area_m2: chance.between(room.area_m2[0], room.area_m2[1]) };
    chosen.into_iter().map(&mut wanted).collect()
}

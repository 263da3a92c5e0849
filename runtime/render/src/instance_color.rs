//! One colour for every id, and back: how ids are shown to people, and to clients that read them from pictures.

use crate::plan::SURFACE_IDS;

/// Values of 24 bits.
const ALL: u32 = 1 << 24;
/// Where the ids of rooms' surfaces are folded to; the ids of instances are below.
const FIRST_FOLDED: u32 = ALL - (SURFACE_IDS.end - SURFACE_IDS.start);
/// Odd, so that multiplying by it is a bijection; near the golden section, so that neighbours get far apart.
const SPREAD: u32 = 0x9E_3779;
const GATHER: u32 = inverse(SPREAD);

/// The colour of an id in pictures of ids: no two ids have the same one, and that of 0, nothing, is black.
///
/// Ids of instances are below `0xFF_0000`; those of rooms' surfaces are as [`crate::room_surface_id`] makes them.
#[must_use]
pub fn instance_color(id: u32) -> [u8; 3] {
    let value = if SURFACE_IDS.contains(&id) { id - SURFACE_IDS.start + FIRST_FOLDED } else { id };
    let mixed = value.wrapping_mul(SPREAD) % ALL;
    // The upper bits differ most: they become the upper bits of red, green and blue in turn.
    let mut channels = [0_u8; 3];
    for bit in 0..24 {
        if mixed >> (23 - bit) & 1 == 1 {
            channels[bit % 3] |= 0x80 >> (bit / 3);
        }
    }
    channels
}

/// The id whose colour this is.
#[must_use]
pub fn instance_of_color(channels: [u8; 3]) -> u32 {
    let bit = |bit: usize| u32::from(channels[bit % 3] >> (7 - bit / 3) & 1) << (23 - bit);
    let mixed: u32 = (0..24).map(bit).sum();
    let value = mixed.wrapping_mul(GATHER) % ALL;
    if value >= FIRST_FOLDED { value - FIRST_FOLDED + SURFACE_IDS.start } else { value }
}

/// The inverse of an odd number among the numbers of 32 bits, by Newton's iteration.
const fn inverse(odd: u32) -> u32 {
    let mut found = odd;
    let mut round = 0;
    while round < 5 {
        found = found.wrapping_mul(2_u32.wrapping_sub(odd.wrapping_mul(found)));
        round += 1;
    }
    found
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::{RoomSurface, room_surface_id};

    #[test]
    fn every_colour_has_its_id_and_back() {
        for value in 0..ALL {
            let color = [value as u8, (value >> 8) as u8, (value >> 16) as u8];
            assert_eq!(instance_color(instance_of_color(color)), color);
        }
        assert_eq!((instance_color(0), instance_of_color([0; 3])), ([0; 3], 0));
        let wall = room_surface_id(7, RoomSurface::Lamp);
        assert_eq!(instance_of_color(instance_color(wall)), wall);
    }

    #[test]
    fn neighbours_look_different() {
        let apart = |a: u32, b: u32| {
            let (a, b) = (instance_color(a), instance_color(b));
            (0..3).map(|channel| a[channel].abs_diff(b[channel])).max()
        };
        for id in 1..2000 {
            for other in id + 1..id + 8 {
                assert!(apart(id, other) >= Some(24), "{id} and {other}");
            }
        }
    }
}

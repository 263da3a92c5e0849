//! What an image looks like in 64 bits, and which images look alike.

use std::collections::BTreeMap;

use cohabit_cdf::RoomId;

/// Cells across and down; each is compared with its neighbour to the right.
const CELLS: [usize; 2] = [9, 8];
/// How bright red, green and blue are, in 256ths (ITU-R BT.601).
const WEIGHTS: [u64; 3] = [77, 150, 29];

/// A difference hash: bit by bit whether a cell of the picture is brighter than the one to its right. `rgba` has four bytes a pixel,
/// `width` pixels a row.
pub(crate) fn look(rgba: &[u8], [width, height]: [u32; 2]) -> u64 {
    let [columns, rows] = CELLS;
    let mut cells = [[(0_u64, 0_u64); CELLS[0]]; CELLS[1]];
    for (place, pixel) in rgba.as_chunks::<4>().0.iter().enumerate() {
        let (x, y) = (place % width as usize, place / width as usize);
        let (sum, count) = &mut cells[y * rows / height as usize][x * columns / width as usize];
        *sum += WEIGHTS.iter().zip(pixel).map(|(weight, side)| weight * u64::from(*side)).sum::<u64>();
        *count += 1;
    }
    let pairs = cells.iter().flat_map(|row| row.windows(2));
    // Sums over counts, without a division.
    pairs.fold(0, |bits, pair| bits << 1 | u64::from(pair[0].0 * pair[1].1 > pair[1].0 * pair[0].1))
}

/// The looks of the images so far, by floor plan and room.
#[derive(Debug, Default)]
pub(crate) struct Looks(BTreeMap<(String, RoomId), Vec<u64>>);

impl Looks {
    /// Whether an image of that room looks like an earlier one, but for so many bits.
    pub fn has_near(&self, plan: &str, room: RoomId, look: u64, bits: u32) -> bool {
        let known = self.0.get(&(plan.to_owned(), room));
        known.is_some_and(|known| known.iter().any(|other| (other ^ look).count_ones() <= bits))
    }

    pub fn add(&mut self, plan: &str, room: RoomId, look: u64) {
        self.0.entry((plan.to_owned(), room)).or_default().push(look);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture with a brightness for each pixel.
    fn picture(size: [u32; 2], bright: impl Fn(u32, u32) -> u8) -> Vec<u8> {
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        pixels.flat_map(|(x, y)| [bright(x, y), bright(x, y), bright(x, y), 255]).collect()
    }

    #[test]
    fn slopes_and_flat_pictures_are_told_apart() {
        let size = [90, 64];
        assert_eq!(look(&picture(size, |_, _| 120), size), 0);
        assert_eq!(look(&picture(size, |x, _| x as u8), size), 0);
        assert_eq!(look(&picture(size, |x, _| 200 - x as u8), size), u64::MAX);
    }

    #[test]
    fn what_changes_little_looks_alike() {
        let size = [72, 64];
        let waves = |x: u32, y: u32| ((x / 8 * 37 + y / 8 * 91) % 200) as u8;
        let one = look(&picture(size, waves), size);
        let other = look(&picture(size, |x, y| waves(x, y) + u8::from(x == y)), size);
        let mut looks = Looks::default();
        looks.add("plan", RoomId::LAB1, one);
        assert!(looks.has_near("plan", RoomId::LAB1, other, 4));
        assert!(!looks.has_near("plan", RoomId::LAB2, other, 4) && !looks.has_near("other", RoomId::LAB1, other, 4));
        assert!(!looks.has_near("plan", RoomId::LAB1, !one, 16));
    }
}

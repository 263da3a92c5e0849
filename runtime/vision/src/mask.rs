//! What a picture of ids shows of each thing: a box, an area and a mask.

use std::collections::BTreeMap;

use crate::rle::{Rle, RleBuilder};

/// What is seen of one thing.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Mask {
    /// Its id in the picture.
    pub id: u32,
    /// The box around its pixels: the first column and row, columns and rows.
    pub bbox: [u32; 4],
    /// Its pixels.
    pub area: u32,
    /// Where they are.
    pub rle: Rle,
}

/// A mask in the making.
#[derive(Debug)]
struct Draft {
    /// The first column and row, and the last ones.
    bounds: [u32; 4],
    runs: RleBuilder,
}

impl Draft {
    fn add(&mut self, column: u32, [top, bottom]: [u32; 2], rows: u32) {
        let [left, first, right, last] = self.bounds;
        self.bounds = [left.min(column), first.min(top), right.max(column), last.max(bottom - 1)];
        self.runs.add(column * rows + top, column * rows + bottom);
    }

    fn finish(self, id: u32, pixels: u32) -> Mask {
        let [left, top, right, bottom] = self.bounds;
        let rle = self.runs.finish(pixels);
        Mask { id, bbox: [left, top, right - left + 1, bottom - top + 1], area: rle.area(), rle }
    }
}

/// The masks of all ids in a picture, `[height, width]` row-major, in order of ids; nothing (id 0) has none.
#[must_use]
pub fn masks(ids: &[u32], [width, height]: [u32; 2]) -> Vec<Mask> {
    let mut drafts: BTreeMap<u32, Draft> = BTreeMap::new();
    let mut column: Vec<u32> = Vec::with_capacity(height as usize);
    for x in 0..width {
        column.clear();
        column.extend(ids.iter().skip(x as usize).step_by(width as usize).copied());
        let mut top = 0;
        for run in column.chunk_by(|one, next| one == next) {
            let bottom = top + run.len() as u32;
            if run[0] != 0 {
                let new = || Draft { bounds: [x, top, x, bottom - 1], runs: RleBuilder::default() };
                drafts.entry(run[0]).or_insert_with(new).add(x, [top, bottom], height);
            }
            top = bottom;
        }
    }
    drafts.into_iter().map(|(id, draft)| draft.finish(id, width * height)).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The same, pixel by pixel.
    fn plainly(ids: &[u32], width: u32, id: u32) -> ([u32; 4], u32) {
        let at = (0_u32..).zip(ids).filter(|(_, other)| **other == id).map(|(at, _)| [at % width, at / width]);
        let at: Vec<[u32; 2]> = at.collect();
        let most = |axis: usize| at.iter().map(|place| place[axis]).max().unwrap();
        let least = |axis: usize| at.iter().map(|place| place[axis]).min().unwrap();
        let [left, top] = [least(0), least(1)];
        ([left, top, most(0) - left + 1, most(1) - top + 1], at.len() as u32)
    }

    proptest! {
        #[test]
        fn masks_are_what_the_ids_say(
            runs in prop::collection::vec((0_u32..6, 1_usize..30), 1..60),
            width in 1_u32..50,
        ) {
            let mut ids: Vec<u32> = runs.iter().flat_map(|(id, length)| vec![*id; *length]).collect();
            ids.resize(ids.len().next_multiple_of(width as usize), 0);
            let height = ids.len() as u32 / width;
            let masks = masks(&ids, [width, height]);
            for mask in &masks {
                prop_assert_eq!((mask.bbox, mask.area), plainly(&ids, width, mask.id));
                let decoded = Rle::from_compressed(&mask.rle.compressed()).unwrap();
                let columns = (0..width).flat_map(|x| (0..height).map(move |y| (y * width + x) as usize));
                let expected: Vec<bool> = columns.map(|at| ids[at] == mask.id).collect();
                prop_assert_eq!(decoded.pixels(), expected);
            }
            let covered: u32 = masks.iter().map(|mask| mask.area).sum();
            prop_assert_eq!(covered as usize, ids.iter().filter(|id| **id != 0).count());
        }
    }
}

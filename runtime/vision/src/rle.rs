//! Masks as runs, as COCO has them: pixels down one column after the other, those outside and those inside in turn, outside first.

/// A mask as runs.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Rle {
    counts: Vec<u32>,
}

/// The least character of compressed runs; 63 more follow it.
const FIRST: u8 = 48;
/// Bits that a character holds.
const DIGIT: u8 = 0x1f;
/// The sign of a number, in its last character.
const SIGN: u8 = 0x10;
/// Whether another character of the same number follows.
const MORE: u8 = 0x20;

impl Rle {
    /// The lengths of the runs, outside and inside in turn; the first may be 0.
    #[must_use]
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// Pixels inside.
    #[must_use]
    pub fn area(&self) -> u32 {
        self.counts.iter().skip(1).step_by(2).sum()
    }

    /// Whether each pixel is inside, down one column after the other.
    #[must_use]
    pub fn pixels(&self) -> Vec<bool> {
        let runs = self.counts.iter().zip([false, true].into_iter().cycle());
        runs.flat_map(|(count, inside)| std::iter::repeat_n(inside, *count as usize)).collect()
    }

    /// As COCO's own tools write it: from the fourth run on each count less the last but one, as a number of five bits a
    /// character, the lowest first.
    #[must_use]
    pub fn compressed(&self) -> String {
        let mut text = String::new();
        for (place, count) in self.counts.iter().enumerate() {
            let before = if place > 2 { self.counts[place - 2] } else { 0 };
            push(&mut text, i64::from(*count) - i64::from(before));
        }
        text
    }

    /// The runs of a compressed text; none if it is not one.
    #[must_use]
    pub fn from_compressed(text: &str) -> Option<Self> {
        // Counts have 32 bits, and their differences one more: seven characters.
        const MOST_BITS: u32 = 35;
        let mut counts: Vec<u32> = Vec::new();
        let (mut number, mut bits) = (0_i64, 0_u32);
        for character in text.bytes() {
            let digit = character.checked_sub(FIRST).filter(|digit| *digit < 64 && bits < MOST_BITS)?;
            number |= i64::from(digit & DIGIT) << bits;
            bits += 5;
            if digit & MORE != 0 {
                continue;
            }
            if digit & SIGN != 0 {
                number |= -1_i64 << bits;
            }
            let before = if counts.len() > 2 { i64::from(counts[counts.len() - 2]) } else { 0 };
            counts.push(u32::try_from(number + before).ok()?);
            (number, bits) = (0, 0);
        }
        (bits == 0).then_some(Self { counts })
    }
}

fn push(text: &mut String, mut number: i64) {
    loop {
        let digit = (number & i64::from(DIGIT)) as u8;
        number >>= 5;
        let is_last = number == if digit & SIGN == 0 { 0 } else { -1 };
        text.push(char::from(FIRST + if is_last { digit } else { digit | MORE }));
        if is_last {
            return;
        }
    }
}

/// Runs in the making.
#[derive(Clone, Debug, Default)]
pub(crate) struct RleBuilder {
    counts: Vec<u32>,
    end: u32,
}

impl RleBuilder {
    /// The pixels `from..to` are inside, down one column after the other; none before them comes later.
    pub fn add(&mut self, from: u32, to: u32) {
        if self.counts.is_empty() || from > self.end {
            self.counts.extend([from - self.end, 0]);
        }
        if let Some(last) = self.counts.last_mut() {
            *last += to - from;
        }
        self.end = to;
    }

    /// The runs of a picture of so many pixels.
    pub fn finish(mut self, pixels: u32) -> Rle {
        if pixels > self.end {
            self.counts.push(pixels - self.end);
        }
        Rle { counts: self.counts }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn of(pixels: &[bool]) -> Rle {
        let mut builder = RleBuilder::default();
        for (at, _) in (0..).zip(pixels).filter(|(_, inside)| **inside) {
            builder.add(at, at + 1);
        }
        builder.finish(pixels.len() as u32)
    }

    /// As COCO's own tools write these masks.
    #[test]
    fn known_masks_have_known_texts() {
        let check = |counts: &[u32], text: &str| {
            let rle = Rle { counts: counts.to_vec() };
            assert_eq!(rle.compressed(), text);
            assert_eq!(Rle::from_compressed(text), Some(rle));
        };
        check(&[9], "9");
        check(&[0, 4], "04");
        check(&[16], "`0");
        check(&[2, 3, 4, 3, 1], "2340M");
    }

    #[test]
    fn what_is_no_text_of_runs_is_refused() {
        for text in ["!", "`", "~", "ooooooooo0", "O"] {
            assert_eq!(Rle::from_compressed(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn compressed_masks_come_back(pixels in prop::collection::vec(any::<bool>(), 1..600), long in 1_u32..200_000) {
            let mut rle = of(&pixels);
            prop_assert_eq!(rle.pixels(), pixels.clone());
            prop_assert_eq!(rle.area() as usize, pixels.iter().filter(|inside| **inside).count());
            rle.counts[0] += long;
            prop_assert_eq!(Rle::from_compressed(&rle.compressed()), Some(rle));
        }
    }
}

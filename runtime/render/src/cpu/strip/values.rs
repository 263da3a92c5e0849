//! Values of a strip's pixels, and arithmetic on them that vector units do.

/// Pixels of a strip.
pub(in crate::cpu) const LONG: usize = 32;
/// Pixels written at a time.
pub(super) const LANES: usize = 8;

/// One value for each pixel of a strip, and what is written past them.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Values<T>(pub(super) [T; LONG + LANES]);

impl<T: Copy> Values<T> {
    /// Eight of them, to be written.
    #[inline(always)]
    pub(super) fn lanes(&mut self, from: usize) -> &mut [T; LANES] {
        self.0[from..].first_chunk_mut().expect("invariant: a strip is padded")
    }

    /// Eight of them.
    #[inline(always)]
    pub(super) fn at(&self, from: usize) -> &[T; LANES] {
        self.0[from..].first_chunk().expect("invariant: a strip is padded")
    }

    /// Eight of them set to the same.
    #[inline(always)]
    pub(super) fn fill(&mut self, from: usize, value: T) {
        *self.lanes(from) = [value; LANES];
    }
}

pub(super) type Floats = Values<f32>;
pub(super) const ZEROS: Floats = Values([0.0; LONG + LANES]);

/// A value between two others; what is no number becomes the least.
#[inline(always)]
pub(super) fn within(value: f32, least: f32, most: f32) -> f32 {
    let value = if value > least { value } else { least };
    if value < most { value } else { most }
}

/// The whole part of a value from a half on, below four million, or one less if it is whole: much cheaper than a
/// conversion.
#[inline(always)]
pub(super) fn whole(value: f32) -> u32 {
    const LARGE: f32 = 8_388_608.0;
    ((value - 0.5) + LARGE).to_bits() & 0x7F_FFFF
}

/// The nearest whole number, in two's complement, of a value of a few thousand at most.
#[inline(always)]
pub(super) fn rounded(value: f32) -> u32 {
    const LARGE: f32 = 12_582_912.0;
    (value + LARGE).to_bits().wrapping_sub(LARGE.to_bits())
}

//! The patterns' pictures.

use crate::pattern::{LEVELS, Pattern, Pictures, SIDE};

/// How many pictures there are.
pub const PICTURES: usize = Pattern::TEXTURED.len();

/// One pattern's picture with its coarser copies.
#[derive(Clone, Debug)]
pub struct PictureData {
    /// Texels along a side of the finest copy.
    pub side: u32,
    /// For each copy, the finest first and each half as fine, its texels row by row: factors times 128, a byte a channel
    /// from the lowest.
    pub levels: Vec<&'static [u32]>,
    /// Texels a metre, of the finest copy.
    pub per_m: f32,
    /// Texels a square metre, somewhat more than there are: decides which copy is taken.
    pub squared: f32,
}

/// A picture; painted when it is first asked for.
///
/// # Panics
/// If `index` is not below [`PICTURES`].
#[must_use]
pub fn picture(index: usize) -> PictureData {
    let pattern = Pattern::TEXTURED[index];
    let picture = Pictures::get().of(pattern).expect("invariant: every textured pattern has a picture");
    let (per_m, squared) = picture.density();
    PictureData { side: SIDE as u32, levels: (0..LEVELS).map(|level| picture.texels(level)).collect(), per_m, squared }
}

/// The picture of which dirt, frost and slime are made.
#[must_use]
pub fn spots() -> usize {
    Pattern::Concrete.picture_index().expect("invariant: concrete is textured")
}

//! The map of shadows, as a back end reads it.

use std::sync::RwLockReadGuard;

use crate::shadow::ShadowMap;

/// The map of shadows, up to date while this is held. For each place of the floor it holds how high the ray of light that
/// ends there first meets something, and in which room.
#[derive(Debug)]
pub struct Shadows<'a> {
    pub(super) map: RwLockReadGuard<'a, ShadowMap>,
}

impl Shadows<'_> {
    /// Another number each time that the map of the same floor plan was redrawn.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.map.revision()
    }

    /// Texels a row, and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.map.size()
    }

    /// Row by row: heights in millimetres in the upper twelve bits, the room in the lower four.
    #[must_use]
    pub fn texels(&self) -> &[u16] {
        self.map.texels()
    }

    /// Where the first texel lies, m.
    #[must_use]
    pub fn origin_m(&self) -> [f32; 2] {
        self.map.origin()
    }

    /// Texels a metre.
    #[must_use]
    pub fn texels_a_metre(&self) -> f32 {
        self.map.texels_a_metre()
    }
}

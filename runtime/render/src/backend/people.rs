//! What is done to pictures for people once they are drawn.

use crate::cpu::crew::Crew;
use crate::cpu::vectors::Avx2;
use crate::cpu::{outline, smooth};
use crate::scene::Scene;

/// Smooths edges and outlines highlights, as [`crate::CpuRenderer`] does. Keeps its buffers from picture to picture.
#[derive(Debug)]
pub struct ForPeople {
    crew: Crew,
    wide: Option<Avx2>,
    smoothing: smooth::Buffers,
    mask: Vec<u8>,
}

impl ForPeople {
    /// Works with so many threads, at least one.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        let (crew, wide) = (Crew::new(threads), Avx2::detect());
        Self { crew, wide, smoothing: smooth::Buffers::default(), mask: Vec::new() }
    }

    /// Finishes a picture of which each pixel's `facet` tells its triangle from others nearby.
    ///
    /// # Panics
    /// When the planes are not equally long, or no whole number of rows.
    pub fn finish(&mut self, scene: &Scene, color: &mut [u8], facets: &[u32], ids: &[u32], width: usize) {
        assert!(color.len() == facets.len() * 4 && ids.len() == facets.len(), "planes of different lengths");
        if facets.is_empty() {
            return;
        }
        assert!(facets.len().is_multiple_of(width), "no whole number of rows");
        smooth::run(self.wide, (&self.crew, self.crew.threads()), color, &mut self.smoothing, facets, width);
        if !scene.highlights.is_empty() {
            outline::run(color, &mut self.mask, ids, &scene.highlights, width);
        }
    }
}

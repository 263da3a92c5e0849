//! The reference renderer: a rasteriser on the CPU.
//!
//! First every pixel learns which triangle it sees (a visibility buffer), then what is wanted of it is worked out once.
//! Rows are shared out to threads in bands, each drawn as if it were a picture of its own; many pictures at once are
//! shared out whole. A pixel depends on nothing but the scene and the camera.

mod band;
pub(crate) mod crew;
mod draw;
mod facet;
mod numbers;
pub(crate) mod outline;
mod raster;
mod setup;
mod shade;
mod sight;
pub(crate) mod smooth;
mod strip;
pub(crate) mod vectors;
mod veil;

use std::sync::{Arc, Mutex, PoisonError};

use crate::camera::{Camera, View};
use crate::planes::Planes;
use crate::portals::Visible;
use crate::scene::Scene;
use crate::{Renderer, Shot};

pub use setup::{GUARD_PX, SUB};
pub use shade::{ABOVE, BELOW, DIRT, FROST, KEY, LIFT_M, SLIME};

use band::Scratch;
use crew::Crew;
use numbers::Numbers;
use shade::Shader;
use vectors::Avx2;
use veil::Veils;

/// Bands a thread: enough to share work evenly, few because every band goes through all draws.
const BANDS_PER_THREAD: usize = 4;
/// What the visibility buffer holds where there is nothing.
const NOTHING: u32 = u32::MAX;

/// Draws on the CPU, with as many threads as it was given. Keeps its buffers from picture to picture; clones share threads and
/// buffers, and may draw at once.
#[derive(Clone, Debug)]
pub struct CpuRenderer {
    crew: Arc<Crew>,
    /// Nothing makes it do without the widest vectors; the bits are the same.
    wide: Option<Avx2>,
    /// False in tests alone: every room is drawn, whether it can be seen or not.
    through_doors: bool,
    /// One for each picture that is being drawn.
    canvases: Arc<Pool<Canvas>>,
    /// One for each thread at work.
    scratches: Arc<Pool<Scratch>>,
}

/// What is kept to be used again.
type Pool<T> = Mutex<Vec<T>>;

/// The buffers of one picture.
#[derive(Debug, Default)]
struct Canvas {
    seen: Vec<u32>,
    nearness: Vec<f32>,
    smoothing: smooth::Buffers,
    mask: Vec<u8>,
    own_ids: Vec<u32>,
}

/// Takes something out of a pool, or makes it, and puts it back after use.
fn with_kept<T: Default>(pool: &Pool<T>, work: impl FnOnce(&mut T)) {
    let kept = || pool.lock().unwrap_or_else(PoisonError::into_inner);
    let taken = kept().pop();
    let mut taken = taken.unwrap_or_default();
    work(&mut taken);
    kept().push(taken);
}

impl CpuRenderer {
    /// A renderer that uses this many threads, at least one.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        Self {
            crew: Arc::new(Crew::new(threads)),
            wide: Avx2::detect(),
            through_doors: true,
            canvases: Arc::default(),
            scratches: Arc::default(),
        }
    }

    /// One that draws every room, to compare with.
    #[cfg(test)]
    pub(crate) fn without_portals() -> Self {
        Self { through_doors: false, ..Self::new(1) }
    }

    /// One that does without the widest vectors, to compare with.
    #[cfg(test)]
    pub(crate) fn without_wide_vectors() -> Self {
        Self { wide: None, ..Self::new(1) }
    }

    /// Draws one picture with so many threads.
    fn draw(&self, threads: usize, canvas: &mut Canvas, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
        let pixels = camera.pixels();
        planes.check_lengths(pixels);
        if pixels == 0 {
            return;
        }
        let wants_color = planes.color.is_some();
        let shadows = if wants_color {
            scene.clean_shadows()
        } else {
            scene.shadows.read().unwrap_or_else(PoisonError::into_inner)
        };
        let view = View::new(camera);
        let visible =
            if self.through_doors { Visible::new(&scene.plan, &view, camera) } else { Visible::everything(&view) };
        let (draws, see_through) = draw::collect(scene, camera, &view, &visible);
        let numbers = Numbers::new(&draws);
        let shader = Shader::new(&view, &draws, &numbers, &shadows, wants_color);
        let veils = Veils::new(self.wide, &see_through, &view, numbers.total());

        let outlined = camera.for_people && wants_color && !scene.highlights.is_empty();
        canvas.seen.resize(pixels, NOTHING);
        canvas.nearness.resize(pixels, 0.0);
        canvas.own_ids.resize(if outlined && planes.ids.is_none() { pixels } else { 0 }, 0);
        let width = camera.width as usize;
        let rows = band_rows(threads, camera.height as usize);
        let bands = band::cut(canvas, planes, rows, width);
        self.crew.share_out(threads, bands, |mut band| {
            with_kept(&self.scratches, |scratch| {
                sight::draw(self.wide, &draws, &numbers, &view, &mut band.rows(width), &mut scratch.corners);
                scratch.facets.clear(numbers.total());
                band::fill(self.wide, &mut band, width, &shader, &mut scratch.facets);
            });
            veils.blend(self.wide, &mut band, width);
        });

        if let Some(color) = planes.color.as_deref_mut().filter(|_| camera.for_people) {
            smooth::run(self.wide, (&*self.crew, threads), color, &mut canvas.smoothing, &canvas.seen, width);
            if outlined {
                let ids = planes.ids.as_deref().unwrap_or(&canvas.own_ids);
                outline::run(color, &mut canvas.mask, ids, &scene.highlights, width);
            }
        }
    }
}

impl Renderer for CpuRenderer {
    fn render(&mut self, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
        with_kept(&self.canvases, |canvas| self.draw(self.crew.threads(), canvas, scene, camera, planes));
    }

    fn render_all(&mut self, scene: &Scene, shots: &mut [Shot<'_>]) {
        if shots.iter().any(|shot| shot.planes.color.is_some()) {
            drop(scene.clean_shadows());
        }
        // Pictures are shared out whole; threads that are left over help with each.
        let threads = self.crew.threads();
        let each = threads / shots.len().clamp(1, threads);
        self.crew.share_out(threads / each, shots.iter_mut().collect(), |shot| {
            with_kept(&self.canvases, |canvas| self.draw(each, canvas, scene, &shot.camera, &mut shot.planes));
        });
    }
}

/// Whether the processor has the widest vectors that are made use of: AVX2.
#[must_use]
pub fn has_wide_vectors() -> bool {
    Avx2::detect().is_some()
}

/// Rows of a band.
fn band_rows(threads: usize, height: usize) -> usize {
    if threads <= 1 { height.max(1) } else { height.div_ceil(threads * BANDS_PER_THREAD).max(1) }
}

#[cfg(test)]
mod offices;
#[cfg(test)]
mod tests;

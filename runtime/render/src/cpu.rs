//! The reference renderer: a rasteriser on the CPU.
//!
//! First every pixel learns which triangle it sees (a visibility buffer), then what is wanted of it is worked out once.
//! Rows are shared out to threads in bands; each band's pixels depend on nothing but the scene and the camera.

mod draw;
mod facet;
pub(crate) mod outline;
mod raster;
mod setup;
mod shade;
pub(crate) mod smooth;
mod strip;
mod veil;

use std::sync::{Mutex, PoisonError};

use crate::Renderer;
use crate::camera::{Camera, FAR_M, View};
use crate::planes::Planes;
use crate::portals::Visible;
use crate::scene::Scene;

pub use setup::{GUARD_PX, SUB};
pub use shade::{ABOVE, BELOW, DIRT, FROST, KEY, LIFT_M, SLIME};

use draw::Draw;
use facet::Facets;
use setup::Triangle;
use shade::Shader;
use strip::{Out, Strip};
use veil::Veils;

/// Bands a thread: enough to share work evenly, few because every band goes through all triangles.
const BANDS_PER_THREAD: usize = 4;
/// What the visibility buffer holds where there is nothing.
const NOTHING: u32 = u32::MAX;

/// Draws on the CPU, with as many threads as it was given. Keeps its buffers from picture to picture.
#[derive(Debug)]
pub struct CpuRenderer {
    threads: usize,
    /// Whether the processor has AVX2; the bits are the same without. True only where it has.
    wide: bool,
    /// False in tests alone: every room is drawn, whether it can be seen or not.
    through_doors: bool,
    seen: Vec<u32>,
    nearness: Vec<f32>,
    batches: Vec<Vec<Triangle>>,
    smoothing: smooth::Buffers,
    mask: Vec<u8>,
    own_ids: Vec<u32>,
    /// One for each thread at work.
    facets: Mutex<Vec<Facets>>,
}

impl CpuRenderer {
    /// A renderer that uses this many threads, at least one.
    #[must_use]
    pub fn new(threads: usize) -> Self {
        let threads = threads.clamp(1, 64);
        Self {
            threads,
            wide: has_wide_vectors(),
            through_doors: true,
            seen: Vec::new(),
            nearness: Vec::new(),
            batches: Vec::new(),
            smoothing: smooth::Buffers::default(),
            mask: Vec::new(),
            own_ids: Vec::new(),
            facets: Mutex::default(),
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
        Self { wide: false, ..Self::new(1) }
    }

    /// Turns all draws into triangles on the screen.
    fn set_up(&mut self, draws: &[Draw<'_>], view: &View) {
        self.batches.resize_with(self.threads, Vec::new);
        let total: usize = draws.iter().map(Draw::cost).sum();
        let share = total / self.threads + 1;
        let mut rest = draws;
        let mut first = 0;
        let mut jobs = Vec::with_capacity(self.threads);
        for batch in &mut self.batches {
            batch.clear();
            let mut cost = 0;
            let count = rest.iter().take_while(|draw| (cost < share, cost += draw.cost()).0).count();
            let (own, others) = rest.split_at(count);
            jobs.push((batch, own, first));
            rest = others;
            first += count as u32;
        }
        // The shares add up to more than everything, so nothing is left over.
        let wide = self.wide;
        share_out(self.threads, jobs, |(batch, own, first)| setup::all(wide, batch, own, first, view));
    }
}

/// Runs every job once, on as many threads.
fn share_out<J: Send>(threads: usize, jobs: Vec<J>, work: impl Fn(J) + Sync) {
    if threads <= 1 || jobs.len() <= 1 {
        jobs.into_iter().for_each(work);
        return;
    }
    let queue = Mutex::new(jobs.into_iter());
    let drain = || {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            match next {
                Some(job) => work(job),
                None => break,
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(drain);
        }
        drain();
    });
}

/// The rows of all planes that one job fills.
struct Band<'a> {
    first_row: usize,
    seen: &'a mut [u32],
    nearness: &'a mut [f32],
    color: Option<&'a mut [u8]>,
    depth_m: Option<&'a mut [f32]>,
    normals: Option<&'a mut [i8]>,
    ids: Option<&'a mut [u32]>,
}

/// Cuts a plane into bands of so many values; nothing for each band where the plane is not wanted.
fn bands_of<T>(plane: Option<&mut [T]>, values: usize, count: usize) -> Vec<Option<&mut [T]>> {
    match plane {
        Some(plane) => plane.chunks_mut(values).map(Some).collect(),
        None => (0..count).map(|_| None).collect(),
    }
}

impl Renderer for CpuRenderer {
    fn render(&mut self, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
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
        self.set_up(&draws, &view);

        let outlined = camera.for_people && wants_color && !scene.highlights.is_empty();
        self.seen.resize(pixels, NOTHING);
        self.nearness.resize(pixels, 0.0);
        self.own_ids.resize(if outlined && planes.ids.is_none() { pixels } else { 0 }, 0);
        let shader = Shader::new(&view, &draws, &self.batches, &shadows, wants_color);
        let veils = Veils::new(self.wide, &see_through, &view, shader.triangles());
        let width = camera.width as usize;
        let band_rows = band_rows(self.threads, camera.height as usize);
        let (rows, count) = (band_rows * width, (camera.height as usize).div_ceil(band_rows));
        let ids = match planes.ids.as_deref_mut() {
            Some(ids) => Some(ids),
            None if outlined => Some(&mut self.own_ids[..]),
            None => None,
        };
        let mut colors = bands_of(planes.color.as_deref_mut(), rows * 4, count).into_iter();
        let mut depths = bands_of(planes.depth_m.as_deref_mut(), rows, count).into_iter();
        let mut normals = bands_of(planes.normals.as_deref_mut(), rows * 4, count).into_iter();
        let mut ids = bands_of(ids, rows, count).into_iter();
        let seen = self.seen.chunks_mut(rows).zip(self.nearness.chunks_mut(rows));
        let jobs: Vec<Band<'_>> = seen
            .enumerate()
            .map(|(index, (seen, nearness))| Band {
                first_row: index * band_rows,
                seen,
                nearness,
                color: colors.next().flatten(),
                depth_m: depths.next().flatten(),
                normals: normals.next().flatten(),
                ids: ids.next().flatten(),
            })
            .collect();
        let (pool, wide) = (&self.facets, self.wide);
        let kept = || pool.lock().unwrap_or_else(PoisonError::into_inner);
        share_out(self.threads, jobs, |mut band| {
            let mut facets = kept().pop().unwrap_or_default();
            facets.clear(shader.triangles());
            fill(wide, &mut band, width, &shader, &mut facets);
            kept().push(facets);
            veils.blend(wide, &mut band, width);
        });

        if let Some(color) = planes.color.as_deref_mut().filter(|_| camera.for_people) {
            smooth::run(self.threads, color, &mut self.smoothing, &self.seen, width);
            if outlined {
                let ids = planes.ids.as_deref().unwrap_or(&self.own_ids);
                outline::run(color, &mut self.mask, ids, &scene.highlights, width);
            }
        }
    }
}

/// Rows of a band.
fn band_rows(threads: usize, height: usize) -> usize {
    if threads <= 1 { height.max(1) } else { height.div_ceil(threads * BANDS_PER_THREAD).max(1) }
}

/// Whether the processor has the vectors that this is compiled for besides those every processor has.
fn has_wide_vectors() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::arch::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Draws one band. All that it is to reach has to be inlined here, to be compiled for the wide vectors too.
fn fill(wide: bool, band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets) {
    #[cfg(target_arch = "x86_64")]
    if wide {
        // SAFETY: `wide` is true only where the processor has AVX2.
        unsafe { fill_avx2(band, width, shader, facets) };
        return;
    }
    let _ = wide;
    fill_rows(band, width, shader, facets);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn fill_avx2(band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets) {
    fill_rows(band, width, shader, facets);
}

/// First what each pixel sees, then what is wanted of it.
#[inline(always)]
fn fill_rows(band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets) {
    band.seen.fill(NOTHING);
    band.nearness.fill(1.0 / FAR_M);
    raster::all(shader.batches(), band.first_row, width, band.seen, band.nearness);
    if let Some(depth) = &mut band.depth_m {
        for (depth, nearness) in depth.iter_mut().zip(&*band.nearness) {
            *depth = 1.0 / nearness;
        }
    }
    let mut strip = Strip::new();
    for (row, seen) in band.seen.chunks(width).enumerate() {
        let span = row * width..(row + 1) * width;
        if let Some(ids) = &mut band.ids {
            shader.ids(seen, &mut ids[span.clone()]);
        }
        if band.color.is_none() && band.normals.is_none() {
            continue;
        }
        let four = span.start * 4..span.end * 4;
        let out = Out {
            color: band.color.as_deref_mut().map(|plane| plane[four.clone()].as_chunks_mut().0),
            normals: band.normals.as_deref_mut().map(|plane| plane[four].as_chunks_mut().0),
        };
        shader.row(&mut strip, facets, band.first_row + row, seen, &band.nearness[span], out);
    }
}

#[cfg(test)]
mod offices;
#[cfg(test)]
mod tests;

//! A band: some rows of a picture, drawn by one thread.

use super::facet::Facets;
use super::raster::Rows;
use super::setup::Corner;
use super::shade::Shader;
use super::strip::{Out, Sight, Strip};
use super::vectors::{Avx2, Vectors, widest};
use super::{Canvas, NOTHING};
use crate::camera::FAR_M;
use crate::planes::Planes;

/// The rows of all planes that one job fills.
pub(super) struct Band<'a> {
    pub first_row: usize,
    pub seen: &'a mut [u32],
    pub nearness: &'a mut [f32],
    pub color: Option<&'a mut [u8]>,
    pub depth_m: Option<&'a mut [f32]>,
    pub normals: Option<&'a mut [i8]>,
    pub ids: Option<&'a mut [u32]>,
}

/// The buffers of one thread at work.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub corners: Vec<Corner>,
    pub facets: Facets,
}

/// Cuts a picture into bands of so many rows. Ids go to the canvas where it has room for them, as no plane has.
pub(super) fn cut<'a>(
    canvas: &'a mut Canvas,
    planes: &'a mut Planes<'_>,
    band_rows: usize,
    width: usize,
) -> Vec<Band<'a>> {
    let values = band_rows * width;
    let count = canvas.seen.len().div_ceil(values);
    let own_ids = Some(&mut canvas.own_ids[..]).filter(|ids| !ids.is_empty());
    let mut colors = cut_plane(planes.color.as_deref_mut(), values * 4, count);
    let mut depths = cut_plane(planes.depth_m.as_deref_mut(), values, count);
    let mut normals = cut_plane(planes.normals.as_deref_mut(), values * 4, count);
    let mut ids = cut_plane(planes.ids.as_deref_mut().or(own_ids), values, count);
    let seen = canvas.seen.chunks_mut(values).zip(canvas.nearness.chunks_mut(values));
    seen.enumerate()
        .map(|(index, (seen, nearness))| Band {
            first_row: index * band_rows,
            seen,
            nearness,
            color: colors.next().flatten(),
            depth_m: depths.next().flatten(),
            normals: normals.next().flatten(),
            ids: ids.next().flatten(),
        })
        .collect()
}

/// Cuts a plane into bands of so many values; nothing for each band where the plane is not wanted.
fn cut_plane<T>(plane: Option<&mut [T]>, values: usize, count: usize) -> impl Iterator<Item = Option<&mut [T]>> {
    let all: Vec<_> = match plane {
        Some(plane) => plane.chunks_mut(values).map(Some).collect(),
        None => (0..count).map(|_| None).collect(),
    };
    all.into_iter()
}

impl Band<'_> {
    /// What its pixels see: nothing yet.
    pub(super) fn rows(&mut self, width: usize) -> Rows<'_> {
        self.seen.fill(NOTHING);
        self.nearness.fill(1.0 / FAR_M);
        let count = self.seen.len() / width;
        Rows { first: self.first_row, count, width, seen: self.seen, nearness: self.nearness }
    }
}

/// Works out what is wanted of each pixel, once it is known what it sees. All that it is to reach has to be inlined
/// here, to be compiled for the wide vectors too.
pub(super) fn fill(wide: Option<Avx2>, band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets) {
    widest!(wide, fill_rows(band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets));
}

#[inline(always)]
fn fill_rows(vectors: impl Vectors, band: &mut Band<'_>, width: usize, shader: &Shader<'_>, facets: &mut Facets) {
    if let Some(depth) = &mut band.depth_m {
        for (depth, nearness) in depth.iter_mut().zip(&*band.nearness) {
            *depth = 1.0 / nearness;
        }
    }
    let mut strip = Strip::new();
    for (row, seen) in band.seen.chunks(width).enumerate() {
        let span = row * width..(row + 1) * width;
        let ids = band.ids.as_deref_mut().map(|plane| &mut plane[span.clone()]);
        if band.color.is_none() && band.normals.is_none() {
            if let Some(ids) = ids {
                shader.ids(seen, ids);
            }
            continue;
        }
        let four = span.start * 4..span.end * 4;
        let out = Out {
            color: band.color.as_deref_mut().map(|plane| plane[four.clone()].as_chunks_mut().0),
            normals: band.normals.as_deref_mut().map(|plane| plane[four].as_chunks_mut().0),
            ids,
        };
        let sight = Sight { seen, nearness: &band.nearness[span] };
        shader.row(vectors, &mut strip, facets, band.first_row + row, sight, out);
    }
}

//! See-through surfaces, blended over the finished picture by the rule of [`crate::veil`].
//!
//! There are few, so that each is worked out pixel by pixel, eight at a time. Only elementary operations are used, whose
//! bits are the same on every processor.

#![expect(clippy::needless_range_loop, reason = "one index into many arrays is what vectorises")]

use glam::Vec3;

use super::band::Band;
use super::draw::Draw;
use super::raster::Spans;
use super::setup::{self, Triangle};
use super::shade::{ABOVE, BELOW};
use super::vectors::{Avx2, Vectors, widest};
use crate::camera::View;
use crate::color::{self, srgb_table};
use crate::mesh::Paint;
use crate::shadow::towards_light;
use crate::veil::{self, Veil, VeilLook};

/// Pixels worked out at a time.
const LANES: usize = 8;
/// How bright what shines by itself is, and how bright the core of it.
const BEAM: f32 = 1.15;
const CORE: f32 = 1.9;
/// How much of the room a clear surface mirrors where it is looked at along the surface.
const MIRROR: f32 = 0.5;

type Lanes = [f32; LANES];

/// Everything see-through in one picture, in the order in which it is drawn.
pub(super) struct Veils<'a> {
    view: &'a View,
    draws: &'a [Draw<'a>],
    triangles: Vec<Triangle>,
    towards_light: Vec3,
    /// The number of the first of them, in the picture's count of triangles.
    first: u32,
}

/// What the pixels of one triangle have in common. A value that changes evenly over it is, at a pixel,
/// `a + depth * (b + c x + d y)`.
struct Sheet {
    look: VeilLook,
    id: u32,
    opacity: f32,
    /// Linear colour; under the light of its room, if it does not shine by itself.
    paint: Vec3,
    light: Vec3,
    /// Normals in the world, by axis, evenly.
    normal: [[f32; 4]; 3],
}

/// One row's part of a triangle.
struct Span {
    y: usize,
    from: usize,
    to: usize,
}

/// Blends everything over the rows of a finished band: exactly the pixels that [`super::raster`] would fill.
#[inline(always)]
fn blend_all(_: impl Vectors, veils: &Veils<'_>, band: &mut Band<'_>, width: usize) {
    let rows = band.first_row as i32..(band.first_row + band.nearness.len() / width) as i32;
    let colored = band.color.is_some();
    for (index, triangle) in veils.triangles.iter().enumerate() {
        let top = i32::from(triangle.rect[1]).max(rows.start);
        let bottom = i32::from(triangle.rect[3]).min(rows.end - 1);
        if top > bottom {
            continue;
        }
        let sheet = veils.sheet(triangle);
        if sheet.look.veil == Veil::Airy && !colored {
            continue;
        }
        let number = veils.first + index as u32;
        let mut spans = Spans::new(triangle, top);
        for y in top..=bottom {
            let (from, to) = spans.next_row();
            for from in (from..=to).step_by(LANES) {
                let (from, to) = (from as usize, to as usize);
                let span = Span { y: y as usize, from, to: to.min(from + LANES - 1) };
                veils.lay(&sheet, triangle, number, &span, band, width);
            }
        }
    }
}

impl<'a> Veils<'a> {
    /// `draws` in the order of drawing; triangles below `first` were drawn before.
    pub(super) fn new(wide: Option<Avx2>, draws: &'a [Draw<'a>], view: &'a View, first: u32) -> Self {
        let mut triangles = Vec::new();
        if !draws.is_empty() {
            setup::all(wide, &mut triangles, draws, view);
        }
        Self { view, draws, triangles, towards_light: towards_light(), first }
    }

    /// Blends everything over the rows of a finished band.
    pub(super) fn blend(&self, wide: Option<Avx2>, band: &mut Band<'_>, width: usize) {
        if self.triangles.is_empty() {
            return;
        }
        let veils = self;
        widest!(wide, blend_all(veils: &Veils<'_>, band: &mut Band<'_>, width: usize));
    }

    /// What a triangle's pixels have in common.
    fn sheet(&self, triangle: &Triangle) -> Sheet {
        let draw = &self.draws[triangle.draw as usize];
        let (mesh, index) = (draw.mesh, triangle.index as usize);
        let surface = &mesh.surfaces[usize::from(mesh.surface_of[index])];
        let look = veil::look(surface.pattern).expect("invariant: a veil's piece has see-through patterns alone");
        let corners = mesh.triangles[index].map(|corner| corner as usize);
        let [a, b, c] = corners.map(|corner| mesh.positions[corner]);
        let (e1, e2) = (b - a, c - a);
        let across = e1.cross(e2);
        let scale = 1.0 / across.length_squared().max(1e-24);
        let (share_b, share_c) = (e2.cross(across) * scale, across.cross(e1) * scale);
        let to_world = draw.transform.inverse.transpose();
        let [na, nb, nc] = corners.map(|corner| (to_world * mesh.normals[corner]).normalize_or(Vec3::Z));
        let rays = [self.view.ray(0.5, 0.5), self.view.right / self.view.focal, self.view.down / self.view.focal];
        let rays = rays.map(|ray| draw.transform.inverse * ray);
        let normal = [0, 1, 2].map(|axis| {
            let slope = share_b * (nb[axis] - na[axis]) + share_c * (nc[axis] - na[axis]);
            [na[axis] + (draw.eye - a).dot(slope), rays[0].dot(slope), rays[1].dot(slope), rays[2].dot(slope)]
        });
        let paint = match surface.paint {
            Paint::Fixed(color) => color,
            Paint::Tint => draw.tint,
            Paint::Fluid => draw.fluid,
        };
        let (paint, opacity) = match look.veil {
            Veil::Clear => veil::weathered(draw.weather, paint, surface.opacity),
            Veil::Airy => (paint, surface.opacity),
        };
        Sheet { look, id: draw.id, opacity, paint, light: draw.light, normal }
    }

    /// Blends up to eight pixels of a row.
    #[inline(always)]
    fn lay(&self, sheet: &Sheet, triangle: &Triangle, number: u32, span: &Span, band: &mut Band<'_>, width: usize) {
        let [at_origin, per_x, per_y] = triangle.nearness;
        let [least, most] = triangle.bounds;
        let row = (span.y - band.first_row) * width;
        let start = at_origin + per_y * span.y as f32;
        let mut near = [0.0; LANES];
        for i in 0..LANES {
            near[i] = (start + per_x * (span.from + i) as f32).clamp(least, most);
        }
        let count = span.to + 1 - span.from;
        let places = row + span.from..row + span.from + count;
        let mut seen = [false; LANES];
        for (i, behind) in band.nearness[places.clone()].iter().enumerate() {
            seen[i] = near[i] > *behind;
        }
        if seen == [false; LANES] {
            return;
        }
        let normal = self.normals(sheet, span, &near);
        if let Some(color) = &mut band.color {
            let (light, opacity) = self.color(sheet, span, &normal);
            let table = srgb_table();
            let pixels = &mut color.as_chunks_mut::<4>().0[places.clone()];
            for (i, pixel) in pixels.iter_mut().enumerate().filter(|(i, _)| seen[*i]) {
                let share = (opacity[i] * 256.0 + 0.5) as u32;
                for c in 0..3 {
                    let source = u32::from(table[color::step(light[c][i]) as usize & (table.len() - 1)]);
                    pixel[c] = ((source * share + u32::from(pixel[c]) * (256 - share) + 128) >> 8) as u8;
                }
            }
        }
        if sheet.look.veil == Veil::Airy {
            return;
        }
        for (i, place) in places.enumerate().filter(|(i, _)| seen[*i]) {
            band.nearness[place] = near[i];
            // So that edges of what is clear are smoothed too.
            band.seen[place] = number;
            if let Some(depth) = &mut band.depth_m {
                depth[place] = 1.0 / near[i];
            }
            if let Some(ids) = &mut band.ids {
                ids[place] = sheet.id;
            }
            if let Some(normals) = &mut band.normals {
                let byte = |axis: usize| rounded(normal[axis][i] * 127.0);
                normals[place * 4..place * 4 + 4].copy_from_slice(&[byte(0), byte(1), byte(2), 0]);
            }
        }
    }

    /// Unit normals in the world.
    #[inline(always)]
    fn normals(&self, sheet: &Sheet, span: &Span, near: &Lanes) -> [Lanes; 3] {
        let y = span.y as f32;
        let mut normal = [[0.0; LANES]; 3];
        for (out, [at_eye, first, per_x, per_y]) in normal.iter_mut().zip(sheet.normal) {
            let first = first + per_y * y;
            for i in 0..LANES {
                let x = (span.from + i) as f32;
                out[i] = at_eye + (first + per_x * x) / near[i];
            }
        }
        let [nx, ny, nz] = &mut normal;
        for i in 0..LANES {
            let square = nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i];
            let scale = 1.0 / (if square > 1e-12 { square } else { 1e-12 }).sqrt();
            nx[i] *= scale;
            ny[i] *= scale;
            nz[i] *= scale;
        }
        normal
    }

    /// Linear light, and how much of what is behind it hides.
    #[inline(always)]
    fn color(&self, sheet: &Sheet, span: &Span, [nx, ny, nz]: &[Lanes; 3]) -> ([Lanes; 3], Lanes) {
        let towards = self.towards_light;
        let row = self.view.ray(0.5, span.y as f32 + 0.5);
        let per_x = self.view.right / self.view.focal;
        let (mut opacity, mut cosine, mut highlight, mut mirror) =
            ([0.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let x = (span.from + i) as f32;
            let (rx, ry, rz) = (row.x + per_x.x * x, row.y + per_x.y * x, row.z + per_x.z * x);
            let scale = 1.0 / (rx * rx + ry * ry + rz * rz).sqrt();
            let (rx, ry, rz) = (rx * scale, ry * scale, rz * scale);
            let along = rx * nx[i] + ry * ny[i] + rz * nz[i];
            cosine[i] = (-along).clamp(0.0, 1.0);
            let (tx, ty, tz) = (rx - nx[i] * (2.0 * along), ry - ny[i] * (2.0 * along), rz - nz[i] * (2.0 * along));
            let mut power = (tx * towards.x + ty * towards.y + tz * towards.z).clamp(0.0, 1.0);
            for _ in 0..6 {
                power *= power;
            }
            highlight[i] = power * sheet.look.shine;
            let aside = 1.0 - cosine[i];
            mirror[i] = aside * aside * aside * MIRROR * (0.22 + 0.75 * (tz * 0.7 + 0.45).clamp(0.0, 1.0));
            opacity[i] = veil::opacity(&sheet.look, sheet.opacity, cosine[i]);
        }
        let mut light = [[0.0; LANES]; 3];
        for c in 0..3 {
            let (paint, room) = (sheet.paint[c], sheet.light[c]);
            let (below, rise) = (BELOW[c], (ABOVE - BELOW)[c]);
            for i in 0..LANES {
                let core = cosine[i] * cosine[i] * cosine[i];
                let shines = paint * BEAM + (CORE - paint * BEAM) * (core * core);
                // As if lamps lit half of it: it throws little shadow on itself.
                let around = 0.3 + below + rise * (nz[i] * 0.5 + 0.5);
                let shone_on = room * (paint * around + sheet.look.shine * mirror[i] + highlight[i]);
                light[c][i] = if sheet.look.shines { shines } else { shone_on };
            }
        }
        for i in 0..LANES {
            opacity[i] = (opacity[i] + highlight[i]).clamp(0.0, 1.0);
        }
        (light, opacity)
    }
}

/// The nearest whole number of a value between -127 and 127.
#[inline(always)]
fn rounded(value: f32) -> i8 {
    const LARGE: f32 = 12_582_912.0;
    ((value + LARGE).to_bits().wrapping_sub(LARGE.to_bits()) & 0xFF) as u8 as i8
}

#[cfg(test)]
mod tests;

//! What the pixels that see one triangle have in common, worked out once a triangle and not once a pixel or a row.
//!
//! A value that changes evenly over a triangle in space is, at a pixel, `a + depth * (b + c x + d y)`.

use core::ops::Range;

use glam::Vec3;

use super::NOTHING;
use super::shade::Shader;
use crate::mesh::Paint;
use crate::pattern::{Gloss, Picture};

/// A value that changes evenly over a plane in space.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Even {
    at_eye: f32,
    first: f32,
    per_x: f32,
    per_y: f32,
}

/// The same along one row of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvenRow {
    at_eye: f32,
    first: f32,
    per_x: f32,
}

impl Even {
    #[inline(always)]
    pub(super) fn row(&self, y: f32) -> EvenRow {
        EvenRow { at_eye: self.at_eye, first: self.first + self.per_y * y, per_x: self.per_x }
    }
}

impl EvenRow {
    #[inline(always)]
    pub(super) fn at(&self, x: f32, depth: f32) -> f32 {
        self.at_eye + depth * (self.first + self.per_x * x)
    }
}

/// A triangle's colour, where it follows from light and not from the triangle alone.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shine {
    /// Lit by the lamps.
    Lit,
    /// Shines by itself, in these display bytes.
    Own([u8; 4]),
    /// Shows what is outside.
    Sky,
}

/// One triangle, ready to be shaded.
#[derive(Debug)]
pub(super) struct Facet {
    number: u32,
    /// Which draw it belongs to.
    pub draw: u32,
    /// Which instance.
    pub id: u32,
    pub shine: Shine,
    /// Whether its normal is the same everywhere.
    pub flat: bool,
    /// Normals in the world at the first corner, and by how much the others differ; of unit length only where flat.
    pub normal: [Vec3; 3],
    /// One over the distance of the eye from its plane, 1/m.
    pub closeness: f32,
    /// Shares of the second and the third corner.
    pub shares: [Even; 2],
    /// Light from all around: at the first corner, and by how much the others differ.
    pub ambient: [f32; 3],
    /// The same, evenly.
    pub ambient_even: Even,
    /// Its linear colour.
    pub paint: Vec3,
    pub gloss: Gloss,
    pub picture: Option<&'static Picture>,
    /// Where on the picture a place lies, m.
    pub at: [Even; 2],
}

/// The facets of the triangles seen so far. Its buffers are kept from picture to picture.
#[derive(Debug, Default)]
pub(super) struct Facets {
    /// By triangle: which facet it has.
    of: Vec<u32>,
    all: Vec<Facet>,
    /// The numbers of the draw that was met last, and which it is.
    last: (Range<u32>, usize),
}

impl Facets {
    /// Forgets all, and makes ready for so many triangles.
    pub(super) fn clear(&mut self, triangles: u32) {
        self.last = (0..0, 0);
        for facet in self.all.drain(..) {
            self.of[facet.number as usize] = NOTHING;
        }
        if self.of.len() < triangles as usize {
            self.of.resize(triangles as usize, NOTHING);
        }
    }

    /// The facet of a triangle.
    #[inline(always)]
    pub(super) fn get(&mut self, shader: &Shader<'_>, number: u32) -> &Facet {
        let mut index = self.of[number as usize];
        if index == NOTHING {
            index = self.all.len() as u32;
            self.of[number as usize] = index;
            self.all.push(Facet::new(shader, number, &mut self.last));
        }
        &self.all[index as usize]
    }
}

impl Facet {
    #[inline(never)]
    fn new(shader: &Shader<'_>, number: u32, last: &mut (Range<u32>, usize)) -> Self {
        if !last.0.contains(&number) {
            *last = shader.draw_of(number);
        }
        let place = last.1 as u32;
        let draw = shader.draw(place);
        let index = (number - last.0.start + draw.piece.triangles.start) as usize;
        let mesh = draw.mesh;
        let corners = mesh.triangles[index].map(|corner| corner as usize);
        let [a, b, c] = corners.map(|corner| mesh.positions[corner]);
        let (e1, e2) = (b - a, c - a);
        let across = e1.cross(e2);
        let scale = 1.0 / across.length_squared().max(1e-24);
        let (share_b, share_c) = (e2.cross(across) * scale, across.cross(e1) * scale);
        let to_world = draw.transform.inverse.transpose();
        let [na, nb, nc] = corners.map(|corner| mesh.normals[corner]);
        let flat = na == nb && nb == nc;
        let first = to_world * na;
        let normal = if flat {
            [first.normalize_or(Vec3::Z), Vec3::ZERO, Vec3::ZERO]
        } else {
            [first, to_world * nb - first, to_world * nc - first]
        };
        let face = (to_world * across).normalize_or(Vec3::Z);
        let corner = draw.transform.rotation * a + draw.transform.offset;
        let rays = shader.rays().map(|ray| draw.transform.inverse * ray);
        let evenly = |slope: Vec3, offset: f32| Even {
            at_eye: draw.eye.dot(slope) + offset,
            first: rays[0].dot(slope),
            per_x: rays[1].dot(slope),
            per_y: rays[2].dot(slope),
        };
        let shares = [evenly(share_b, -a.dot(share_b)), evenly(share_c, -a.dot(share_c))];
        let surface = &mesh.surfaces[usize::from(mesh.surface_of[index])];
        let paint = match surface.paint {
            Paint::Fixed(color) => color,
            Paint::Tint => draw.tint,
            Paint::Fluid => draw.fluid,
        };
        let shine = shader.own_light(draw, surface.pattern, paint);
        let ambient = if shader.wants_color() && matches!(shine, Shine::Lit) {
            let known = draw.ambient.corners();
            let [d, e, f] = corners.map(|corner| known[corner]);
            [d, e - d, f - d]
        } else {
            [1.0, 0.0, 0.0]
        };
        let slope = share_b * ambient[1] + share_c * ambient[2];
        let picture = if shader.wants_color() { shader.picture(surface.pattern) } else { None };
        let at = match picture {
            Some(_) => [evenly(surface.u.0, surface.u.1), evenly(surface.v.0, surface.v.1)],
            None => [Even::default(); 2],
        };
        Self {
            number,
            draw: place,
            id: draw.id,
            shine,
            flat,
            normal,
            closeness: 1.0 / ((shader.eye() - corner).dot(face)).abs().max(1e-6),
            shares,
            ambient,
            ambient_even: evenly(slope, ambient[0] - a.dot(slope)),
            paint,
            gloss: surface.pattern.gloss(),
            picture,
            at,
        }
    }
}

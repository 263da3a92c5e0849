//! What is wanted of each pixel, once it is known which triangle it sees: all that shading reads.
//!
//! A pixel's place on its triangle follows from its depth, so that nothing has to be interpolated on the screen.

use core::ops::Range;

use glam::Vec3;

use super::NOTHING;
use super::draw::Draw;
use super::facet::{Facets, Shine};
use super::numbers::Numbers;
use super::strip::{LONG, Out, Sight, Strip};
use super::vectors::Vectors;
use crate::camera::View;
use crate::color::{from_srgb, srgb_table, to_srgb};
use crate::pattern::{Pattern, Picture, Pictures};
use crate::shadow::{ShadowMap, towards_light};

/// Light from above.
pub const ABOVE: Vec3 = Vec3::new(0.66, 0.655, 0.64);
/// Light thrown back from below.
pub const BELOW: Vec3 = Vec3::new(0.44, 0.41, 0.37);
/// Light along the shadows' direction.
pub const KEY: Vec3 = Vec3::new(0.60, 0.575, 0.52);
/// The display bytes of what lies over weathered surfaces.
pub const DIRT: [u8; 3] = [96, 74, 48];
/// See [`DIRT`].
pub const SLIME: [u8; 3] = [96, 200, 70];
/// See [`DIRT`].
pub const FROST: [u8; 3] = [206, 228, 244];
/// What is seen where there is no building: a pale sky over distant ground.
pub(super) const HORIZON: Vec3 = Vec3::new(0.80, 0.87, 0.94);
/// See [`HORIZON`].
pub(super) const ZENITH: Vec3 = Vec3::new(0.36, 0.56, 0.86);
/// See [`HORIZON`].
pub(super) const GROUND: Vec3 = Vec3::new(0.30, 0.33, 0.26);
/// How far a place is lifted off its surface before its shadow is looked up, m.
pub const LIFT_M: f32 = 0.03;

/// Everything that shading reads.
pub(super) struct Shader<'a> {
    view: &'a View,
    draws: &'a [Draw<'a>],
    numbers: &'a Numbers,
    pub shadows: &'a ShadowMap,
    pictures: &'static Pictures,
    pub towards_light: Vec3,
    /// The meshes' rays: through the picture's first pixel, and from pixel to pixel.
    first_ray: Vec3,
    per_x: Vec3,
    per_y: Vec3,
    /// How wide a pixel is, one metre ahead.
    pixel_m: f32,
    wants_color: bool,
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        view: &'a View,
        draws: &'a [Draw<'a>],
        numbers: &'a Numbers,
        shadows: &'a ShadowMap,
        wants_color: bool,
    ) -> Self {
        Self {
            view,
            draws,
            numbers,
            shadows,
            pictures: Pictures::get(),
            towards_light: towards_light(),
            first_ray: view.ray(0.5, 0.5),
            per_x: view.right / view.focal,
            per_y: view.down / view.focal,
            pixel_m: 1.0 / view.focal,
            wants_color,
        }
    }

    /// The numbers of the draw that a triangle belongs to, and which it is.
    pub(super) fn draw_of(&self, number: u32) -> (Range<u32>, usize) {
        let draw = self.numbers.draw_of(number);
        (self.numbers.of(draw), draw)
    }

    #[inline(always)]
    pub(super) fn ids(&self, seen: &[u32], out: &mut [u32]) {
        // Those of the draw that was met last.
        let (mut known, mut id) = (0..0, 0);
        for (number, out) in seen.iter().zip(out) {
            if !known.contains(number) {
                (known, id) = if *number == NOTHING {
                    (NOTHING..NOTHING, 0)
                } else {
                    let (numbers, draw) = self.draw_of(*number);
                    (numbers, self.draws[draw].id)
                };
            }
            *out = id;
        }
    }

    /// Fills one row of colours and normals, as far as they are wanted.
    #[inline(always)]
    pub(super) fn row(
        &self,
        vectors: impl Vectors,
        strip: &mut Strip,
        facets: &mut Facets,
        y: usize,
        sight: Sight<'_>,
        mut out: Out<'_>,
    ) {
        for from in (0..sight.seen.len()).step_by(LONG) {
            let to = (from + LONG).min(sight.seen.len());
            let sight = Sight { seen: &sight.seen[from..to], nearness: &sight.nearness[from..to] };
            let mut out = Out {
                color: out.color.as_deref_mut().map(|row| &mut row[from..to]),
                normals: out.normals.as_deref_mut().map(|row| &mut row[from..to]),
                ids: out.ids.as_deref_mut().map(|row| &mut row[from..to]),
            };
            strip.shade(vectors, self, facets, (from, y), sight, &mut out);
        }
    }

    #[inline(always)]
    pub(super) fn draw(&self, number: u32) -> &'a Draw<'a> {
        &self.draws[number as usize]
    }

    pub(super) fn wants_color(&self) -> bool {
        self.wants_color
    }

    /// The rays through the picture's first pixel, and from pixel to pixel along a row and down.
    #[inline(always)]
    pub(super) fn rays(&self) -> [Vec3; 3] {
        [self.first_ray, self.per_x, self.per_y]
    }

    #[inline(always)]
    pub(super) fn ray(&self, x: f32, y: f32) -> Vec3 {
        self.first_ray + self.per_y * y + self.per_x * x
    }

    #[inline(always)]
    pub(super) fn eye(&self) -> Vec3 {
        self.view.eye
    }

    /// A pattern's picture.
    pub(super) fn picture(&self, pattern: Pattern) -> Option<&'static Picture> {
        self.pictures.of(pattern)
    }

    /// The square of how wide a pixel is, one metre ahead.
    #[inline(always)]
    pub(super) fn pixel_m2(&self) -> f32 {
        self.pixel_m * self.pixel_m
    }

    /// What a surface's colour follows from.
    pub(super) fn own_light(&self, draw: &Draw<'_>, pattern: Pattern, paint: Vec3) -> Shine {
        let strength = match (pattern, draw.lit) {
            (Pattern::Sky, _) => return Shine::Sky,
            (Pattern::Lamp, true) => 1.9,
            (Pattern::Lamp, false) => 0.12,
            (Pattern::Glow, _) => 1.15,
            _ => return Shine::Lit,
        };
        let [r, g, b] = to_srgb(srgb_table(), paint * strength);
        Shine::Own([r, g, b, 255])
    }

    /// Frost, dirt and slime over any surface.
    pub(super) fn weathered(&self, draw: &Draw<'_>, albedo: Vec3, place: Vec3, normal: Vec3) -> Vec3 {
        let mut albedo = albedo;
        let spots = |scale: f32| {
            let picture = self.pictures.of(Pattern::Concrete);
            let at = place * scale;
            picture.map_or(1.0, |picture| picture.level(0.0).at(at.x + at.z * 0.71, at.y + at.z * 0.53)[0])
        };
        if draw.weather.dirty {
            let amount = ((spots(14.0) - 0.985) * 14.0).clamp(0.0, 0.85);
            albedo = albedo.lerp(from_srgb(DIRT), amount);
        }
        if draw.weather.infected {
            let amount = ((spots(10.0) - 0.99) * 12.0).clamp(0.0, 0.8);
            albedo = albedo.lerp(from_srgb(SLIME), amount);
        }
        if draw.weather.cold {
            let amount = 0.38 + 0.3 * normal.z.max(0.0) + ((spots(18.0) - 1.0) * 3.0).clamp(-0.2, 0.25);
            albedo = albedo.lerp(from_srgb(FROST), amount);
        }
        albedo
    }
}

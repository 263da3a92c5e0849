//! A short piece of a row, shaded as a whole: every value lies in an array of its own, so that the compiler uses the
//! processor's vector units. Only elementary operations are used, whose bits are the same on every processor.
//!
//! First each triangle writes what it knows of its pixels, eight at a time, past its last one: the next triangle writes
//! over that. Then all pixels are lit alike, whatever they see.

#![expect(clippy::needless_range_loop, reason = "one index into many arrays is what vectorises")]

mod light;
mod surface;
mod values;
mod writing;

use glam::Vec3;

use super::facet::{Facets, Shine};
use super::shade::Shader;
use super::vectors::Vectors;

pub(super) use values::LONG;
use values::{Floats, LANES, Values, ZEROS};

/// The buffers of a strip.
pub(super) struct Strip {
    /// The pixels' columns.
    x: Floats,
    depth: Floats,
    /// How far away they lie along their rays, m.
    away: Floats,
    normal: [Floats; 3],
    ambient: Floats,
    /// Linear colour under full light, with the light of the room.
    albedo: [Floats; 3],
    /// The colour of highlights, with the light of the room.
    tint: [Floats; 3],
    shine: Floats,
    mirror: Floats,
    squarings: Floats,
    room: Values<u16>,
    facing: Floats,
    lit: Floats,
    /// Places on the shadow map, in texels, and the least value there that throws a shadow.
    shadow: [Floats; 2],
    limit: Values<i32>,
    cell: Values<u32>,
    light: [Floats; 3],
}

/// What pixels see: the number of a triangle, and one over the depth there, 1/m.
#[derive(Clone, Copy)]
pub(super) struct Sight<'a> {
    pub seen: &'a [u32],
    pub nearness: &'a [f32],
}

/// The rows of the planes that a strip fills.
pub(super) struct Out<'a> {
    pub color: Option<&'a mut [[u8; 4]]>,
    pub normals: Option<&'a mut [[i8; 4]]>,
    pub ids: Option<&'a mut [u32]>,
}

/// Part of a strip that sees one triangle.
#[derive(Clone, Copy)]
struct Run {
    from: usize,
    to: usize,
}

/// Rays through the pixels of a row, a metre deep each.
#[derive(Clone, Copy)]
struct Rays {
    first: Vec3,
    per_x: Vec3,
}

impl Rays {
    #[inline(always)]
    fn of(shader: &Shader<'_>, y: f32) -> Self {
        let [_, per_x, _] = shader.rays();
        Self { first: shader.ray(0.0, y), per_x }
    }

    /// Through the pixel of a column.
    #[inline(always)]
    fn at(&self, x: f32) -> [f32; 3] {
        let Self { first, per_x } = self;
        [first.x + per_x.x * x, first.y + per_x.y * x, first.z + per_x.z * x]
    }
}

/// What a strip sees, and how it is lit.
struct Seen {
    /// Whether any of it is lit by the lamps, any of that shines, and how sharply at most.
    lit: bool,
    glossy: bool,
    most_squarings: u8,
    /// Whether any of it is outside.
    open: bool,
    /// Runs that are not lit, and how many.
    unlit: [(Run, Shine); LONG],
    runs: usize,
}

impl Seen {
    const NOTHING: Self = Self {
        lit: false,
        glossy: false,
        most_squarings: 0,
        open: false,
        unlit: [(Run { from: 0, to: 0 }, Shine::Lit); LONG],
        runs: 0,
    };

    #[inline(always)]
    fn leave_unlit(&mut self, run: Run, shine: Shine) {
        self.unlit[self.runs] = (run, shine);
        self.runs += 1;
        self.open |= matches!(shine, Shine::Sky);
    }

    #[inline(always)]
    fn unlit(&self) -> &[(Run, Shine)] {
        &self.unlit[..self.runs]
    }
}

impl Strip {
    pub(super) fn new() -> Self {
        Self {
            x: ZEROS,
            depth: ZEROS,
            away: ZEROS,
            normal: [ZEROS; 3],
            ambient: ZEROS,
            albedo: [ZEROS; 3],
            tint: [ZEROS; 3],
            shine: ZEROS,
            mirror: ZEROS,
            squarings: ZEROS,
            room: Values([0; LONG + LANES]),
            facing: ZEROS,
            lit: ZEROS,
            shadow: [ZEROS; 2],
            limit: Values([0; LONG + LANES]),
            cell: Values([0; LONG + LANES]),
            light: [ZEROS; 3],
        }
    }

    /// Shades pixels of row `y` from column `first` on, at most [`LONG`].
    #[inline(always)]
    pub(super) fn shade(
        &mut self,
        vectors: impl Vectors,
        shader: &Shader<'_>,
        facets: &mut Facets,
        (first, y): (usize, usize),
        Sight { seen: numbers, nearness }: Sight<'_>,
        out: &mut Out<'_>,
    ) {
        let y = y as f32;
        match nearness.first_chunk() {
            Some(whole) => self.look(shader, first, y, whole),
            None => {
                let mut near = [1.0; LONG];
                near[..nearness.len()].copy_from_slice(nearness);
                self.look(shader, first, y, &near);
            }
        }
        let mut seen = Seen::NOTHING;
        self.take_up(shader, facets, y, numbers, out, &mut seen);
        if let Some(normals) = &mut out.normals {
            self.write_normals(normals);
        }
        let Some(color) = &mut out.color else { return };
        if seen.lit {
            self.look_for_light(vectors, shader, y, numbers.len());
            self.illuminate();
            if seen.glossy {
                self.gloss(shader, y, seen.most_squarings);
            }
        }
        if seen.open {
            self.look_outside(shader, y, seen.unlit());
        }
        if seen.lit || seen.open {
            self.write_color(color);
        }
        for (run, shine) in seen.unlit() {
            if let Shine::Own(own) = shine {
                color[run.from..run.to].fill(*own);
            }
        }
    }

    /// Has each triangle write what it knows of its pixels.
    #[inline(always)]
    fn take_up(
        &mut self,
        shader: &Shader<'_>,
        facets: &mut Facets,
        y: f32,
        numbers: &[u32],
        out: &mut Out<'_>,
        seen: &mut Seen,
    ) {
        let wants_color = out.color.is_some();
        let mut from = 0;
        for same in numbers.chunk_by(|one, next| one == next) {
            let (run, number) = (Run { from, to: from + same.len() }, same[0]);
            from = run.to;
            if number == super::NOTHING {
                self.fill_normal(run, Vec3::ZERO);
                writing::write_id(out, run, 0);
                seen.leave_unlit(run, Shine::Sky);
                continue;
            }
            let facet = facets.get(shader, number);
            writing::write_id(out, run, facet.id);
            self.shape(facet, run, y);
            if wants_color && matches!(facet.shine, Shine::Lit) {
                self.paint(shader, facet, run, y);
                seen.lit = true;
                seen.glossy |= facet.gloss.shine > 0.0;
                seen.most_squarings = seen.most_squarings.max(facet.gloss.squarings);
            } else {
                seen.leave_unlit(run, facet.shine);
            }
        }
    }

    /// Where the pixels lie, and how far away what they see.
    #[inline(always)]
    fn look(&mut self, shader: &Shader<'_>, first: usize, y: f32, nearness: &[f32; LONG]) {
        let rays = Rays::of(shader, y);
        for i in 0..LONG {
            self.x.0[i] = (first as i32 + i as i32) as f32;
            self.depth.0[i] = 1.0 / nearness[i];
        }
        for i in 0..LONG {
            let x = self.x.0[i];
            let [rx, ry, rz] = rays.at(x);
            self.away.0[i] = self.depth.0[i] * (rx * rx + ry * ry + rz * rz).sqrt();
        }
    }
}

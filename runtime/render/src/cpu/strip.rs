//! A short piece of a row, shaded as a whole: every value lies in an array of its own, so that the compiler uses the
//! processor's vector units. Only elementary operations are used, whose bits are the same on every processor.
//!
//! First each triangle writes what it knows of its pixels, eight at a time, past its last one: the next triangle writes
//! over that. Then all pixels are lit alike, whatever they see.

#![expect(clippy::needless_range_loop, reason = "one index into many arrays is what vectorises")]

use glam::Vec3;

use super::facet::{Facet, Facets, Shine};
use super::shade::{ABOVE, BELOW, GROUND, HORIZON, KEY, LIFT_M, Shader, ZENITH};
use super::vectors::Vectors;
use crate::color;
use crate::pattern::Level;
use crate::shadow::SLANT;

/// Pixels of a strip.
pub(super) const LONG: usize = 32;
/// Pixels written at a time.
const LANES: usize = 8;

/// One value for each pixel of a strip, and what is written past them.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Values<T>([T; LONG + LANES]);

impl<T: Copy> Values<T> {
    /// Eight of them, to be written.
    #[inline(always)]
    fn lanes(&mut self, from: usize) -> &mut [T; LANES] {
        self.0[from..].first_chunk_mut().expect("invariant: a strip is padded")
    }

    /// Eight of them.
    #[inline(always)]
    fn at(&self, from: usize) -> &[T; LANES] {
        self.0[from..].first_chunk().expect("invariant: a strip is padded")
    }

    /// Eight of them set to the same.
    #[inline(always)]
    fn fill(&mut self, from: usize, value: T) {
        *self.lanes(from) = [value; LANES];
    }
}

type Floats = Values<f32>;
const ZEROS: Floats = Values([0.0; LONG + LANES]);

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
        Sight { seen, nearness }: Sight<'_>,
        out: &mut Out<'_>,
    ) {
        match nearness.first_chunk() {
            Some(whole) => self.look(shader, first, y as f32, whole),
            None => {
                let mut near = [1.0; LONG];
                near[..nearness.len()].copy_from_slice(nearness);
                self.look(shader, first, y as f32, &near);
            }
        }
        let wants_color = out.color.is_some();
        let (mut glossy, mut most_squarings, mut lit, mut open) = (false, 0, false, false);
        let (mut alone, mut others) = ([(Run { from: 0, to: 0 }, Shine::Lit); LONG], 0);
        let mut from = 0;
        while from < seen.len() {
            let number = seen[from];
            let mut to = from + 1;
            while to < seen.len() && seen[to] == number {
                to += 1;
            }
            let run = Run { from, to };
            from = to;
            if number == super::NOTHING {
                self.fill_normal(run, Vec3::ZERO);
                write_id(out, run, 0);
                alone[others] = (run, Shine::Sky);
                others += 1;
                open = true;
                continue;
            }
            let facet = facets.get(shader, number);
            let color = wants_color && matches!(facet.shine, Shine::Lit);
            write_id(out, run, facet.id);
            self.shape(facet, run, y as f32);
            if color {
                self.paint(shader, facet, run, y as f32);
                glossy |= facet.gloss.shine > 0.0;
                most_squarings = most_squarings.max(facet.gloss.squarings);
                lit = true;
            } else {
                alone[others] = (run, facet.shine);
                others += 1;
                open |= matches!(facet.shine, Shine::Sky);
            }
        }
        if let Some(normals) = &mut out.normals {
            self.write_normals(normals);
        }
        if let Some(color) = &mut out.color {
            if lit {
                self.look_for_light(vectors, shader, y as f32, seen.len());
                self.illuminate();
                if glossy {
                    self.gloss(shader, y as f32, most_squarings);
                }
            }
            if open {
                self.look_outside(shader, y as f32, &alone[..others]);
            }
            if lit || open {
                self.write_color(color);
            }
            for (run, shine) in &alone[..others] {
                if let Shine::Own(own) = shine {
                    color[run.from..run.to].fill(*own);
                }
            }
        }
    }

    /// Where the pixels lie, and how far away what they see.
    #[inline(always)]
    fn look(&mut self, shader: &Shader<'_>, first: usize, y: f32, nearness: &[f32; LONG]) {
        let row = shader.ray(0.0, y);
        let [_, per_x, _] = shader.rays();
        for i in 0..LONG {
            self.x.0[i] = (first as i32 + i as i32) as f32;
            self.depth.0[i] = 1.0 / nearness[i];
        }
        for i in 0..LONG {
            let x = self.x.0[i];
            let (rx, ry, rz) = (row.x + per_x.x * x, row.y + per_x.y * x, row.z + per_x.z * x);
            self.away.0[i] = self.depth.0[i] * (rx * rx + ry * ry + rz * rz).sqrt();
        }
    }

    #[inline(always)]
    fn fill_normal(&mut self, run: Run, normal: Vec3) {
        for from in (run.from..run.to).step_by(LANES) {
            self.normal[0].fill(from, normal.x);
            self.normal[1].fill(from, normal.y);
            self.normal[2].fill(from, normal.z);
        }
    }

    /// Normals, and light from all around.
    #[inline(always)]
    fn shape(&mut self, facet: &Facet, run: Run, y: f32) {
        if facet.flat {
            self.fill_normal(run, facet.normal[0]);
            let ambient = facet.ambient_even.row(y);
            for from in (run.from..run.to).step_by(LANES) {
                let (x, depth) = (self.x.at(from), self.depth.at(from));
                let out = self.ambient.lanes(from);
                for i in 0..LANES {
                    out[i] = within(ambient.at(x[i], depth[i]), 0.0, 1.4);
                }
            }
            return;
        }
        let shares = facet.shares.map(|share| share.row(y));
        let [n, nb, nc] = facet.normal;
        let [a, ab, ac] = facet.ambient;
        for from in (run.from..run.to).step_by(LANES) {
            let (x, depth) = (*self.x.at(from), *self.depth.at(from));
            let (mut b, mut c) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                // Pixels' centres lie inside, but for rounding.
                b[i] = within(shares[0].at(x[i], depth[i]), 0.0, 1.0);
                c[i] = within(shares[1].at(x[i], depth[i]), 0.0, 1.0);
            }
            let (mut nx, mut ny, mut nz) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                nx[i] = n.x + nb.x * b[i] + nc.x * c[i];
                ny[i] = n.y + nb.y * b[i] + nc.y * c[i];
                nz[i] = n.z + nb.z * b[i] + nc.z * c[i];
            }
            for i in 0..LANES {
                let square = nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i];
                let scale = 1.0 / (if square > 1e-12 { square } else { 1e-12 }).sqrt();
                nx[i] *= scale;
                ny[i] *= scale;
                nz[i] *= scale;
            }
            *self.normal[0].lanes(from) = nx;
            *self.normal[1].lanes(from) = ny;
            *self.normal[2].lanes(from) = nz;
            let ambient = self.ambient.lanes(from);
            for i in 0..LANES {
                ambient[i] = a + ab * b[i] + ac * c[i];
            }
        }
    }

    /// Colours and highlights.
    #[inline(always)]
    fn paint(&mut self, shader: &Shader<'_>, facet: &Facet, run: Run, y: f32) {
        let (draw, gloss) = (shader.draw(facet.draw), &facet.gloss);
        let light = draw.light.to_array();
        let weathered = draw.weather.any();
        let paint = (if weathered { facet.paint } else { facet.paint * draw.light }).to_array();
        let level = match facet.picture {
            Some(picture) => {
                // Every pixel of a run is about as far away; its middle decides how coarse the pattern is.
                let middle = (run.from + run.to) / 2;
                // One over the cosine between the ray and the normal: the pixel is drawn out by as much.
                let drawn_out = self.away.0[middle] * facet.closeness;
                let drawn_out = if drawn_out < 12.5 { drawn_out } else { 12.5 };
                let depth = self.depth.0[middle];
                Some(picture.level(shader.pixel_m2() * depth * depth * drawn_out))
            }
            None => None,
        };
        let [u, v] = facet.at.map(|at| at.row(y));
        for from in (run.from..run.to).step_by(LANES) {
            self.room.fill(from, draw.room);
            self.shine.fill(from, gloss.shine);
            match &level {
                Some(level) => self.textured(level, [u, v], paint, from),
                None => {
                    for (albedo, paint) in self.albedo.iter_mut().zip(paint) {
                        albedo.fill(from, paint);
                    }
                }
            }
        }
        if weathered {
            for x in run.from..run.to {
                let ray = shader.ray(self.x.0[x], y);
                let place = draw.eye + draw.transform.inverse * ray * self.depth.0[x];
                let normal = Vec3::new(self.normal[0].0[x], self.normal[1].0[x], self.normal[2].0[x]);
                let albedo = Vec3::new(self.albedo[0].0[x], self.albedo[1].0[x], self.albedo[2].0[x]);
                let albedo = shader.weathered(draw, albedo, place, normal) * draw.light;
                (0..3).for_each(|c| self.albedo[c].0[x] = albedo[c]);
            }
        }
        if gloss.shine > 0.0 {
            for from in (run.from..run.to).step_by(LANES) {
                self.mirror.fill(from, gloss.mirror);
                self.squarings.fill(from, f32::from(gloss.squarings));
                for c in 0..3 {
                    if gloss.colored {
                        let albedo = *self.albedo[c].at(from);
                        let tint = self.tint[c].lanes(from);
                        for i in 0..LANES {
                            tint[i] = albedo[i] * 1.1;
                        }
                    } else {
                        self.tint[c].fill(from, light[c]);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn textured(&mut self, level: &Level<'_>, [u, v]: [super::facet::EvenRow; 2], paint: [f32; 3], from: usize) {
        let (x, depth) = (self.x.at(from), self.depth.at(from));
        let (mut us, mut vs) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            us[i] = u.at(x[i], depth[i]);
            vs[i] = v.at(x[i], depth[i]);
        }
        let factors = level.lanes(&us, &vs);
        for (c, factors) in factors.iter().enumerate() {
            let out = self.albedo[c].lanes(from);
            for i in 0..LANES {
                out[i] = paint[c] * factors[i];
            }
        }
    }

    /// How much lamplight meets each pixel.
    #[inline(always)]
    fn look_for_light(&mut self, vectors: impl Vectors, shader: &Shader<'_>, y: f32, length: usize) {
        let towards = shader.towards_light;
        let row = shader.ray(0.0, y);
        let [_, per_x, _] = shader.rays();
        let eye = shader.eye();
        let map = shader.shadows;
        let (scale, origin, most) = (map.texels_a_metre(), map.origin(), map.most());
        let [nx, ny, nz] = &self.normal;
        let (mut sx, mut sy, mut sz) = ([0.0; LONG], [0.0; LONG], [0.0; LONG]);
        for i in 0..LONG {
            let facing = nx.0[i] * towards.x + ny.0[i] * towards.y + nz.0[i] * towards.z;
            self.facing.0[i] = if facing > 0.0 { facing } else { 0.0 };
        }
        for i in 0..LONG {
            let (x, depth) = (self.x.0[i], self.depth.0[i]);
            let px = eye.x + (row.x + per_x.x * x) * depth + nx.0[i] * LIFT_M;
            let py = eye.y + (row.y + per_x.y * x) * depth + ny.0[i] * LIFT_M;
            let pz = eye.z + (row.z + per_x.z * x) * depth + nz.0[i] * LIFT_M + 0.008;
            sx[i] = (px + SLANT[0] * pz - origin[0]) * scale - 0.5;
            sy[i] = (py + SLANT[1] * pz - origin[1]) * scale - 0.5;
            sz[i] = within(pz * 1000.0, 0.5, 4095.0);
        }
        for i in 0..LONG {
            self.shadow[0].0[i] = within(sx[i], 2.0, most[0]);
            self.shadow[1].0[i] = within(sy[i], 2.0, most[1]);
        }
        for i in 0..LONG {
            self.limit.0[i] = (whole(sz[i]) << 4 | 0xF) as i32;
            let (x, y) = (self.shadow[0].0[i], self.shadow[1].0[i]);
            let cell = map.cell(whole(x), whole(y));
            // What lies beyond the map is free.
            self.cell.0[i] = if (sx[i] == x) & (sy[i] == y) { cell } else { 0 };
        }
        for i in 0..length {
            let facing = self.facing.0[i];
            self.lit.0[i] = if facing <= 0.0 {
                0.0
            } else if map.may_shade(self.cell.0[i], self.limit.0[i]) {
                let around = map.around([self.shadow[0].0[i], self.shadow[1].0[i]]);
                vectors.light(&around, self.limit.0[i], self.room.0[i])
            } else {
                1.0
            };
        }
    }

    /// All light on a surface: what shades a place from the lamps also keeps some of the room's light from it.
    #[inline(always)]
    fn illuminate(&mut self) {
        let [nx, ny, nz] = &self.normal;
        for c in 0..3 {
            let (below, rise, key) = (BELOW[c], (ABOVE - BELOW)[c], KEY[c]);
            let (out, albedo) = (&mut self.light[c], &self.albedo[c]);
            for i in 0..LONG {
                // Walls that face different ways are never quite as bright as each other.
                let aside = 1.0 + 0.07 * nx.0[i] - 0.05 * ny.0[i];
                let around = (below + rise * (nz.0[i] * 0.5 + 0.5)) * aside;
                let (ambient, lit) = (self.ambient.0[i], self.lit.0[i]);
                let all =
                    around * (ambient * (0.8 + 0.2 * lit)) + key * (self.facing.0[i] * lit * (0.4 + 0.6 * ambient));
                out.0[i] = albedo.0[i] * all;
            }
        }
    }

    /// Highlights, and what surfaces mirror of the room.
    #[inline(always)]
    fn gloss(&mut self, shader: &Shader<'_>, y: f32, most_squarings: u8) {
        let towards = shader.towards_light;
        let row = shader.ray(0.0, y);
        let [_, per_x, _] = shader.rays();
        let [nx, ny, nz] = &self.normal;
        let mut power = [0.0; LONG];
        let mut mirror = [0.0; LONG];
        for i in 0..LONG {
            let x = self.x.0[i];
            let (rx, ry, rz) = (row.x + per_x.x * x, row.y + per_x.y * x, row.z + per_x.z * x);
            let scale = 1.0 / (rx * rx + ry * ry + rz * rz).sqrt();
            let (rx, ry, rz) = (rx * scale, ry * scale, rz * scale);
            let along = rx * nx.0[i] + ry * ny.0[i] + rz * nz.0[i];
            let (tx, ty, tz) =
                (rx - nx.0[i] * (2.0 * along), ry - ny.0[i] * (2.0 * along), rz - nz.0[i] * (2.0 * along));
            let towards_lamp = tx * towards.x + ty * towards.y + tz * towards.z;
            power[i] = if towards_lamp > 0.0 { towards_lamp } else { 0.0 };
            let grazing = within(1.0 + along, 0.0, 1.0);
            let edge = grazing * grazing * grazing;
            let room = 0.22 + 0.75 * within(tz * 0.7 + 0.45, 0.0, 1.0);
            mirror[i] = (self.mirror.0[i] + 0.25 * self.shine.0[i] * edge) * room * self.ambient.0[i];
        }
        for turn in 0..most_squarings {
            let turn = f32::from(turn);
            for i in 0..LONG {
                power[i] = if self.squarings.0[i] > turn { power[i] * power[i] } else { power[i] };
            }
        }
        for i in 0..LONG {
            let highlight = self.shine.0[i] * power[i] * (0.35 + 0.65 * self.lit.0[i]);
            let amount = if self.shine.0[i] > 0.0 { highlight + mirror[i] } else { 0.0 };
            power[i] = amount;
        }
        for c in 0..3 {
            let (out, tint) = (&mut self.light[c], &self.tint[c]);
            for i in 0..LONG {
                // A tint left over from another strip may be anything.
                let more = if power[i] > 0.0 { tint.0[i] * power[i] } else { 0.0 };
                out.0[i] += more;
            }
        }
    }

    /// What is outside, where it is seen.
    #[inline(always)]
    fn look_outside(&mut self, shader: &Shader<'_>, y: f32, runs: &[(Run, Shine)]) {
        let row = shader.ray(0.0, y);
        let [_, per_x, _] = shader.rays();
        let (mut beyond, mut share, mut up) = ([[0.0; LONG]; 3], [0.0; LONG], [false; LONG]);
        for i in 0..LONG {
            let x = self.x.0[i];
            let (rx, ry, rz) = (row.x + per_x.x * x, row.y + per_x.y * x, row.z + per_x.z * x);
            let z = rz * (1.0 / (rx * rx + ry * ry + rz * rz).sqrt());
            up[i] = z >= 0.0;
            let rise = if up[i] { z * 2.2 } else { z * -9.0 };
            share[i] = if rise < 1.0 { rise } else { 1.0 };
        }
        for (c, beyond) in beyond.iter_mut().enumerate() {
            for i in 0..LONG {
                let end = if up[i] { ZENITH[c] } else { GROUND[c] };
                beyond[i] = HORIZON[c] * (1.0 - share[i]) + end * share[i];
            }
        }
        for (run, _) in runs.iter().filter(|(_, shine)| matches!(shine, Shine::Sky)) {
            for (light, beyond) in self.light.iter_mut().zip(&beyond) {
                light.0[run.from..run.to].copy_from_slice(&beyond[run.from..run.to]);
            }
        }
    }

    #[inline(always)]
    fn write_color(&self, out: &mut [[u8; 4]]) {
        let table = color::srgb_table();
        let mut steps = [[0_u32; LONG]; 3];
        for (steps, light) in steps.iter_mut().zip(&self.light) {
            for i in 0..LONG {
                steps[i] = color::step(light.0[i]);
            }
        }
        for (i, out) in out.iter_mut().enumerate().take(LONG) {
            let channel = |c: usize| table[steps[c][i] as usize & (table.len() - 1)];
            *out = [channel(0), channel(1), channel(2), 255];
        }
    }

    #[inline(always)]
    fn write_normals(&self, out: &mut [[i8; 4]]) {
        let mut bytes = [0_u32; LONG];
        for i in 0..LONG {
            let byte = |value: f32| rounded(value * 127.0) & 0xFF;
            bytes[i] = byte(self.normal[0].0[i]) | byte(self.normal[1].0[i]) << 8 | byte(self.normal[2].0[i]) << 16;
        }
        for (out, bytes) in out.iter_mut().zip(bytes) {
            *out = bytes.to_le_bytes().map(|byte| byte as i8);
        }
    }
}

/// Says of pixels whose id they show.
#[inline(always)]
fn write_id(out: &mut Out<'_>, run: Run, id: u32) {
    if let Some(ids) = &mut out.ids {
        ids[run.from..run.to].fill(id);
    }
}

/// A value between two others; what is no number becomes the least.
#[inline(always)]
fn within(value: f32, least: f32, most: f32) -> f32 {
    let value = if value > least { value } else { least };
    if value < most { value } else { most }
}

/// The whole part of a value from a half on, below four million, or one less if it is whole: much cheaper than a
/// conversion.
#[inline(always)]
fn whole(value: f32) -> u32 {
    const LARGE: f32 = 8_388_608.0;
    ((value - 0.5) + LARGE).to_bits() & 0x7F_FFFF
}

/// The nearest whole number, in two's complement, of a value of a few thousand at most.
#[inline(always)]
fn rounded(value: f32) -> u32 {
    const LARGE: f32 = 12_582_912.0;
    (value + LARGE).to_bits().wrapping_sub(LARGE.to_bits())
}

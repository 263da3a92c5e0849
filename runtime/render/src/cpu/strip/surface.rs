//! What each triangle writes of its pixels: which way they face, what colour they are, how they shine.

use glam::Vec3;

use super::{
    Run, Strip,
    values::{LANES, within},
};
use crate::cpu::facet::{EvenRow, Facet};
use crate::cpu::shade::Shader;
use crate::pattern::Level;

impl Strip {
    #[inline(always)]
    pub(super) fn fill_normal(&mut self, run: Run, normal: Vec3) {
        for from in (run.from..run.to).step_by(LANES) {
            self.normal[0].fill(from, normal.x);
            self.normal[1].fill(from, normal.y);
            self.normal[2].fill(from, normal.z);
        }
    }

    /// Normals, and light from all around.
    #[inline(always)]
    pub(super) fn shape(&mut self, facet: &Facet, run: Run, y: f32) {
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
    pub(super) fn paint(&mut self, shader: &Shader<'_>, facet: &Facet, run: Run, y: f32) {
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
    fn textured(&mut self, level: &Level<'_>, [u, v]: [EvenRow; 2], paint: [f32; 3], from: usize) {
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
}

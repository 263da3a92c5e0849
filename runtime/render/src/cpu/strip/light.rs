//! What light the pixels of a strip send to the eye, whatever they see.

use super::{
    Rays, Run, Strip,
    values::{LONG, whole, within},
};
use crate::cpu::facet::Shine;
use crate::cpu::shade::{ABOVE, BELOW, GROUND, HORIZON, KEY, LIFT_M, Shader, ZENITH};
use crate::cpu::vectors::Vectors;
use crate::shadow::SLANT;

impl Strip {
    /// How much lamplight meets each pixel.
    #[inline(always)]
    pub(super) fn look_for_light(&mut self, vectors: impl Vectors, shader: &Shader<'_>, y: f32, length: usize) {
        let towards = shader.towards_light;
        let rays = Rays::of(shader, y);
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
            let [rx, ry, rz] = rays.at(x);
            let px = eye.x + rx * depth + nx.0[i] * LIFT_M;
            let py = eye.y + ry * depth + ny.0[i] * LIFT_M;
            let pz = eye.z + rz * depth + nz.0[i] * LIFT_M + 0.008;
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
    pub(super) fn illuminate(&mut self) {
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
    pub(super) fn gloss(&mut self, shader: &Shader<'_>, y: f32, most_squarings: u8) {
        let towards = shader.towards_light;
        let rays = Rays::of(shader, y);
        let [nx, ny, nz] = &self.normal;
        let mut power = [0.0; LONG];
        let mut mirror = [0.0; LONG];
        for i in 0..LONG {
            let x = self.x.0[i];
            let [rx, ry, rz] = rays.at(x);
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
    pub(super) fn look_outside(&mut self, shader: &Shader<'_>, y: f32, runs: &[(Run, Shine)]) {
        let rays = Rays::of(shader, y);
        let (mut beyond, mut share, mut up) = ([[0.0; LONG]; 3], [0.0; LONG], [false; LONG]);
        for i in 0..LONG {
            let x = self.x.0[i];
            let [rx, ry, rz] = rays.at(x);
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
}

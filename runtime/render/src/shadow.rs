//! Shadows of everything that stands in the rooms: one map seen from the lamps, slightly from the side.
//!
//! Light falls along one direction everywhere. Every ray of it meets the floor somewhere; the map holds, for each place
//! of the floor, the height at which its ray first meets something, and in which room that is.

use glam::Vec3;

use crate::library::MeshLibrary;
use crate::mesh::Aabb;
use crate::scene::Placed;

/// How far light moves along x and y while it falls by one metre.
pub(crate) const SLANT: [f32; 2] = [0.24, -0.17];
/// Side of a texel, m.
const TEXEL_M: f32 = 0.025;
/// Most texels along a side: a plan larger than this has coarser shadows at its far end, none beyond.
const MOST: usize = 4096;
/// What surrounds the rooms, m.
const MARGIN_M: f32 = 0.6;

/// How fast shadows fade with the height of what throws them, for a step of a texel's value: by 1 over 1.8 m.
const FADE: f32 = 1.0 / (1.8 * 16_000.0);
/// Soiled places kept apart.
const MOST_SOILED: usize = 24;

/// Heights in millimetres in the upper twelve bits, the room in the lower four.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    origin: [f32; 2],
    width: usize,
    height: usize,
    texels: Vec<u16>,
    soiled: Vec<[i32; 4]>,
}

impl ShadowMap {
    pub(crate) fn new(bounds: Aabb) -> Self {
        let size = bounds.size();
        let texels = |length: f32| (((length + 2.0 * MARGIN_M) / TEXEL_M) as usize + 2).min(MOST);
        let (width, height) = if size == Vec3::ZERO { (8, 8) } else { (texels(size.x), texels(size.y)) };
        let low = if size == Vec3::ZERO { Vec3::ZERO } else { bounds.min };
        Self {
            origin: [low.x - MARGIN_M, low.y - MARGIN_M],
            width,
            height,
            texels: vec![0; width * height],
            soiled: Vec::new(),
        }
    }

    /// Says that something came, went or moved within this box.
    pub(crate) fn soil(&mut self, bounds: Aabb) {
        let rect = self.rect(bounds);
        if rect[0] > rect[2] || rect[1] > rect[3] {
            return;
        }
        let touches = |a: &[i32; 4]| a[0] <= rect[2] && a[2] >= rect[0] && a[1] <= rect[3] && a[3] >= rect[1];
        let merged = |a: [i32; 4]| [a[0].min(rect[0]), a[1].min(rect[1]), a[2].max(rect[2]), a[3].max(rect[3])];
        match self.soiled.iter().position(touches) {
            Some(known) => self.soiled[known] = merged(self.soiled[known]),
            None if self.soiled.len() < MOST_SOILED => self.soiled.push(rect),
            None => self.soiled[0] = merged(self.soiled[0]),
        }
    }

    /// Whether it must be redrawn before use.
    pub(crate) fn is_soiled(&self) -> bool {
        !self.soiled.is_empty()
    }

    /// Redraws what is soiled.
    pub(crate) fn clean<'a>(&mut self, meshes: &MeshLibrary, placed: impl Iterator<Item = &'a Placed> + Clone) {
        for clip in core::mem::take(&mut self.soiled) {
            for y in clip[1]..=clip[3] {
                let row = y as usize * self.width;
                self.texels[row + clip[0] as usize..=row + clip[2] as usize].fill(0);
            }
            for placed in placed.clone().filter(|placed| placed.casts_shadow) {
                let own = self.rect(placed.bounds);
                if own[0] <= clip[2] && own[2] >= clip[0] && own[1] <= clip[3] && own[3] >= clip[1] {
                    self.draw(meshes, placed, clip);
                }
            }
        }
    }

    /// Where a box's shadow lies, in texels, cut to the map.
    fn rect(&self, bounds: Aabb) -> [i32; 4] {
        let mut rect = [i32::MAX, i32::MAX, i32::MIN, i32::MIN];
        for corner in bounds.corners() {
            let at = self.project(corner);
            for axis in 0..2 {
                rect[axis] = rect[axis].min(at[axis] as i32 - 2);
                rect[axis + 2] = rect[axis + 2].max(at[axis] as i32 + 2);
            }
        }
        let (right, top) = (self.width as i32 - 1, self.height as i32 - 1);
        [rect[0].max(0), rect[1].max(0), rect[2].min(right), rect[3].min(top)]
    }

    #[inline(always)]
    fn project(&self, point: Vec3) -> [f32; 2] {
        [
            (point.x + SLANT[0] * point.z - self.origin[0]) / TEXEL_M,
            (point.y + SLANT[1] * point.z - self.origin[1]) / TEXEL_M,
        ]
    }

    fn draw(&mut self, meshes: &MeshLibrary, placed: &Placed, clip: [i32; 4]) {
        let mesh = &meshes.model(placed.model).levels[1];
        let room = placed.room as u16;
        let mut corners = Vec::new();
        for (piece, transform) in &placed.pieces {
            let (piece, transform) = (&mesh.pieces[usize::from(*piece)], &placed.transforms[usize::from(*transform)]);
            let range = piece.corners.start as usize..piece.corners.end as usize;
            corners.clear();
            corners.extend(mesh.positions[range].iter().map(|corner| {
                let at = transform.rotation * *corner + transform.offset;
                let [x, y] = self.project(at);
                Vec3::new(x, y, at.z)
            }));
            for triangle in &mesh.triangles[piece.triangles.start as usize..piece.triangles.end as usize] {
                self.fill(triangle.map(|corner| corners[(corner - piece.corners.start) as usize]), clip, room);
            }
        }
    }

    /// Raises every texel whose centre lies in the triangle. Undersides have nothing to add: the upper sides are higher.
    fn fill(&mut self, [a, b, c]: [Vec3; 3], clip: [i32; 4], room: u16) {
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if area <= 1e-6 {
            return;
        }
        let low = a.min(b).min(c);
        let high = a.max(b).max(c);
        let (x0, x1) = ((low.x.floor() as i32).max(clip[0]), (high.x.ceil() as i32).min(clip[2]));
        let (y0, y1) = ((low.y.floor() as i32).max(clip[1]), (high.y.ceil() as i32).min(clip[3]));
        let per_x = ((b.z - a.z) * (c.y - a.y) - (c.z - a.z) * (b.y - a.y)) / area;
        let per_y = ((c.z - a.z) * (b.x - a.x) - (b.z - a.z) * (c.x - a.x)) / area;
        for y in y0..=y1 {
            let py = y as f32 + 0.5;
            let (mut from, mut to) = (x0 as f32, x1 as f32);
            for (p, q) in [(a, b), (b, c), (c, a)] {
                // Inside where (q - p) x (point - p) is not negative.
                let (slope, rest) = (p.y - q.y, (q.x - p.x) * (py - p.y) + (q.y - p.y) * p.x);
                let root = -rest / slope - 0.5;
                if slope > 0.0 {
                    from = from.max(root.ceil());
                } else if slope < 0.0 {
                    to = to.min(root.floor());
                } else if rest < 0.0 {
                    to = -1.0;
                }
            }
            if from > to {
                continue;
            }
            let row = y as usize * self.width;
            for x in from as usize..=to as usize {
                let z = a.z + per_x * (x as f32 + 0.5 - a.x) + per_y * (py - a.y);
                let packed = ((z.clamp(low.z, high.z) * 1000.0).clamp(0.0, 4095.0) as u16) << 4 | room;
                let texel = &mut self.texels[row + x];
                *texel = packed.max(*texel);
            }
        }
    }

    /// How much lamplight reaches a place in `room`, 0 to 1, softly. The place is already off its own surface.
    #[inline(always)]
    pub(crate) fn light(&self, point: Vec3, room: u16) -> f32 {
        let [x, y] = self.project(point);
        let (x, y) = (x - 0.5, y - 0.5);
        if !(x > 2.0 && y > 2.0 && x < self.width as f32 - 4.0 && y < self.height as f32 - 4.0) {
            return 1.0;
        }
        let (ix, iy) = (x as usize, y as usize);
        let (fx, fy) = (x - ix as f32, y - iy as f32);
        let limit = i32::from(((point.z * 1000.0).clamp(0.0, 4095.0) as u16) << 4 | 0xF);
        let row = |j: usize| {
            let start = (iy + j - 1) * self.width + ix - 1;
            &self.texels[start..start + 4]
        };
        let rows = [row(0), row(1), row(2), row(3)];
        // Most of a floor lies free.
        if !rows.iter().any(|row| row.iter().any(|texel| i32::from(*texel) > limit)) {
            return 1.0;
        }
        // What hangs high above throws a shadow too soft to be seen.
        let blocked = |texel: u16| {
            let over = i32::from(texel) - limit;
            let dark = (1.3 - over as f32 * FADE).min(1.0);
            if over > 0 && texel & 0xF == room { dark.max(0.0) } else { 0.0 }
        };
        // A tent four texels wide: each sample weighs by how much of it the tent covers.
        let (wx, wy) = (tent(fx), tent(fy));
        let mut dark = 0.0;
        for (texels, weight) in rows.iter().zip(wy) {
            let sum = blocked(texels[0]) * wx[0]
                + blocked(texels[1]) * wx[1]
                + blocked(texels[2]) * wx[2]
                + blocked(texels[3]) * wx[3];
            dark += sum * weight;
        }
        1.0 - dark
    }
}

#[inline(always)]
fn tent(f: f32) -> [f32; 4] {
    [(1.0 - f) * 0.25, (2.0 - f) * 0.25, (1.0 + f) * 0.25, f * 0.25]
}

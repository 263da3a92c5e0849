//! Shadows of everything that stands in the rooms: one map seen from the lamps, slightly from the side.
//!
//! Light falls along one direction everywhere. Every ray of it meets the floor somewhere; the map holds, for each place
//! of the floor, the height at which its ray first meets something, and in which room that is.

use glam::Vec3;

use crate::library::MeshLibrary;
use crate::mesh::Aabb;
use crate::placed::Placed;
use crate::veil::Veil;

/// How far light moves along x and y while it falls by one metre.
pub const SLANT: [f32; 2] = [0.24, -0.17];

/// The direction towards the light.
#[must_use]
pub fn towards_light() -> Vec3 {
    Vec3::new(-SLANT[0], -SLANT[1], 1.0).normalize()
}

/// Side of a texel, m.
const TEXEL_M: f32 = 0.025;
/// Most texels along a side: a plan larger than this has coarser shadows at its far end, none beyond.
const MOST: usize = 4096;
/// What surrounds the rooms, m.
const MARGIN_M: f32 = 0.6;

/// How fast shadows fade with the height of what throws them, for a step of a texel's value: by 1 over 1.8 m.
pub const FADE: f32 = 1.0 / (1.8 * 16_000.0);
/// Texels along a side of a square whose greatest height is kept, a power of two.
const CELL: usize = 4;
/// Texels that a look meets before and after its own.
const BEFORE: usize = 1;
const AFTER: usize = 2;
/// Soiled places kept apart.
const MOST_SOILED: usize = 24;

/// Heights in millimetres in the upper twelve bits, the room in the lower four.
#[derive(Debug)]
pub(crate) struct ShadowMap {
    origin: [f32; 2],
    width: usize,
    height: usize,
    texels: Vec<u16>,
    /// For each square of [`CELL`] by [`CELL`] texels the most that a look at one of them meets; before them a free one.
    cells: Vec<u16>,
    cells_a_row: usize,
    soiled: Vec<[i32; 4]>,
    /// How often it was redrawn.
    revision: u64,
}

impl ShadowMap {
    pub(crate) fn new(bounds: Aabb) -> Self {
        let size = bounds.size();
        let texels = |length: f32| (((length + 2.0 * MARGIN_M) / TEXEL_M) as usize + 2).min(MOST);
        let (width, height) = if size == Vec3::ZERO { (8, 8) } else { (texels(size.x), texels(size.y)) };
        let low = if size == Vec3::ZERO { Vec3::ZERO } else { bounds.min };
        let cells_a_row = width.div_ceil(CELL);
        Self {
            cells: vec![0; cells_a_row * height.div_ceil(CELL) + 1],
            cells_a_row,
            origin: [low.x - MARGIN_M, low.y - MARGIN_M],
            width,
            height,
            texels: vec![0; width * height],
            soiled: Vec::new(),
            revision: 0,
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
        self.revision += 1;
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
            self.sum_up(clip);
        }
    }

    /// Works out the greatest heights around some texels.
    fn sum_up(&mut self, clip: [i32; 4]) {
        let clip = clip.map(|texel| texel as usize);
        let first = [clip[0], clip[1]].map(|texel| texel.saturating_sub(AFTER) / CELL);
        let last = [clip[2], clip[3]].map(|texel| texel + BEFORE).map(|texel| texel / CELL);
        for row in first[1]..=last[1].min(self.height.div_ceil(CELL) - 1) {
            let top = (row * CELL).saturating_sub(BEFORE);
            let bottom = (row * CELL + CELL + AFTER).min(self.height);
            for column in first[0]..=last[0].min(self.cells_a_row - 1) {
                let left = (column * CELL).saturating_sub(BEFORE);
                let right = (column * CELL + CELL + AFTER).min(self.width);
                let texels = (top..bottom).flat_map(|y| &self.texels[y * self.width + left..y * self.width + right]);
                self.cells[row * self.cells_a_row + column + 1] = texels.copied().max().unwrap_or(0);
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
        let room = u16::from(placed.shadow_room);
        let mut corners = Vec::new();
        for (piece, transform) in &placed.pieces {
            let (piece, transform) = (&mesh.pieces[usize::from(*piece)], &placed.transforms[usize::from(*transform)]);
            if piece.veil == Some(Veil::Airy) {
                continue;
            }
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

    /// How often it was redrawn.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// Texels a row, and rows.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Row by row: heights in millimetres in the upper twelve bits, the room in the lower four.
    pub(crate) fn texels(&self) -> &[u16] {
        &self.texels
    }

    /// Texels a metre.
    #[inline(always)]
    pub(crate) fn texels_a_metre(&self) -> f32 {
        1.0 / TEXEL_M
    }

    /// Where its first texel lies, m.
    #[inline(always)]
    pub(crate) fn origin(&self) -> [f32; 2] {
        self.origin
    }

    /// The greatest place that can be looked up, in texels; the least is 2.
    #[inline(always)]
    pub(crate) fn most(&self) -> [f32; 2] {
        [self.width as f32 - 4.0, self.height as f32 - 4.0]
    }

    /// Which cell tells of a texel; 0 is one that is free.
    #[inline(always)]
    pub(crate) fn cell(&self, x: u32, y: u32) -> u32 {
        y / CELL as u32 * self.cells_a_row as u32 + x / CELL as u32 + 1
    }

    /// Whether anything around a cell's texels lies above a limit: see [`Around::light`].
    #[inline(always)]
    pub(crate) fn may_shade(&self, cell: u32, limit: i32) -> bool {
        i32::from(self.cells[cell as usize]) > limit
    }

    /// What lies around a place, in texels, at least 2 and at most [`Self::most`] from the map's edge.
    #[inline(always)]
    pub(crate) fn around(&self, [x, y]: [f32; 2]) -> Around<'_> {
        let (ix, iy) = (x as usize, y as usize);
        let first = (iy - BEFORE) * self.width + ix - BEFORE;
        let row = |row: usize| self.texels[first + row * self.width..].first_chunk().unwrap_or(&[0; SIDE]);
        Around { texels: [row(0), row(1), row(2), row(3)], beyond: [x - ix as f32, y - iy as f32] }
    }
}

/// Texels along a side of what a look at the map meets.
const SIDE: usize = BEFORE + 1 + AFTER;

/// What a look at the map meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around<'a> {
    /// Row by row.
    pub texels: [&'a [u16; SIDE]; SIDE],
    /// How far the place lies beyond the middle of its own texel, along rows and down.
    pub beyond: [f32; 2],
}

impl Around<'_> {
    /// How much lamplight reaches the place if it is in `room`, 0 to 1, softly. The place is already off its own surface;
    /// `limit` is the greatest texel that throws no shadow on it.
    #[inline(always)]
    pub(crate) fn light(&self, limit: i32, room: u16) -> f32 {
        let [across, down] = self.beyond.map(tent);
        let mut dark = [0.0; SIDE * SIDE];
        for (i, dark) in dark.iter_mut().enumerate() {
            let texel = i32::from(self.texels[i / SIDE][i % SIDE]);
            let over = texel - limit;
            // What hangs high above throws a shadow too soft to be seen.
            let own = 1.3 - over as f32 * FADE;
            let own = if own > 0.0 { own } else { 0.0 };
            let own = if own < 1.0 { own } else { 1.0 };
            let counts = over > 0 && texel & 0xF == i32::from(room);
            *dark = if counts { own * (across[i % SIDE] * down[i / SIDE]) } else { 0.0 };
        }
        // Added in halves, as vectors are.
        let halves: [f32; 8] = core::array::from_fn(|i| dark[i] + dark[i + 8]);
        let quarters: [f32; 4] = core::array::from_fn(|i| halves[i] + halves[i + 4]);
        1.0 - ((quarters[0] + quarters[2]) + (quarters[1] + quarters[3]))
    }
}

/// A tent four texels wide: each sample weighs by how much of it the tent covers.
#[inline(always)]
fn tent(f: f32) -> [f32; 4] {
    [(1.0 - f) * 0.25, (2.0 - f) * 0.25, (1.0 + f) * 0.25, f * 0.25]
}

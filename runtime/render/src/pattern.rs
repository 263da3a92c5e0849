//! Procedural patterns: wood grain, bricks, tiles, weave. Each is painted once into a small repeating picture with
//! coarser copies, so that far surfaces neither shimmer nor cost more.
//!
//! A pattern modulates a surface's colour; it never knows which colour that is.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::noise::{cells, fractal, value};

/// How a surface looks beyond its colour.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u8)]
pub(crate) enum Pattern {
    /// Matt.
    Plain,
    /// Letters: matt and without shadow tricks.
    Ink,
    /// A soft highlight.
    Plastic,
    /// Brushed, mirrors the room a little.
    Metal,
    /// Grain along `u`.
    Wood,
    /// A sharp highlight.
    Glass,
    /// A bright highlight.
    Ceramic,
    /// A weave.
    Fabric,
    /// Fibres, faintly.
    Paper,
    /// Shines by itself.
    Glow,
    /// Courses of bricks.
    Brick,
    /// Square tiles with joints.
    Tile,
    /// Short pile.
    Carpet,
    /// Veins.
    Leaf,
    /// Speckled.
    Food,
    /// A painted wall.
    Wall,
    /// Vertical boards, for the lower part of walls.
    Panels,
    /// Floor boards along `u`.
    Planks,
    /// A poured floor.
    Concrete,
    /// Square ceiling tiles in a grid.
    Ceiling,
    /// A lamp: shines while its room is lit.
    Lamp,
    /// What is seen through a window to the outside.
    Sky,
    /// A clear pane, or the wall of a glass.
    Clear,
    /// A clear fluid.
    Liquid,
    /// Steam and cold air.
    Mist,
    /// Light in the air.
    Beam,
}

/// How light plays on a pattern.
#[derive(Clone, Copy, Debug)]
pub struct Gloss {
    /// Strength of the highlight.
    pub shine: f32,
    /// Its sharpness: how often the cosine is squared.
    pub squarings: u8,
    /// How much of the surroundings it mirrors.
    pub mirror: f32,
    /// Whether the highlight takes the surface's own colour, as on metal.
    pub colored: bool,
}

impl Pattern {
    /// Those that have a picture.
    pub(crate) const TEXTURED: [Self; 14] = [
        Self::Wall,
        Self::Metal,
        Self::Wood,
        Self::Planks,
        Self::Ceiling,
        Self::Fabric,
        Self::Paper,
        Self::Brick,
        Self::Tile,
        Self::Carpet,
        Self::Leaf,
        Self::Food,
        Self::Panels,
        Self::Concrete,
    ];

    /// Whether it has a picture.
    pub(crate) fn is_textured(self) -> bool {
        Self::TEXTURED.contains(&self)
    }

    /// Which of [`Self::TEXTURED`] it is.
    pub(crate) fn picture_index(self) -> Option<usize> {
        Self::TEXTURED.iter().position(|textured| *textured == self)
    }

    /// The length of its picture's side, m.
    const fn period_m(self) -> f32 {
        match self {
            Self::Wood => 0.8,
            Self::Fabric => 0.08,
            Self::Paper | Self::Food | Self::Leaf => 0.16,
            Self::Metal => 0.3,
            Self::Brick => 0.9,
            Self::Tile => 1.2,
            Self::Carpet => 0.5,
            Self::Panels => 0.4,
            Self::Planks => 2.4,
            Self::Concrete => 3.0,
            Self::Ceiling => 1.2,
            _ => 2.0,
        }
    }

    /// How light plays on it.
    pub(crate) const fn gloss(self) -> Gloss {
        let (shine, squarings, mirror, colored) = match self {
            Self::Plastic => (0.22, 5, 0.03, false),
            Self::Metal => (0.55, 5, 0.42, true),
            Self::Wood => (0.10, 4, 0.0, false),
            Self::Glass => (0.9, 7, 0.22, false),
            Self::Ceramic => (0.55, 6, 0.08, false),
            Self::Food => (0.12, 4, 0.0, false),
            Self::Leaf => (0.08, 3, 0.0, false),
            Self::Tile => (0.12, 5, 0.05, false),
            Self::Planks => (0.12, 4, 0.03, false),
            Self::Concrete => (0.05, 3, 0.0, false),
            Self::Panels => (0.06, 4, 0.0, false),
            _ => (0.0, 0, 0.0, false),
        };
        Gloss { shine, squarings, mirror, colored }
    }

    /// Its picture at a place of the unit square, which repeats: a factor on each channel, 1 on average or so.
    fn paint(self, u: f32, v: f32) -> [f32; 3] {
        let grey = |g: f32| [g, g, g];
        match self {
            Self::Wood => grain(u, v, 0),
            Self::Fabric => {
                let weave = wave(u * 24.0) * wave(v * 24.0 + if (u * 24.0) as i32 % 2 == 0 { 0.5 } else { 0.0 });
                grey(0.86 + 0.2 * weave + 0.12 * fractal(u, v, 16, 3, 11))
            }
            Self::Paper => grey(0.97 + 0.06 * fractal(u, v, 12, 3, 5)),
            Self::Food => {
                let spots = fractal(u, v, 9, 3, 21);
                [0.86 + 0.28 * spots, 0.84 + 0.3 * spots, 0.82 + 0.32 * spots]
            }
            Self::Leaf => {
                let vein = (wave(u * 10.0 + v * 10.0) * 0.5 + 0.5).max(wave(u * 10.0 - v * 10.0) * 0.5 + 0.5);
                let tone = 0.8 + 0.22 * vein + 0.25 * (fractal(u, v, 6, 3, 31) - 0.5);
                [tone * 0.97, tone, tone * 0.93]
            }
            Self::Metal => grey(0.93 + 0.14 * value(u * 4.0, v * 128.0, 4, 128, 41)),
            Self::Brick => brick(u, v),
            Self::Tile => tile(u, v),
            Self::Carpet => {
                let pile = value(u * 128.0, v * 128.0, 128, 128, 51);
                let tone = 0.74 + 0.34 * pile + 0.3 * (fractal(u, v, 6, 4, 52) - 0.5);
                grey(tone + 0.09)
            }
            Self::Wall => grey(0.965 + 0.07 * fractal(u, v, 6, 5, 61)),
            Self::Panels => {
                let board = (u * 4.0).fract();
                let groove = smooth(0.0, 0.035, board) * smooth(0.0, 0.02, 1.0 - board);
                let lip = 1.0 + 0.05 * (1.0 - smooth(0.02, 0.09, board));
                grey((0.68 + 0.32 * groove) * lip * (0.985 + 0.03 * fractal(u, v, 8, 3, 71)))
            }
            Self::Planks => planks(u, v),
            Self::Concrete => {
                let blotch = fractal(u, v, 4, 5, 81) - 0.5;
                let speck = value(u * 256.0, v * 256.0, 256, 256, 82) - 0.5;
                grey(1.0 + 0.2 * blotch + 0.07 * speck)
            }
            Self::Ceiling => ceiling(u, v),
            _ => grey(1.0),
        }
    }
}

fn smooth(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A cheap even wave of period 1 between -1 and 1.
fn wave(x: f32) -> f32 {
    let t = (x - x.floor()) * 2.0 - 1.0;
    1.0 - 4.0 * t.abs() * (2.0 - t.abs()) * 0.5
}

fn grain(u: f32, v: f32, seed: u32) -> [f32; 3] {
    let bend = fractal(u, v, 3, 3, seed + 1);
    let rings = value(u * 2.0, v * 26.0 + bend * 5.0, 2, 64, seed + 2);
    let fine = value(u * 10.0, v * 120.0, 10, 120, seed + 3);
    let tone = 0.82 + 0.3 * rings * (0.5 + 0.5 * bend) + 0.1 * fine;
    let warm = 0.06 * (rings - 0.5);
    [tone + warm * 0.4, tone, tone - warm]
}

fn planks(u: f32, v: f32) -> [f32; 3] {
    let rows = 16.0;
    let row = (v * rows).floor();
    let shift = cells(row as i32, 7, 91);
    let along = (u * 2.0 + shift).rem_euclid(2.0);
    let plank = along.floor() as i32;
    let (x, y) = (along.fract(), (v * rows).fract());
    let gap = smooth(0.0, 0.0035, x.min(1.0 - x)) * smooth(0.0, 0.035, y.min(1.0 - y));
    let own = cells(row as i32, plank, 92);
    let wood = grain((u + own).fract(), (v * 0.75 + own * 3.0).fract(), 93);
    let tone = (0.86 + 0.26 * own) * (0.5 + 0.5 * gap);
    wood.map(|channel| channel * tone)
}

fn brick(u: f32, v: f32) -> [f32; 3] {
    let (columns, rows) = (4.0, 12.0);
    let row = (v * rows).floor();
    let x = u * columns + if row as i32 % 2 == 0 { 0.5 } else { 0.0 };
    let (column, fx, fy) = (x.rem_euclid(columns).floor() as i32, x.fract(), (v * rows).fract());
    let rough = (fractal(u, v, 24, 3, 101) - 0.5) * 0.02;
    let inside = smooth(0.012, 0.035, fx.min(1.0 - fx) + rough) * smooth(0.04, 0.11, fy.min(1.0 - fy) + rough * 3.0);
    let own = cells(column, row as i32, 102);
    let warm = cells(column, row as i32, 103) - 0.5;
    let tone = 0.78 + 0.34 * own + 0.3 * (fractal(u, v, 24, 4, 104) - 0.5);
    let lit = 1.0 + 0.12 * smooth(0.75, 0.92, fy) - 0.1 * smooth(0.25, 0.08, fy);
    let fired = [tone * (1.0 + 0.12 * warm) * lit, tone * (1.0 - 0.06 * warm) * lit, tone * (1.0 - 0.1 * warm) * lit];
    let mortar = 0.95 + 0.2 * (fractal(u, v, 32, 2, 105) - 0.5);
    let joint = [mortar * 0.92, mortar * 1.12, mortar * 1.25];
    core::array::from_fn(|channel| joint[channel] + (fired[channel] - joint[channel]) * inside)
}

fn tile(u: f32, v: f32) -> [f32; 3] {
    let count = 3.0;
    let (x, y) = (u * count, v * count);
    let (fx, fy) = (x.fract(), y.fract());
    let edge = fx.min(1.0 - fx).min(fy.min(1.0 - fy));
    let face = smooth(0.008, 0.02, edge);
    let own = cells(x as i32, y as i32, 111) - 0.5;
    let tone = 1.0 + 0.06 * own + 0.07 * (fractal(u, v, 9, 4, 112) - 0.5);
    let rim = 1.0 - 0.06 * (1.0 - smooth(0.02, 0.05, edge));
    let g = 0.66 + (tone * rim - 0.66) * face;
    [g, g, g]
}

fn ceiling(u: f32, v: f32) -> [f32; 3] {
    let (fx, fy) = ((u * 2.0).fract(), (v * 2.0).fract());
    let edge = fx.min(1.0 - fx).min(fy.min(1.0 - fy));
    let speck = value(u * 200.0, v * 200.0, 200, 200, 121);
    let pores = 1.0 - 0.1 * smooth(0.78, 0.95, speck);
    let bar = smooth(0.014, 0.02, edge);
    let shade = 1.0 - 0.22 * (1.0 - smooth(0.02, 0.045, edge));
    let g = 1.0 + (0.98 * pores * shade - 1.0) * bar;
    [g, g, g]
}

/// Texels along a side of the finest picture.
pub(crate) const SIDE: usize = 256;
/// Copies, each half as fine: down to 2 by 2.
pub(crate) const LEVELS: usize = 8;

/// One picture and its coarser copies, one after another; texels hold factors times 128, a byte a channel from
/// the lowest.
#[derive(Debug)]
pub(crate) struct Picture {
    texels: Vec<u32>,
    starts: [usize; LEVELS],
    per_m: f32,
    /// Texels a square metre, somewhat more than there are.
    squared: f32,
}

/// All pictures, by pattern, each painted on first use.
pub(crate) struct Pictures {
    all: [OnceLock<Picture>; Pattern::TEXTURED.len()],
}

impl Pictures {
    /// The pictures.
    pub(crate) fn get() -> &'static Self {
        static ALL: Pictures = Pictures { all: [const { OnceLock::new() }; Pattern::TEXTURED.len()] };
        &ALL
    }

    /// The picture of a pattern; nothing if it has none.
    pub(crate) fn of(&self, pattern: Pattern) -> Option<&Picture> {
        let index = pattern.picture_index()?;
        Some(self.all[index].get_or_init(|| Picture::paint(pattern)))
    }

    /// Paints what is not painted yet, until `stop` is set.
    pub(crate) fn paint_all(&self, stop: &AtomicBool) {
        for pattern in Pattern::TEXTURED {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            self.of(pattern);
        }
    }
}

impl Picture {
    fn paint(pattern: Pattern) -> Self {
        let mut all = Vec::with_capacity(SIDE * SIDE * 4 / 3 + 1);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let place = |i: usize| (i as f32 + 0.5) / SIDE as f32;
                let factors = pattern.paint(place(x), place(y)).map(|f| (f * 128.0 + 0.5).clamp(0.0, 255.0) as u8);
                all.push([factors[0], factors[1], factors[2], 0]);
            }
        }
        let per_m = SIDE as f32 / pattern.period_m();
        let mut picture = Self { texels: Vec::new(), starts: [0; LEVELS], per_m, squared: per_m * per_m * 1.69 };
        for level in 1..LEVELS {
            let (start, side) = (picture.starts[level - 1], SIDE >> (level - 1));
            picture.starts[level] = all.len();
            for y in (0..side).step_by(2) {
                for x in (0..side).step_by(2) {
                    let texel = |dx: usize, dy: usize| all[start + (y + dy) * side + x + dx];
                    let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
                    let mean = |c: usize| ((four.iter().map(|t| u32::from(t[c])).sum::<u32>() + 2) / 4) as u8;
                    let texel = [mean(0), mean(1), mean(2), 0];
                    all.push(texel);
                }
            }
        }
        picture.texels = all.into_iter().map(u32::from_le_bytes).collect();
        picture
    }

    /// The texels of one copy.
    pub(crate) fn texels(&self, level: usize) -> &[u32] {
        let side = SIDE >> level;
        &self.texels[self.starts[level]..self.starts[level] + side * side]
    }

    /// Texels a metre, and what is compared with a pixel's footprint, texels a square metre.
    pub(crate) fn density(&self) -> (f32, f32) {
        (self.per_m, self.squared)
    }

    /// Which copy suits a pixel that covers a square of `footprint_m2` of the surface, and that copy's texels a metre.
    #[inline(always)]
    pub(crate) fn level(&self, footprint_m2: f32) -> Level<'_> {
        let texels = footprint_m2 * self.squared;
        let texels = if texels > 1.0 { texels } else { 1.0 };
        // The exponent of a float is the floor of its logarithm; half of that is the root's.
        let level = (((texels.to_bits() >> 23) as usize - 127) / 2).min(LEVELS - 1);
        let side = SIDE >> level;
        let start = self.starts[level];
        Level {
            texels: &self.texels[start..start + side * side],
            shift: 8 - level as u32,
            per_m: self.per_m / (1 << level) as f32,
        }
    }
}

/// The whole number at or below a coordinate, and what is left. Once a float has this large number added, its last
/// bits are the whole number: much cheaper than a conversion.
#[inline(always)]
fn split(x: f32) -> (u32, f32) {
    const LARGE: f32 = 12_582_912.0;
    let sum = (x - 0.5) + LARGE;
    (sum.to_bits(), x - (sum - LARGE))
}

/// One copy of a picture.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a> {
    texels: &'a [u32],
    shift: u32,
    per_m: f32,
}

impl Level<'_> {
    /// The factors at several places, smoothly between texels: an array a channel.
    #[inline(always)]
    pub(crate) fn lanes<const N: usize>(&self, u_m: &[f32; N], v_m: &[f32; N]) -> [[f32; N]; 3] {
        const ONE: f32 = 1.0 / 128.0;
        let mask = (1 << self.shift) - 1;
        let (mut fx, mut fy) = ([0.0; N], [0.0; N]);
        let mut corners = [[0_u32; N]; 4];
        for i in 0..N {
            let ((ix, x), (iy, y)) = (split(u_m[i] * self.per_m - 0.5), split(v_m[i] * self.per_m - 0.5));
            (fx[i], fy[i]) = (x, y);
            let (x0, x1) = (ix & mask, (ix + 1) & mask);
            let (y0, y1) = ((iy & mask) << self.shift, ((iy + 1) & mask) << self.shift);
            corners[0][i] = y0 + x0;
            corners[1][i] = y0 + x1;
            corners[2][i] = y1 + x0;
            corners[3][i] = y1 + x1;
        }
        assert!(!self.texels.is_empty(), "a level has at least four texels");
        // The sides are powers of two: nothing lies beyond this.
        let last = self.texels.len() - 1;
        for corner in &mut corners {
            for place in corner {
                // SAFETY: there are texels, so that what is masked by the number of the last one is the number of one.
                *place = unsafe { *self.texels.get_unchecked(*place as usize & last) };
            }
        }
        let mut factors = [[0.0; N]; 3];
        for (c, factors) in factors.iter_mut().enumerate() {
            // Masked and not shifted, the bytes stay in the vectors that hold the texels.
            let (mask, one) = (0xFF_u32 << (8 * c), ONE / (1_u32 << (8 * c)) as f32);
            for i in 0..N {
                let channel = |corner: usize| (corners[corner][i] & mask) as i32 as f32;
                let near = channel(0) + (channel(1) - channel(0)) * fx[i];
                let far = channel(2) + (channel(3) - channel(2)) * fx[i];
                factors[i] = (near + (far - near) * fy[i]) * one;
            }
        }
        factors
    }

    /// The factors at a place, smoothly between texels.
    #[inline(always)]
    pub(crate) fn at(&self, u_m: f32, v_m: f32) -> [f32; 3] {
        let ((ix, fx), (iy, fy)) = (split(u_m * self.per_m - 0.5), split(v_m * self.per_m - 0.5));
        let mask = (1 << self.shift) - 1;
        let (x0, x1) = ((ix & mask) as usize, ((ix + 1) & mask) as usize);
        let (y0, y1) = (((iy & mask) << self.shift) as usize, (((iy + 1) & mask) << self.shift) as usize);
        let [a, b, c, d] = [y0 + x0, y0 + x1, y1 + x0, y1 + x1].map(|place| self.texels[place].to_le_bytes());
        const ONE: f32 = 1.0 / 128.0;
        let near = [(1.0 - fx) * (1.0 - fy) * ONE, fx * (1.0 - fy) * ONE];
        let far = [(1.0 - fx) * fy * ONE, fx * fy * ONE];
        let channel = |i: usize| {
            f32::from(a[i]) * near[0] + f32::from(b[i]) * near[1] + f32::from(c[i]) * far[0] + f32::from(d[i]) * far[1]
        };
        [channel(0), channel(1), channel(2)]
    }
}

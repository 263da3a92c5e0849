//! Which triangle each pixel sees: exact sides in whole numbers, the nearest triangle wins.

use super::setup::{SUB, Triangle};
use super::vectors::Vectors;

/// Wider triangles are filled span by span, narrower ones tested pixel by pixel.
const NARROW_PX: i32 = 24;
/// Pixels tested at a time.
pub(super) const LANES: usize = 8;
/// Less than the distance of any crossing that is not a whole pixel from the nearest whole pixel.
const CROSSING_SLACK: f64 = 1.0 / (1u64 << 29) as f64;

/// One side, from corner to corner in fractions of pixels: a pixel is inside where the side's value at its centre,
/// `origin + x * per_x + y * per_y`, is not negative.
#[derive(Clone, Copy)]
struct Side {
    from: [i32; 2],
    dx: i32,
    dy: i32,
    per_x: i32,
    per_y: i32,
    /// A pixel's centre on a side belongs to the triangle for which the side is a left or an upper one.
    exclusive: bool,
}

#[inline(always)]
fn side(from: [i32; 2], to: [i32; 2]) -> Side {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let exclusive = dy > 0 || dy == 0 && dx <= 0;
    Side { from, dx, dy, per_x: -dy * SUB, per_y: dx * SUB, exclusive }
}

#[inline(always)]
fn sides(triangle: &Triangle) -> [Side; 3] {
    [0, 1, 2].map(|i| side(triangle.at[i], triangle.at[(i + 1) % 3]))
}

impl Side {
    /// Its value at a pixel's centre, where that fits 32 bits: what does not fit on the way cancels out.
    #[inline(always)]
    fn near(&self, x: i32, y: i32) -> i32 {
        let (x, y) = (x * SUB + SUB / 2 - self.from[0], y * SUB + SUB / 2 - self.from[1]);
        let value = self.dx.wrapping_mul(y).wrapping_sub(self.dy.wrapping_mul(x));
        value.wrapping_sub(i32::from(self.exclusive))
    }

    /// Its value at the centre of the first pixel of a row: exact, as it has far fewer bits than a double.
    #[inline(always)]
    fn far(&self, y: i32) -> f64 {
        let center = SUB / 2;
        let (x, y) = (center - self.from[0], y * SUB + center - self.from[1]);
        f64::from(self.dx) * f64::from(y) - f64::from(self.dy) * f64::from(x) - f64::from(u8::from(self.exclusive))
    }
}

/// Which pixels of a triangle's rows lie inside, one row after the other.
pub(super) struct Spans {
    sides: [Side; 3],
    /// One over the sides' growth a pixel; infinite for sides that lie along the rows, which have no crossings.
    inverse: [f64; 3],
    /// The sides' values at the start of the next row.
    values: [f64; 3],
    /// The columns of the triangle's box.
    columns: [f64; 2],
}

impl Spans {
    /// From the row `top` on.
    #[inline(always)]
    pub(super) fn new(triangle: &Triangle, top: i32) -> Self {
        let sides = sides(triangle);
        Self {
            sides,
            inverse: sides.map(|side| 1.0 / f64::from(side.per_x)),
            values: sides.map(|side| side.far(top)),
            columns: [triangle.rect[0], triangle.rect[2]].map(f64::from),
        }
    }

    /// The first column inside and the last, of which the first is greater where none is.
    #[inline(always)]
    pub(super) fn next_row(&mut self) -> (i32, i32) {
        let [mut from, mut to] = self.columns;
        for (i, side) in self.sides.iter().enumerate() {
            let value = self.values[i];
            self.values[i] += f64::from(side.per_y);
            let crossing = -value * self.inverse[i];
            if side.per_x > 0 {
                let crossing = crossing - CROSSING_SLACK;
                from = if crossing > from { crossing } else { from };
            } else if side.per_x < 0 {
                let crossing = crossing + CROSSING_SLACK;
                to = if crossing < to { crossing } else { to };
            } else if value < 0.0 {
                to = -1.0;
            }
        }
        // A row that the triangle reaches has no crossings farther away; no other is to upset the conversion.
        let from = if from < 65_536.0 { from } else { 65_536.0 };
        let to = if to > -65_536.0 { to } else { -65_536.0 };
        // The first whole number not below, and the last not above.
        (65_536 - (65_536.0 - from) as i32, (to + 1.0) as i32 - 1)
    }
}

/// The rows of a picture that are drawn together.
pub(super) struct Rows<'a> {
    pub first: usize,
    pub count: usize,
    pub width: usize,
    /// The number of the triangle that each pixel sees.
    pub seen: &'a mut [u32],
    /// How near it is there, 1/m.
    pub nearness: &'a mut [f32],
}

impl Rows<'_> {
    /// Draws a triangle that has this number.
    #[inline(always)]
    pub(super) fn draw(&mut self, vectors: impl Vectors, triangle: &Triangle, number: u32) {
        let (first, last) = (self.first as i32, (self.first + self.count) as i32 - 1);
        let (top, bottom) = (i32::from(triangle.rect[1]).max(first), i32::from(triangle.rect[3]).min(last));
        if top > bottom {
            return;
        }
        if is_narrow(triangle) {
            self.narrow(vectors, triangle, number, (top, bottom));
        } else {
            self.wide(vectors, triangle, number, (top, bottom));
        }
    }

    /// Tests eight pixels at a time against all three sides.
    #[inline(always)]
    fn narrow(&mut self, vectors: impl Vectors, triangle: &Triangle, number: u32, (top, bottom): (i32, i32)) {
        let sides = sides(triangle);
        let (left, right) = (i32::from(triangle.rect[0]), i32::from(triangle.rect[2]));
        // Near a narrow triangle's box every value fits 32 bits once it is taken relative to a corner of the box.
        let mut start = sides.map(|side| side.near(left, top));
        let [at_origin, per_x, per_y] = triangle.nearness;
        for y in top..=bottom {
            let row = (y as usize - self.first) * self.width;
            let near = at_origin + per_x * left as f32 + per_y * y as f32;
            for done in (0..=right - left).step_by(LANES) {
                let eight = Eight {
                    sides: [0, 1, 2].map(|s| (start[s] + sides[s].per_x * done, sides[s].per_x)),
                    last: right - left - done,
                    near: (near + per_x * done as f32, per_x),
                    bounds: triangle.bounds,
                    number,
                };
                self.meet(vectors, row + (left + done) as usize, &eight);
            }
            for (value, side) in start.iter_mut().zip(sides) {
                *value += side.per_y;
            }
        }
    }

    #[inline(always)]
    fn meet(&mut self, vectors: impl Vectors, at: usize, eight: &Eight) {
        let seen = self.seen[at..].first_chunk_mut();
        let nearness = self.nearness[at..].first_chunk_mut();
        if let (Some(seen), Some(nearness)) = (seen, nearness) {
            vectors.meet(eight, seen, nearness);
        } else {
            // At the end of the last row there may be fewer.
            eight.meet(&mut self.seen[at..], &mut self.nearness[at..]);
        }
    }

    /// Works out for each row which of its pixels lie inside.
    #[inline(always)]
    fn wide(&mut self, vectors: impl Vectors, triangle: &Triangle, number: u32, (top, bottom): (i32, i32)) {
        let [at_origin, per_x, per_y] = triangle.nearness;
        let mut spans = Spans::new(triangle, top);
        for y in top..=bottom {
            let (from, to) = spans.next_row();
            let row = (y as usize - self.first) * self.width;
            let near = at_origin + per_x * from as f32 + per_y * y as f32;
            for at in (from..=to).step_by(LANES) {
                let eight = Eight {
                    sides: [(0, 0); 3],
                    last: to - at,
                    near: (near + per_x * (at - from) as f32, per_x),
                    bounds: triangle.bounds,
                    number,
                };
                self.meet(vectors, row + at as usize, &eight);
            }
        }
    }
}

/// What a triangle is to eight pixels, side by side. Values are given at the first, with their growth a pixel.
#[derive(Clone, Copy)]
pub(super) struct Eight {
    /// Negative outside of a side.
    pub sides: [(i32, i32); 3],
    /// The last that may lie inside, from 0.
    pub last: i32,
    /// The triangle's nearness, 1/m.
    pub near: (f32, f32),
    /// The least and the greatest of it.
    pub bounds: [f32; 2],
    /// The triangle's number.
    pub number: u32,
}

impl Eight {
    /// Lets pixels that lie inside see it, where nothing nearer is seen.
    #[inline(always)]
    pub(super) fn meet(&self, seen: &mut [u32], nearness: &mut [f32]) {
        let [least, most] = self.bounds;
        for (i, (seen, nearness)) in (0..LANES as i32).zip(seen.iter_mut().zip(nearness)) {
            let value = self.near.0 + self.near.1 * i as f32;
            let value = if value > least { value } else { least };
            let value = if value < most { value } else { most };
            let outside = self.sides.iter().fold(self.last - i, |all, (first, per_x)| all | (first + per_x * i)) < 0;
            let wins = !outside & (value > *nearness);
            *nearness = if wins { value } else { *nearness };
            *seen = if wins { self.number } else { *seen };
        }
    }
}

/// Whether few of its pixels lie side by side, and it is small enough as a whole, also beyond the picture's edges, for
/// [`Rows::narrow`]'s 32 bits: with extents of `w` and `h` pixels no side exceeds `2 * w * h * SUB * SUB`, nor five times
/// as much as far beyond its right end as is tested.
#[inline(always)]
fn is_narrow(triangle: &Triangle) -> bool {
    const MOST_AREA_PX: i64 = 1 << 14;
    if i32::from(triangle.rect[2] - triangle.rect[0]) >= NARROW_PX {
        return false;
    }
    let [a, b, c] = triangle.at;
    let width = a[0].max(b[0]).max(c[0]) - a[0].min(b[0]).min(c[0]);
    let height = a[1].max(b[1]).max(c[1]) - a[1].min(b[1]).min(c[1]);
    (i64::from(width / SUB) + 2) * (i64::from(height / SUB) + 2) < MOST_AREA_PX
}

//! Which triangle each pixel sees: exact sides in whole numbers, the nearest triangle wins.

use super::setup::{SUB, Triangle};

/// Wider triangles are filled span by span, narrower ones tested pixel by pixel.
const NARROW_PX: i32 = 24;
/// Pixels tested at a time.
const LANES: usize = 8;
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
    pub(super) fn draw(&mut self, triangle: &Triangle, number: u32) {
        let (first, last) = (self.first as i32, (self.first + self.count) as i32 - 1);
        let (top, bottom) = (i32::from(triangle.rect[1]).max(first), i32::from(triangle.rect[3]).min(last));
        if top > bottom {
            return;
        }
        let sides = [0, 1, 2].map(|i| side(triangle.at[i], triangle.at[(i + 1) % 3]));
        if is_narrow(triangle) {
            self.narrow(triangle, sides, number, (top, bottom));
        } else {
            self.wide(triangle, sides, number, (top, bottom));
        }
    }

    /// Tests eight pixels at a time against all three sides.
    #[inline(always)]
    fn narrow(&mut self, triangle: &Triangle, sides: [Side; 3], number: u32, (top, bottom): (i32, i32)) {
        let (left, right) = (i32::from(triangle.rect[0]), i32::from(triangle.rect[2]));
        // Near a narrow triangle's box every value fits 32 bits once it is taken relative to a corner of the box.
        let mut start = sides.map(|side| side.near(left, top));
        let [at_origin, per_x, per_y] = triangle.nearness;
        let (mut steps, mut near_steps) = ([[0; LANES]; 3], [0.0; LANES]);
        for i in 0..LANES {
            for (steps, side) in steps.iter_mut().zip(&sides) {
                steps[i] = side.per_x * i as i32;
            }
            near_steps[i] = per_x * i as f32;
        }
        for y in top..=bottom {
            let row = (y as usize - self.first) * self.width;
            let near = at_origin + per_x * left as f32 + per_y * y as f32;
            for done in (0..=right - left).step_by(LANES) {
                let [a, b, c] = [0, 1, 2].map(|s| start[s] + sides[s].per_x * done);
                let near = near + per_x * done as f32;
                let count = right - left - done;
                let (mut value, mut inside) = ([0.0; LANES], [false; LANES]);
                for i in 0..LANES {
                    value[i] = near + near_steps[i];
                    // Negative outside of any side, and beyond the right end.
                    let sides = (a + steps[0][i]) | (b + steps[1][i]) | (c + steps[2][i]) | (count - i as i32);
                    inside[i] = sides >= 0;
                }
                self.meet(row + (left + done) as usize, &value, &inside, triangle.bounds, number);
            }
            for (value, side) in start.iter_mut().zip(sides) {
                *value += side.per_y;
            }
        }
    }

    /// Lets eight pixels that lie inside a triangle see it, where nothing nearer is seen.
    #[inline(always)]
    fn meet(&mut self, at: usize, near: &[f32; LANES], inside: &[bool; LANES], [least, most]: [f32; 2], number: u32) {
        let seen = self.seen[at..].first_chunk_mut::<LANES>();
        let nearness = self.nearness[at..].first_chunk_mut::<LANES>();
        if let (Some(seen), Some(nearness)) = (seen, nearness) {
            for i in 0..LANES {
                let value = within(near[i], least, most);
                let wins = inside[i] & (value > nearness[i]);
                nearness[i] = if wins { value } else { nearness[i] };
                seen[i] = if wins { number } else { seen[i] };
            }
            return;
        }
        // At the end of the last row there may be fewer.
        for (i, (seen, nearness)) in self.seen[at..].iter_mut().zip(&mut self.nearness[at..]).enumerate() {
            let value = within(near[i], least, most);
            if inside[i] && value > *nearness {
                (*seen, *nearness) = (number, value);
            }
        }
    }

    /// Works out for each row which of its pixels lie inside.
    #[inline(always)]
    fn wide(&mut self, triangle: &Triangle, sides: [Side; 3], number: u32, (top, bottom): (i32, i32)) {
        // Of sides that lie along the rows, the inverse is infinite, and so are the crossings, or there are none.
        let inverse = sides.map(|side| 1.0 / f64::from(side.per_x));
        let (first, last) = (f64::from(triangle.rect[0]), f64::from(triangle.rect[2]));
        let mut values = sides.map(|side| side.far(top));
        let [at_origin, per_x, per_y] = triangle.nearness;
        for y in top..=bottom {
            let (mut from, mut to) = (first, last);
            for (i, side) in sides.iter().enumerate() {
                let crossing = -values[i] * inverse[i];
                values[i] += f64::from(side.per_y);
                if side.per_x > 0 {
                    from = if crossing - CROSSING_SLACK > from { crossing - CROSSING_SLACK } else { from };
                } else if side.per_x < 0 {
                    to = if crossing + CROSSING_SLACK < to { crossing + CROSSING_SLACK } else { to };
                } else if values[i] - f64::from(side.per_y) < 0.0 {
                    to = -1.0;
                }
            }
            // The first whole number not below, and the last not above.
            let (from, to) = (65_536 - (65_536.0 - from) as i32, (to + 1.0) as i32 - 1);
            if from > to {
                continue;
            }
            let row = (y as usize - self.first) * self.width;
            let span = row + from as usize..row + to as usize + 1;
            let start = at_origin + per_x * from as f32 + per_y * y as f32;
            for at in span.clone().step_by(LANES) {
                let (done, count) = ((at - span.start) as i32, (span.end - at) as i32);
                let (mut value, mut inside) = ([0.0; LANES], [false; LANES]);
                for i in 0..LANES {
                    value[i] = start + per_x * (done + i as i32) as f32;
                    inside[i] = (i as i32) < count;
                }
                self.meet(at, &value, &inside, triangle.bounds, number);
            }
        }
    }
}

/// A value between two others.
#[inline(always)]
fn within(value: f32, least: f32, most: f32) -> f32 {
    let value = if value > least { value } else { least };
    if value < most { value } else { most }
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

//! Flat drawing with soft edges: rectangles, polygons and strokes on a sheet to scale.

/// A colour, and how much it covers: 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ink(pub [u8; 3], pub f32);

/// A sheet of paper over a part of the world, north up; transparent where nothing was drawn.
#[derive(Clone, Debug)]
pub(crate) struct Paper {
    width: usize,
    height: usize,
    /// Its upper left corner, m.
    origin_m: [f32; 2],
    /// Pixels a metre.
    scale: f32,
    rgba: Vec<u8>,
}

impl Paper {
    /// A sheet of that size at that scale.
    pub(crate) fn new(sides_m: [f32; 2], origin_m: [f32; 2], scale: f32) -> Self {
        let [width, height] = sides_m.map(|side| (side * scale).max(1.0) as usize);
        Self { width, height, origin_m, scale, rgba: vec![0; width * height * 4] }
    }

    /// Pixels across and down.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    pub(crate) fn into_rgba(self) -> Vec<u8> {
        self.rgba
    }

    fn pixel(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [(x - self.origin_m[0]) * self.scale, (self.origin_m[1] - y) * self.scale]
    }

    /// Fills `[west, south, east, north]`, m.
    pub(crate) fn rect(&mut self, [west, south, east, north]: [f32; 4], ink: Ink) {
        let ([left, top], [right, bottom]) = (self.pixel([west, north]), self.pixel([east, south]));
        let part = |low: f32, high: f32, place: f32| (high.min(place + 1.0) - low.max(place)).clamp(0.0, 1.0);
        self.each(([left, top], [right, bottom]), ink, |[x, y]| {
            part(left, right, x - 0.5) * part(top, bottom, y - 0.5)
        });
    }

    /// Fills a convex polygon whose corners, m, go round it counter-clockwise.
    pub(crate) fn polygon(&mut self, corners_m: [[f32; 2]; 4], ink: Ink) {
        let corners = corners_m.map(|corner| self.pixel(corner));
        self.each(around(&corners), ink, |point| (0.5 - outside(&corners, point)).clamp(0.0, 1.0));
    }

    /// Draws the edge of such a polygon, so wide, inside of it.
    pub(crate) fn outline(&mut self, corners_m: [[f32; 2]; 4], width_m: f32, ink: Ink) {
        let corners = corners_m.map(|corner| self.pixel(corner));
        let width = width_m * self.scale;
        self.each(around(&corners), ink, |point| {
            let distance = outside(&corners, point);
            (0.5 - distance).min(distance + width + 0.5).clamp(0.0, 1.0)
        });
    }

    /// Draws strokes, m, so wide, with round ends; where they meet the ink is no thicker.
    pub(crate) fn strokes(&mut self, strokes_m: &[[[f32; 2]; 2]], width_m: f32, ink: Ink) {
        let half = (width_m * self.scale * 0.5).max(0.5);
        let lines: Vec<[[f32; 2]; 2]> = strokes_m.iter().map(|line| line.map(|end| self.pixel(end))).collect();
        let ends: Vec<[f32; 2]> = lines.iter().flatten().copied().collect();
        if ends.is_empty() {
            return;
        }
        let (min, max) = around(&ends);
        let area = (min.map(|low| low - half), max.map(|high| high + half));
        self.each(area, ink, |point| {
            let nearest = lines.iter().map(|line| distance_to(*line, point)).fold(f32::INFINITY, f32::min);
            (half + 0.5 - nearest).clamp(0.0, 1.0)
        });
    }

    /// Inks every pixel of an area by its share.
    fn each(&mut self, (min, max): ([f32; 2], [f32; 2]), Ink(color, strength): Ink, share: impl Fn([f32; 2]) -> f32) {
        // What lies left of or above the sheet becomes 0.
        let [left, top] = min.map(|low| (low - 1.0).max(0.0) as usize);
        let (right, bottom) = ((max[0] + 2.0) as usize, (max[1] + 2.0) as usize);
        for row in top..bottom.min(self.height) {
            for column in left..right.min(self.width) {
                let covered = share([column as f32 + 0.5, row as f32 + 0.5]) * strength;
                if covered > 0.0 {
                    let start = (row * self.width + column) * 4;
                    blend(&mut self.rgba[start..start + 4], color, covered);
                }
            }
        }
    }
}

/// Lays ink over a pixel.
fn blend(pixel: &mut [u8], color: [u8; 3], covered: f32) {
    let below = f32::from(pixel[3]) / 255.0 * (1.0 - covered);
    let all = covered + below;
    for (byte, ink) in pixel.iter_mut().zip(color) {
        *byte = ((f32::from(ink) * covered + f32::from(*byte) * below) / all + 0.5) as u8;
    }
    pixel[3] = (all * 255.0 + 0.5) as u8;
}

fn around(points: &[[f32; 2]]) -> ([f32; 2], [f32; 2]) {
    let start = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    points.iter().fold(start, |(min, max), [x, y]| ([min[0].min(*x), min[1].min(*y)], [max[0].max(*x), max[1].max(*y)]))
}

/// How far a point lies outside of a polygon's nearest side, pixels; negative inside.
fn outside(corners: &[[f32; 2]; 4], [x, y]: [f32; 2]) -> f32 {
    let side = |index: usize| {
        let ([ax, ay], [bx, by]) = (corners[index], corners[(index + 1) % 4]);
        let (dx, dy) = (bx - ax, by - ay);
        // Rows count downwards, so what goes round counter-clockwise in the world has its inside at the left.
        (dx * (y - ay) - dy * (x - ax)) / (dx * dx + dy * dy).sqrt().max(1e-6)
    };
    (0..4).map(side).fold(f32::NEG_INFINITY, f32::max)
}

fn distance_to([[ax, ay], [bx, by]]: [[f32; 2]; 2], [x, y]: [f32; 2]) -> f32 {
    let (dx, dy) = (bx - ax, by - ay);
    let along = (((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy).max(1e-6)).clamp(0.0, 1.0);
    let (ox, oy) = (ax + dx * along - x, ay + dy * along - y);
    (ox * ox + oy * oy).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLACK: Ink = Ink([0; 3], 1.0);

    fn alpha(paper: &Paper, column: usize, row: usize) -> u8 {
        paper.rgba[(row * paper.width + column) * 4 + 3]
    }

    #[test]
    fn shapes_cover_what_they_should() {
        let mut paper = Paper::new([4.0, 4.0], [0.0, 4.0], 10.0);
        paper.rect([1.0, 1.0, 2.05, 2.0], BLACK);
        assert_eq!([9, 10, 19, 20, 21].map(|column| alpha(&paper, column, 25)), [0, 255, 255, 128, 0]);
        assert_eq!([19, 20, 29, 30].map(|row| alpha(&paper, 15, row)), [0, 255, 255, 0]);

        let mut paper = Paper::new([4.0, 4.0], [0.0, 4.0], 10.0);
        paper.polygon([[3.0, 2.0], [2.0, 3.0], [1.0, 2.0], [2.0, 1.0]], BLACK);
        assert_eq!(
            [(20, 20), (12, 12), (12, 20), (29, 29)].map(|(x, y)| alpha(&paper, x, y) > 200),
            [true, false, true, false]
        );

        let mut paper = Paper::new([4.0, 4.0], [0.0, 4.0], 10.0);
        paper.strokes(&[[[1.0, 2.0], [3.0, 2.0]]], 0.4, Ink([9, 9, 9], 0.5));
        assert_eq!([(20, 17), (20, 18), (20, 21), (20, 22)].map(|(x, y)| alpha(&paper, x, y)), [0, 128, 128, 0]);
    }
}

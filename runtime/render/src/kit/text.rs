//! Letters as thin raised strokes.

use glam::Vec3;

use super::glyphs::{ADVANCE, HEIGHT, STROKE, known, strokes};
use super::{Detail, Precision, Solid};

/// How far the strokes stand out, m: enough for the depth buffer at the far end of an office.
pub(super) const RAISE_M: f32 = 0.002;
/// Small letters against capitals.
const SMALL: f32 = 0.78;
/// From line to line, in heights of a capital letter.
const LINE: f32 = 1.6;

/// Lines of text about the origin, facing `+x`: who reads it looks along `-x` and has `+y` to the right.
pub(super) fn build(text: &str, height: f32, precision: &Precision) -> Solid {
    let mut solid = Solid::default();
    let unit = height / HEIGHT;
    let lines: Vec<&str> = text.split('\n').collect();
    let total = (lines.len() as f32 - 1.0) * LINE * height + height;
    for (index, line) in lines.iter().enumerate() {
        let width = (line.chars().count() as f32 * ADVANCE - (ADVANCE - 4.0)) * unit;
        let base = total * 0.5 - height - index as f32 * LINE * height;
        if !is_readable(height, precision) {
            let words = words(line, precision.detail == Detail::Coarse);
            for [first, last] in words {
                let left = |column: usize| column as f32 * ADVANCE * unit - width * 0.5;
                let right = left(last) + 4.0 * unit;
                bar(&mut solid, [left(first), base + height * 0.3], [right, base + height * 0.6]);
            }
            continue;
        }
        for (column, letter) in line.chars().enumerate() {
            let left = column as f32 * ADVANCE * unit - width * 0.5;
            draw(&mut solid, letter, [left, base], unit);
        }
    }
    solid
}

/// Bends text around the z axis, out to a cylinder of this radius.
pub(super) fn wrap(solid: &mut Solid, radius: f32) {
    for (position, normal) in solid.positions.iter_mut().zip(&mut solid.normals) {
        let (sin, cos) = libm::sincosf(position.y / radius);
        *position = Vec3::new((radius + position.x) * cos, (radius + position.x) * sin, position.z);
        *normal = Vec3::new(cos, sin, 0.0);
    }
}

/// Whether letters of this height can be told apart.
fn is_readable(height: f32, precision: &Precision) -> bool {
    let least = match precision.detail {
        Detail::Fine => 2.5,
        Detail::Medium => 4.0,
        Detail::Coarse => f32::INFINITY,
    };
    height >= least * precision.tolerance_m
}

/// The first and the last column of each word, or of the line as one. From far away a word is a grey bar: as wide, and
/// as dark, as its strokes.
fn words(line: &str, as_one: bool) -> Vec<[usize; 2]> {
    let mut words: Vec<[usize; 2]> = Vec::new();
    for (column, _) in line.chars().enumerate().filter(|(_, letter)| *letter != ' ') {
        match words.last_mut() {
            Some(word) if as_one || word[1] + 1 == column => word[1] = column,
            _ => words.push([column, column]),
        }
    }
    words
}

/// The strokes of a line of text in a plane, from its left end on the baseline; capitals are 1 high.
pub(super) fn line(text: &str) -> Vec<[[f32; 2]; 2]> {
    let mut all = Vec::new();
    for (column, letter) in text.chars().enumerate() {
        let capital = letter.to_uppercase().next().unwrap_or(letter);
        let scale = (if capital == letter { 1.0 } else { SMALL }) / HEIGHT;
        let left = column as f32 * ADVANCE / HEIGHT;
        let shape = if known(capital) { capital } else { 'O' };
        let at = |p: [f32; 2]| [left + p[0] * scale, p[1] * scale];
        all.extend(strokes(shape).into_iter().map(|[a, b]| [at(a), at(b)]));
    }
    all
}

fn draw(solid: &mut Solid, letter: char, origin: [f32; 2], unit: f32) {
    let capital = letter.to_uppercase().next().unwrap_or(letter);
    let scale = if capital == letter { unit } else { unit * SMALL };
    // A letter the font lacks shows as a box.
    let shape = if known(capital) { capital } else { 'O' };
    for [a, b] in strokes(shape) {
        let at = |p: [f32; 2]| [origin[0] + p[0] * scale, origin[1] + p[1] * scale];
        stroke(solid, at(a), at(b), unit * STROKE * 0.5);
    }
}

/// A rectangle from `a` to `b`, `half` wide to each side, and as much longer at each end. `a` and `b` count from the
/// left, for who reads it, and from the baseline.
fn stroke(solid: &mut Solid, a: [f32; 2], b: [f32; 2], half: f32) {
    let (dx, dz) = (b[0] - a[0], b[1] - a[1]);
    let length = (dx * dx + dz * dz).sqrt().max(1e-9);
    let (ux, uz) = (dx / length * half, dz / length * half);
    let at = |p: [f32; 2], along: f32, across: f32| {
        Vec3::new(RAISE_M, p[0] + ux * along - uz * across, p[1] + uz * along + ux * across)
    };
    solid.face([at(a, -1.0, -1.0), at(b, 1.0, -1.0), at(b, 1.0, 1.0), at(a, -1.0, 1.0)]);
}

fn bar(solid: &mut Solid, low: [f32; 2], high: [f32; 2]) {
    let at = |y: f32, z: f32| Vec3::new(RAISE_M, y, z);
    solid.face([at(low[0], low[1]), at(high[0], low[1]), at(high[0], high[1]), at(low[0], high[1])]);
}

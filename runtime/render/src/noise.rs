//! Noise on the unit square that repeats at its edges.

/// A number between 0 and 1 for a cell.
pub(crate) fn cells(x: i32, y: i32, seed: u32) -> f32 {
    let mut h =
        (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 15;
    h = h.wrapping_mul(0x2C1B_3C6D);
    h ^= h >> 12;
    h = h.wrapping_mul(0x297A_2D39);
    h ^= h >> 15;
    (h >> 8) as f32 / 16_777_216.0
}

/// Smooth noise between 0 and 1 over a lattice that repeats after `columns` and `rows`.
pub(crate) fn value(x: f32, y: f32, columns: i32, rows: i32, seed: u32) -> f32 {
    let (ix, iy) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy) = (ease(x - ix), ease(y - iy));
    let at = |dx: i32, dy: i32| cells((ix as i32 + dx).rem_euclid(columns), (iy as i32 + dy).rem_euclid(rows), seed);
    let low = at(0, 0) + (at(1, 0) - at(0, 0)) * fx;
    let high = at(0, 1) + (at(1, 1) - at(0, 1)) * fx;
    low + (high - low) * fy
}

/// Octaves of [`value`], each twice as fine and half as strong; between 0 and 1.
pub(crate) fn fractal(u: f32, v: f32, lattice: i32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut total, mut strength, mut size) = (0.0, 0.0, 1.0, lattice);
    for octave in 0..octaves {
        sum += strength * value(u * size as f32, v * size as f32, size, size, seed + octave * 131);
        total += strength;
        strength *= 0.5;
        size *= 2;
    }
    sum / total
}

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
    let ((ix, fx), (iy, fy)) = (split(x), split(y));
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy) = (ease(fx), ease(fy));
    let ((x0, x1), (y0, y1)) = (neighbours(ix, columns), neighbours(iy, rows));
    let near = cells(x0, y0, seed);
    let low = near + (cells(x1, y0, seed) - near) * fx;
    let far = cells(x0, y1, seed);
    let high = far + (cells(x1, y1, seed) - far) * fx;
    low + (high - low) * fy
}

/// The whole number at or below a coordinate, and what is left.
fn split(x: f32) -> (i32, f32) {
    let towards_zero = x as i32;
    let whole = if towards_zero as f32 > x { towards_zero - 1 } else { towards_zero };
    (whole, x - whole as f32)
}

/// The cells at and after `i` of a lattice that repeats; a division only outside of its first copy.
fn neighbours(i: i32, count: i32) -> (i32, i32) {
    let here = if (0..count).contains(&i) { i } else { i.rem_euclid(count) };
    (here, if here + 1 == count { 0 } else { here + 1 })
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

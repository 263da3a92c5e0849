//! Products of matrices, in integers: the same to the bit on every machine.
//!
//! Weights are 8-bit integers with one scale for each output; each row of the input is rounded to 12 bits with its own scale.
//! Sums of up to 8,191 such products fit into 32 bits, so that nothing wraps; a check for it would cost more than the products.
//! Weights lie in the order in which they are needed, so that each of a register's sums is that of an output and none has to be added up in the end.

use crate::sums::nearest;

/// The largest rounded input.
const LARGEST_INPUT: f32 = 2047.0;

/// Outputs whose weights lie together: as many 32-bit sums as a register holds.
const TILE: usize = 16;

/// `y = W x`.
#[derive(Debug)]
pub(crate) struct Linear {
    /// `[tiles, pairs of inputs]`
    weights: Vec<PairWeights>,
    /// Of each output.
    scales: Vec<f32>,
    inputs: usize,
}

/// What the outputs of a tile weigh two neighbouring inputs with: both weights of the first output, both of the second.
type PairWeights = [i8; 2 * TILE];

/// Two neighbouring inputs of a row, rounded.
type Pair = [i16; 2];

impl Linear {
    /// Of weights `[outputs, inputs]` and, for each output, a scale.
    pub(crate) fn new(weights: &[i8], scales: Vec<f32>) -> Self {
        let inputs = weights.len() / scales.len().max(1);
        let pairs = inputs.div_ceil(2);
        let mut tiles = vec![[0; 2 * TILE]; scales.len().div_ceil(TILE) * pairs];
        for (output, weights) in weights.chunks_exact(inputs.max(1)).enumerate() {
            let tile = &mut tiles[output / TILE * pairs..][..pairs];
            for (at, weight) in weights.iter().enumerate() {
                tile[at / 2][2 * (output % TILE) + at % 2] = *weight;
            }
        }
        Self { weights: tiles, scales, inputs }
    }

    pub(crate) const fn outputs(&self) -> usize {
        self.scales.len()
    }

    /// Of `rows` `[n, inputs]`: `[n, outputs]`.
    pub(crate) fn apply(&self, rows: &[f32]) -> Vec<f32> {
        let (rounded, row_scales) = round(rows, self.inputs);
        let pairs = self.inputs.div_ceil(2);
        let sums_of_row = self.outputs().next_multiple_of(TILE);
        let mut sums = vec![0; row_scales.len() * sums_of_row];
        multiply(&rounded, &self.weights, pairs, &mut sums);
        let mut products = Vec::with_capacity(row_scales.len() * self.outputs());
        for (sums, row_scale) in sums.chunks_exact(sums_of_row).zip(row_scales) {
            products.extend(sums.iter().zip(&self.scales).map(|(sum, scale)| *sum as f32 * (scale * row_scale)));
        }
        products
    }
}

/// Each row in whole numbers, and what one of them stands for.
fn round(rows: &[f32], length: usize) -> (Vec<Pair>, Vec<f32>) {
    let mut rounded = Vec::with_capacity(rows.len() / length * length.div_ceil(2));
    let mut scales = Vec::with_capacity(rows.len() / length);
    for row in rows.chunks_exact(length) {
        let mut largest = 1e-9_f32;
        for value in row {
            largest = if value.abs() > largest { value.abs() } else { largest };
        }
        let factor = LARGEST_INPUT / largest;
        let (pairs, last) = row.as_chunks::<2>();
        rounded.extend(pairs.iter().map(|[one, other]| [to_whole(one * factor), to_whole(other * factor)]));
        rounded.extend(last.iter().map(|one| [to_whole(one * factor), 0]));
        scales.push(largest / LARGEST_INPUT);
    }
    (rounded, scales)
}

/// The nearest whole number of one between -2¹¹ and 2¹¹.
pub(crate) fn to_whole(value: f32) -> i16 {
    nearest(value) as i16
}

/// `sums[r, o]`: row `r`, of `pairs`, weighed as output `o` does.
fn multiply(rows: &[Pair], weights: &[PairWeights], pairs: usize, sums: &mut [i32]) {
    #[cfg(target_arch = "x86_64")]
    if x86::multiply(rows, weights, pairs, sums) {
        return;
    }
    // SAFETY: plain numbers need no instructions that a processor may lack.
    unsafe { by_blocks::<[i32; TILE]>(rows, weights, pairs, sums) }
}

/// The sums of a tile's outputs.
///
/// # Safety
/// Whoever calls these runs on a processor that has the instructions of its registers.
trait Sums: Copy {
    /// The weights of a pair of inputs, ready to be multiplied.
    type Weights: Copy;
    unsafe fn zero() -> Self;
    unsafe fn weights(of_pair: &PairWeights) -> Self::Weights;
    /// Plus what the pair comes to.
    unsafe fn plus(self, pair: Pair, weights: Self::Weights) -> Self;
    unsafe fn values(self) -> [i32; TILE];
}

impl Sums for [i32; TILE] {
    type Weights = PairWeights;

    #[inline(always)]
    unsafe fn zero() -> Self {
        [0; TILE]
    }

    #[inline(always)]
    unsafe fn weights(of_pair: &PairWeights) -> PairWeights {
        *of_pair
    }

    #[inline(always)]
    unsafe fn plus(mut self, pair: Pair, weights: PairWeights) -> Self {
        let [one, other] = pair.map(i32::from);
        for (sum, [first, second]) in self.iter_mut().zip(weights.as_chunks::<2>().0) {
            *sum += one * i32::from(*first) + other * i32::from(*second);
        }
        self
    }

    #[inline(always)]
    unsafe fn values(self) -> [i32; TILE] {
        self
    }
}

/// How many tiles are multiplied with rows at once.
const TILES: usize = 2;

/// The weights of some tiles are read once, and stay near the processor while all rows are multiplied with them.
#[inline(always)]
unsafe fn by_blocks<S: Sums>(rows: &[Pair], weights: &[PairWeights], pairs: usize, sums: &mut [i32]) {
    let sums_of_row = weights.len() / pairs * TILE;
    let whole = weights.chunks_exact(TILES * pairs);
    let rest = whole.remainder();
    let after_whole = sums_of_row / (TILES * TILE) * TILES * TILE;
    // SAFETY: the caller's.
    unsafe {
        for (at, tiles) in whole.enumerate() {
            all_rows::<S, TILES>(rows, tiles, at * TILES * TILE, sums, sums_of_row);
        }
        for (at, tile) in rest.chunks_exact(pairs).enumerate() {
            all_rows::<S, 1>(rows, tile, after_whole + at * TILE, sums, sums_of_row);
        }
    }
}

/// All rows with the weights of `M` tiles, whose first output is `at`: as many rows at once as there are registers for their sums.
#[inline(always)]
unsafe fn all_rows<S: Sums, const M: usize>(
    rows: &[Pair],
    tiles: &[PairWeights],
    at: usize,
    sums: &mut [i32],
    sums_of_row: usize,
) {
    // SAFETY: the caller's.
    unsafe {
        let (rows, sums) = some_rows::<S, 8, M>(rows, tiles, at, sums, sums_of_row);
        let (rows, sums) = some_rows::<S, 4, M>(rows, tiles, at, sums, sums_of_row);
        let (rows, sums) = some_rows::<S, 2, M>(rows, tiles, at, sums, sums_of_row);
        some_rows::<S, 1, M>(rows, tiles, at, sums, sums_of_row);
    }
}

/// The same, `N` rows at once. What is left.
#[inline(always)]
unsafe fn some_rows<'a, S: Sums, const N: usize, const M: usize>(
    rows: &'a [Pair],
    tiles: &[PairWeights],
    at: usize,
    sums: &'a mut [i32],
    sums_of_row: usize,
) -> (&'a [Pair], &'a mut [i32]) {
    let pairs = tiles.len() / M;
    let blocks = rows.chunks_exact(N * pairs);
    let left = blocks.remainder();
    let (sums, sums_left) = sums.split_at_mut(blocks.len() * N * sums_of_row);
    for (rows, sums) in blocks.zip(sums.chunks_exact_mut(N * sums_of_row)) {
        // SAFETY: the caller's.
        let totals = unsafe { block::<S, N, M>(rows, tiles, pairs) };
        for (sums, totals) in sums.chunks_exact_mut(sums_of_row).zip(totals) {
            for (sums, total) in sums[at..].as_chunks_mut::<TILE>().0.iter_mut().zip(totals) {
                // SAFETY: the caller's.
                *sums = unsafe { total.values() };
            }
        }
    }
    (left, sums_left)
}

/// The sums of `N` rows with the weights of `M` tiles.
#[inline(always)]
unsafe fn block<S: Sums, const N: usize, const M: usize>(
    rows: &[Pair],
    tiles: &[PairWeights],
    pairs: usize,
) -> [[S; M]; N] {
    // No closures here: they would not be compiled for the same instructions. Loops that are counted are unrolled: all sums stay in registers.
    let mut row_pairs = [rows; N];
    for row in 0..N {
        row_pairs[row] = &rows[row * pairs..][..pairs];
    }
    let mut tile_weights = [tiles; M];
    for tile in 0..M {
        tile_weights[tile] = &tiles[tile * pairs..][..pairs];
    }
    // SAFETY: the caller's.
    unsafe {
        let mut totals = [[S::zero(); M]; N];
        for pair in 0..pairs {
            let mut weights = [S::weights(&tile_weights[0][pair]); M];
            for tile in 1..M {
                weights[tile] = S::weights(&tile_weights[tile][pair]);
            }
            for row in 0..N {
                for tile in 0..M {
                    totals[row][tile] = totals[row][tile].plus(row_pairs[row][pair], weights[tile]);
                }
            }
        }
        totals
    }
}

/// The same sums in the registers of a processor that has larger ones.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m128i, __m256i, __m512i, _mm256_add_epi32, _mm256_cvtepi8_epi16, _mm256_madd_epi16, _mm256_set1_epi32,
        _mm256_setzero_si256, _mm512_cvtepi8_epi16, _mm512_dpwssd_epi32, _mm512_set1_epi32, _mm512_setzero_si512,
        _mm512_storeu_si512,
    };

    use super::{Pair, PairWeights, Sums, TILE, by_blocks};

    /// Whether this processor has instructions for it, which have then filled in `sums`.
    pub(super) fn multiply(rows: &[Pair], weights: &[PairWeights], pairs: usize, sums: &mut [i32]) -> bool {
        let has_512 = || is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512bw");
        if has_512() && is_x86_feature_detected!("avx512vnni") {
            // SAFETY: this processor has the instructions that the function is compiled for.
            unsafe { multiply_512(rows, weights, pairs, sums) };
        } else if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            unsafe { multiply_256(rows, weights, pairs, sums) };
        } else {
            return false;
        }
        true
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
    fn multiply_512(rows: &[Pair], weights: &[PairWeights], pairs: usize, sums: &mut [i32]) {
        // SAFETY: this function is compiled for the instructions of these registers.
        unsafe { by_blocks::<__m512i>(rows, weights, pairs, sums) }
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn multiply_256(rows: &[Pair], weights: &[PairWeights], pairs: usize, sums: &mut [i32]) {
        // SAFETY: as above.
        unsafe { by_blocks::<[__m256i; 2]>(rows, weights, pairs, sums) }
    }

    impl Sums for __m512i {
        type Weights = Self;

        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller's.
            unsafe { _mm512_setzero_si512() }
        }

        #[inline(always)]
        unsafe fn weights(of_pair: &PairWeights) -> Self {
            // SAFETY: the caller's.
            unsafe { _mm512_cvtepi8_epi16(bytemuck::cast(*of_pair)) }
        }

        #[inline(always)]
        unsafe fn plus(self, pair: Pair, weights: Self) -> Self {
            // SAFETY: the caller's.
            unsafe { _mm512_dpwssd_epi32(self, _mm512_set1_epi32(bytemuck::cast(pair)), weights) }
        }

        #[inline(always)]
        unsafe fn values(self) -> [i32; TILE] {
            let mut values = [0; TILE];
            // SAFETY: as many numbers are written as there are; the instructions are the caller's.
            unsafe { _mm512_storeu_si512(values.as_mut_ptr().cast(), self) };
            values
        }
    }

    impl Sums for [__m256i; 2] {
        type Weights = Self;

        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller's.
            unsafe { [_mm256_setzero_si256(); 2] }
        }

        #[inline(always)]
        unsafe fn weights(of_pair: &PairWeights) -> Self {
            let [first, second]: [__m128i; 2] = bytemuck::cast(*of_pair);
            // SAFETY: the caller's.
            unsafe { [_mm256_cvtepi8_epi16(first), _mm256_cvtepi8_epi16(second)] }
        }

        #[inline(always)]
        unsafe fn plus(self, pair: Pair, weights: Self) -> Self {
            // SAFETY: the caller's.
            unsafe {
                let pair = _mm256_set1_epi32(bytemuck::cast(pair));
                [
                    _mm256_add_epi32(self[0], _mm256_madd_epi16(pair, weights[0])),
                    _mm256_add_epi32(self[1], _mm256_madd_epi16(pair, weights[1])),
                ]
            }
        }

        #[inline(always)]
        unsafe fn values(self) -> [i32; TILE] {
            bytemuck::cast(self)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_plain_loops() {
        for (rows, outputs, inputs) in [(1, 1, 3), (4, 2, 16), (5, 3, 48), (7, 35, 33), (24, 48, 32), (9, 70, 64)] {
            let weights: Vec<i8> = (0..outputs * inputs).map(|i| ((i * 37) % 255) as i8).collect();
            let scales: Vec<f32> = (0..outputs).map(|o| 0.01 * (o + 1) as f32).collect();
            let values: Vec<f32> = (0..rows * inputs).map(|i| ((i * 53) % 101) as f32 / 50.0 - 1.0).collect();
            let linear = Linear::new(&weights, scales.clone());
            let products = linear.apply(&values);
            for r in 0..rows {
                for o in 0..outputs {
                    let terms =
                        (0..inputs).map(|i| values[r * inputs + i] * f32::from(weights[o * inputs + i]) * scales[o]);
                    let (exact, size) = terms.fold((0.0, 0.0), |(sum, size), term| (sum + term, size + term.abs()));
                    let product = products[r * outputs + o];
                    assert!((product - exact).abs() <= 1e-3 * size, "{product} is not {exact}");
                }
            }
        }
    }

    #[test]
    fn every_processor_comes_to_the_same_sums() {
        let (rows, tiles, pairs) = (15, 5, 24);
        let whole = |i: usize, below: usize| ((i * 7919) % (2 * below)) as i16 - below as i16;
        let values: Vec<Pair> = (0..rows * pairs).map(|i| [whole(2 * i, 2047), whole(2 * i + 1, 2047)]).collect();
        let weights: Vec<PairWeights> =
            (0..tiles * pairs).map(|i| std::array::from_fn(|at| whole(2 * TILE * i + at, 127) as i8)).collect();
        let (mut here, mut anywhere) = (vec![0; rows * tiles * TILE], vec![0; rows * tiles * TILE]);
        multiply(&values, &weights, pairs, &mut here);
        // SAFETY: plain numbers need no instructions that a processor may lack.
        unsafe { by_blocks::<[i32; TILE]>(&values, &weights, pairs, &mut anywhere) };
        assert_eq!(here, anywhere);
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            // SAFETY: this processor has the instructions.
            unsafe { x86::multiply_256(&values, &weights, pairs, &mut here) };
            assert_eq!(here, anywhere);
        }
    }
}

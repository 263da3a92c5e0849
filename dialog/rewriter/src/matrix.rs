//! Products of matrices, in integers: the same to the bit on every machine.
//!
//! Weights are 8-bit integers with one scale for each output; each row of the input is rounded to 12 bits with its own scale.
//! Sums of up to 8,191 such products fit into 32 bits, so that nothing wraps; a check for it would cost more than the products.

/// The largest rounded input.
const LARGEST_INPUT: f32 = 2047.0;

/// `y = W x`.
#[derive(Debug)]
pub(crate) struct Linear {
    /// `[outputs, inputs]`
    weights: Vec<i8>,
    scales: Vec<f32>,
    inputs: usize,
}

impl Linear {
    /// Of weights `[outputs, inputs]` and, for each output, a scale.
    pub(crate) fn new(weights: Vec<i8>, scales: Vec<f32>) -> Self {
        let inputs = weights.len() / scales.len().max(1);
        Self { weights, scales, inputs }
    }

    pub(crate) const fn outputs(&self) -> usize {
        self.scales.len()
    }

    /// Of `rows` `[n, inputs]`: `[n, outputs]`.
    pub(crate) fn apply(&self, rows: &[f32]) -> Vec<f32> {
        let count = rows.len() / self.inputs;
        let (rounded, row_scales) = round(rows, self.inputs);
        let mut sums = vec![0; count * self.outputs()];
        multiply(&rounded, &self.weights, self.inputs, &mut sums);
        let mut products = Vec::with_capacity(sums.len());
        for (sums, row_scale) in sums.chunks_exact(self.outputs()).zip(row_scales) {
            products.extend(sums.iter().zip(&self.scales).map(|(sum, scale)| *sum as f32 * (scale * row_scale)));
        }
        products
    }
}

/// Each row in whole numbers, and what one of them stands for.
fn round(rows: &[f32], length: usize) -> (Vec<i16>, Vec<f32>) {
    let mut rounded = vec![0; rows.len()];
    let mut scales = Vec::with_capacity(rows.len() / length);
    for (row, rounded) in rows.chunks_exact(length).zip(rounded.chunks_exact_mut(length)) {
        let mut largest = 1e-9_f32;
        for value in row {
            largest = if value.abs() > largest { value.abs() } else { largest };
        }
        let factor = LARGEST_INPUT / largest;
        for (rounded, value) in rounded.iter_mut().zip(row) {
            *rounded = to_whole(value * factor);
        }
        scales.push(largest / LARGEST_INPUT);
    }
    (rounded, scales)
}

/// The nearest whole number of one between -2¹¹ and 2¹¹; halves to even. Adding 1.5 · 2²³ leaves no place for a fraction.
pub(crate) fn to_whole(value: f32) -> i16 {
    const SHIFT: f32 = 12_582_912.0;
    ((value + SHIFT) - SHIFT) as i16
}

/// `sums[r, o] = rows[r] · weights[o]`, both of `length`.
fn multiply(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
    #[cfg(target_arch = "x86_64")]
    if x86::multiply(rows, weights, length, sums) {
        return;
    }
    multiply_one_by_one(rows, weights, length, sums);
}

fn multiply_one_by_one(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
    let outputs = weights.len() / length;
    for (row, sums) in rows.chunks_exact(length).zip(sums.chunks_exact_mut(outputs)) {
        for (weights, sum) in weights.chunks_exact(length).zip(sums) {
            let products = row.iter().zip(weights).map(|(value, weight)| i32::from(*value) * i32::from(*weight));
            *sum = products.sum();
        }
    }
}

/// The same sums, many products at a time: as many as the processor's registers hold.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m128i, __m256i, __m512i, _mm256_add_epi32, _mm256_cvtepi8_epi16, _mm256_madd_epi16, _mm256_setzero_si256,
        _mm512_cvtepi8_epi16, _mm512_dpwssd_epi32, _mm512_loadu_si512, _mm512_reduce_add_epi32, _mm512_setzero_si512,
    };

    /// Rows, and outputs' weights, that are multiplied with each other at once: all sums stay in registers.
    const ROWS: usize = 4;

    /// Whether this processor has instructions for it, which have then filled in `sums`.
    pub(super) fn multiply(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) -> bool {
        let has_512 = || is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512bw");
        if length.is_multiple_of(__m512i::LANES) && has_512() && is_x86_feature_detected!("avx512vnni") {
            // SAFETY: this processor has the instructions that the function is compiled for.
            unsafe { multiply_512(rows, weights, length, sums) };
        } else if length.is_multiple_of(__m256i::LANES) && is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            unsafe { multiply_256(rows, weights, length, sums) };
        } else {
            return false;
        }
        true
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512vnni")]
    fn multiply_512(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
        // SAFETY: this function is compiled for the instructions of these lanes.
        unsafe { by_blocks::<__m512i, 4>(rows, weights, length, sums) }
    }

    #[target_feature(enable = "avx2")]
    fn multiply_256(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
        // SAFETY: as above.
        unsafe { by_blocks::<__m256i, 2>(rows, weights, length, sums) }
    }

    /// Numbers in one register.
    ///
    /// # Safety
    /// Whoever calls these runs on a processor that has the instructions.
    trait Lanes: Copy {
        /// How many 16-bit numbers it holds.
        const LANES: usize;
        unsafe fn zero() -> Self;
        /// The first numbers of a slice that has so many.
        unsafe fn row(numbers: &[i16]) -> Self;
        unsafe fn weights(numbers: &[i8]) -> Self;
        /// Plus the products of both, neighbours together, in 32 bits.
        unsafe fn plus_products(self, row: Self, weights: Self) -> Self;
        unsafe fn total(self) -> i32;
    }

    impl Lanes for __m256i {
        const LANES: usize = 16;

        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller's.
            unsafe { _mm256_setzero_si256() }
        }

        #[inline(always)]
        unsafe fn row(numbers: &[i16]) -> Self {
            bytemuck::cast(*numbers.first_chunk::<16>().unwrap_or(&[0; 16]))
        }

        #[inline(always)]
        unsafe fn weights(numbers: &[i8]) -> Self {
            let weights: __m128i = bytemuck::cast(*numbers.first_chunk::<16>().unwrap_or(&[0; 16]));
            // SAFETY: the caller's.
            unsafe { _mm256_cvtepi8_epi16(weights) }
        }

        #[inline(always)]
        unsafe fn plus_products(self, row: Self, weights: Self) -> Self {
            // SAFETY: the caller's.
            unsafe { _mm256_add_epi32(self, _mm256_madd_epi16(row, weights)) }
        }

        #[inline(always)]
        unsafe fn total(self) -> i32 {
            bytemuck::cast::<_, [i32; 8]>(self).iter().sum()
        }
    }

    impl Lanes for __m512i {
        const LANES: usize = 32;

        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller's.
            unsafe { _mm512_setzero_si512() }
        }

        #[inline(always)]
        unsafe fn row(numbers: &[i16]) -> Self {
            let numbers = numbers.first_chunk::<32>().unwrap_or(&[0; 32]);
            // SAFETY: as many numbers are read as there are; the instructions are the caller's.
            unsafe { _mm512_loadu_si512(numbers.as_ptr().cast()) }
        }

        #[inline(always)]
        unsafe fn weights(numbers: &[i8]) -> Self {
            let weights: __m256i = bytemuck::cast(*numbers.first_chunk::<32>().unwrap_or(&[0; 32]));
            // SAFETY: the caller's.
            unsafe { _mm512_cvtepi8_epi16(weights) }
        }

        #[inline(always)]
        unsafe fn plus_products(self, row: Self, weights: Self) -> Self {
            // SAFETY: the caller's.
            unsafe { _mm512_dpwssd_epi32(self, row, weights) }
        }

        #[inline(always)]
        unsafe fn total(self) -> i32 {
            // SAFETY: the caller's.
            unsafe { _mm512_reduce_add_epi32(self) }
        }
    }

    /// The products of rows and outputs' weights, `OUTPUTS` of these at once.
    #[inline(always)]
    unsafe fn by_blocks<L: Lanes, const OUTPUTS: usize>(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
        let outputs = weights.len() / length;
        for (rows, sums) in rows.chunks(ROWS * length).zip(sums.chunks_mut(ROWS * outputs)) {
            for (at, weights) in weights.chunks(OUTPUTS * length).enumerate() {
                let is_whole = weights.len() == OUTPUTS * length;
                if is_whole && rows.len() == ROWS * length {
                    // SAFETY: the caller's.
                    let products = unsafe { block::<L, ROWS, OUTPUTS>(rows, weights, length) };
                    for (sums, products) in sums.chunks_exact_mut(outputs).zip(products) {
                        sums[OUTPUTS * at..OUTPUTS * (at + 1)].copy_from_slice(&products);
                    }
                } else if is_whole {
                    for (row, sums) in rows.chunks_exact(length).zip(sums.chunks_exact_mut(outputs)) {
                        // SAFETY: the caller's.
                        let products = unsafe { block::<L, 1, OUTPUTS>(row, weights, length) };
                        sums[OUTPUTS * at..OUTPUTS * (at + 1)].copy_from_slice(&products[0]);
                    }
                } else {
                    for (row, sums) in rows.chunks_exact(length).zip(sums.chunks_exact_mut(outputs)) {
                        for (weights, sum) in weights.chunks_exact(length).zip(&mut sums[OUTPUTS * at..]) {
                            // SAFETY: the caller's.
                            *sum = unsafe { block::<L, 1, 1>(row, weights, length) }[0][0];
                        }
                    }
                }
            }
        }
    }

    /// The products of `N` rows with the weights of `M` outputs.
    #[inline(always)]
    unsafe fn block<L: Lanes, const N: usize, const M: usize>(
        rows: &[i16],
        weights: &[i8],
        length: usize,
    ) -> [[i32; M]; N] {
        // SAFETY: the caller's.
        unsafe {
            let mut sums = [[L::zero(); M]; N];
            for at in (0..length).step_by(L::LANES) {
                let mut columns = [L::zero(); M];
                for (column, weights) in columns.iter_mut().zip(weights.chunks_exact(length)) {
                    *column = L::weights(&weights[at..at + L::LANES]);
                }
                for (sums, row) in sums.iter_mut().zip(rows.chunks_exact(length)) {
                    let row = L::row(&row[at..at + L::LANES]);
                    for (sum, column) in sums.iter_mut().zip(columns) {
                        *sum = sum.plus_products(row, column);
                    }
                }
            }
            // No closures here: they would not be compiled for the same instructions.
            let mut totals = [[0; M]; N];
            for (totals, sums) in totals.iter_mut().zip(sums) {
                for (total, sum) in totals.iter_mut().zip(sums) {
                    *total = sum.total();
                }
            }
            totals
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_plain_loops() {
        for (rows, outputs, inputs) in [(1, 1, 3), (4, 2, 16), (5, 3, 48), (7, 5, 33), (4, 4, 32), (9, 6, 64)] {
            let weights: Vec<i8> = (0..outputs * inputs).map(|i| ((i * 37) % 255) as i8).collect();
            let scales: Vec<f32> = (0..outputs).map(|o| 0.01 * (o + 1) as f32).collect();
            let values: Vec<f32> = (0..rows * inputs).map(|i| ((i * 53) % 101) as f32 / 50.0 - 1.0).collect();
            let linear = Linear::new(weights.clone(), scales.clone());
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
}

//! Products of matrices, in integers: the same to the bit on every machine.
//!
//! Weights are 8-bit integers with one scale for each output; each row of the input is rounded to 12 bits with its own scale.
//! Sums of up to 8,191 such products fit into 32 bits, so that nothing wraps; a check for it would cost more than the products.

/// The largest rounded input.
const LARGEST_INPUT: f32 = 2047.0;

/// `y = W x + b`.
#[derive(Debug)]
pub(crate) struct Linear {
    /// `[outputs, inputs]`
    weights: Vec<i8>,
    scales: Vec<f32>,
    bias: Vec<f32>,
    inputs: usize,
}

impl Linear {
    /// Of weights `[outputs, inputs]` and, for each output, a scale and a bias.
    pub(crate) fn new(weights: Vec<i8>, scales: Vec<f32>, bias: Vec<f32>) -> Self {
        let inputs = weights.len() / scales.len().max(1);
        Self { weights, scales, bias, inputs }
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
            let scaled = sums.iter().zip(&self.scales).zip(&self.bias);
            products.extend(scaled.map(|((sum, scale), bias)| *sum as f32 * (scale * row_scale) + bias));
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
fn to_whole(value: f32) -> i16 {
    const SHIFT: f32 = 12_582_912.0;
    ((value + SHIFT) - SHIFT) as i16
}

/// `sums[r, o] = rows[r] · weights[o]`, both of `length`.
fn multiply(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
    #[cfg(target_arch = "x86_64")]
    if length.is_multiple_of(x86::LANES) && is_x86_feature_detected!("avx2") {
        // SAFETY: this processor has the instructions that the function is compiled for.
        return unsafe { x86::multiply(rows, weights, length, sums) };
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

/// The same sums, sixteen products at a time.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m128i, __m256i, _mm256_add_epi32, _mm256_cvtepi8_epi16, _mm256_madd_epi16, _mm256_setzero_si256,
    };

    pub(super) const LANES: usize = 16;
    /// Rows that are multiplied with two outputs' weights at once: all sums stay in registers.
    const ROWS: usize = 4;

    #[target_feature(enable = "avx2")]
    pub(super) fn multiply(rows: &[i16], weights: &[i8], length: usize, sums: &mut [i32]) {
        let outputs = weights.len() / length;
        let pairs = weights.chunks_exact(2 * length);
        let last = pairs.remainder();
        for (rows, sums) in rows.chunks(ROWS * length).zip(sums.chunks_mut(ROWS * outputs)) {
            for (pair, weights) in pairs.clone().enumerate() {
                let both = weights.split_at(length);
                if rows.len() == ROWS * length {
                    let products = block::<ROWS>(rows, both, length);
                    for (sums, products) in sums.chunks_exact_mut(outputs).zip(products) {
                        sums[2 * pair..2 * pair + 2].copy_from_slice(&products);
                    }
                } else {
                    for (row, sums) in rows.chunks_exact(length).zip(sums.chunks_exact_mut(outputs)) {
                        sums[2 * pair..2 * pair + 2].copy_from_slice(&block::<1>(row, both, length)[0]);
                    }
                }
            }
            if !last.is_empty() {
                for (row, sums) in rows.chunks_exact(length).zip(sums.chunks_exact_mut(outputs)) {
                    sums[outputs - 1] = block::<1>(row, (last, last), length)[0][0];
                }
            }
        }
    }

    /// The products of `N` rows with the weights of two outputs.
    #[target_feature(enable = "avx2")]
    #[inline]
    fn block<const N: usize>(rows: &[i16], weights: (&[i8], &[i8]), length: usize) -> [[i32; 2]; N] {
        let count = length / LANES;
        let mut chunks = [[].as_slice(); N];
        for (chunks, row) in chunks.iter_mut().zip(rows.chunks_exact(length)) {
            *chunks = &row.as_chunks::<LANES>().0[..count];
        }
        let first = &weights.0.as_chunks::<LANES>().0[..count];
        let second = &weights.1.as_chunks::<LANES>().0[..count];
        let mut sums = [[_mm256_setzero_si256(); 2]; N];
        for at in 0..count {
            let first = _mm256_cvtepi8_epi16(bytemuck::cast::<_, __m128i>(first[at]));
            let second = _mm256_cvtepi8_epi16(bytemuck::cast::<_, __m128i>(second[at]));
            for (sums, row) in sums.iter_mut().zip(&chunks) {
                let row = bytemuck::cast::<_, __m256i>(row[at]);
                sums[0] = _mm256_add_epi32(sums[0], _mm256_madd_epi16(row, first));
                sums[1] = _mm256_add_epi32(sums[1], _mm256_madd_epi16(row, second));
            }
        }
        let mut totals = [[0; 2]; N];
        for (totals, sums) in totals.iter_mut().zip(sums) {
            for (total, sum) in totals.iter_mut().zip(sums) {
                *total = bytemuck::cast::<_, [i32; 8]>(sum).iter().sum();
            }
        }
        totals
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_plain_loops() {
        for (rows, outputs, inputs) in [(1, 1, 3), (4, 2, 16), (7, 5, 33), (9, 6, 64)] {
            let weights: Vec<i8> = (0..outputs * inputs).map(|i| ((i * 37) % 255) as i8).collect();
            let scales: Vec<f32> = (0..outputs).map(|o| 0.01 * (o + 1) as f32).collect();
            let bias: Vec<f32> = (0..outputs).map(|o| o as f32).collect();
            let values: Vec<f32> = (0..rows * inputs).map(|i| ((i * 53) % 101) as f32 / 50.0 - 1.0).collect();
            let linear = Linear::new(weights.clone(), scales.clone(), bias.clone());
            let products = linear.apply(&values);
            for r in 0..rows {
                for o in 0..outputs {
                    let terms =
                        (0..inputs).map(|i| values[r * inputs + i] * f32::from(weights[o * inputs + i]) * scales[o]);
                    let (exact, size) = terms.fold((bias[o], 0.0), |(sum, size), term| (sum + term, size + term.abs()));
                    let product = products[r * outputs + o];
                    assert!((product - exact).abs() <= 1e-3 * size, "{product} is not {exact}");
                }
            }
        }
    }
}

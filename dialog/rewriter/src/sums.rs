//! Sums of plain numbers, in a fixed order: the same to the bit on every machine.

/// A function that is compiled for the widest registers that this processor has, too: what it gives is the same, as no sum changes its order.
macro_rules! for_widest_registers {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),*) -> $result:ty $body:block) => {
        $(#[$doc])*
        fn $name($($argument: $type),*) -> $result {
            #[inline(always)]
            fn plain($($argument: $type),*) -> $result $body

            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f")]
                fn wide($($argument: $type),*) -> $result {
                    plain($($argument),*)
                }
                #[target_feature(enable = "avx2")]
                fn half_wide($($argument: $type),*) -> $result {
                    plain($($argument),*)
                }
                if is_x86_feature_detected!("avx512f") {
                    // SAFETY: this processor has the instructions that the function is compiled for.
                    return unsafe { wide($($argument),*) };
                }
                if is_x86_feature_detected!("avx2") {
                    // SAFETY: as above.
                    return unsafe { half_wide($($argument),*) };
                }
            }
            plain($($argument),*)
        }
    };
}
pub(crate) use for_widest_registers;

/// Numbers that are summed side by side: the order of a sum is part of its result.
pub(crate) const LANES: usize = 16;

#[inline(always)]
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    total(lanes) + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f32>()
}

#[inline(always)]
pub(crate) fn sum(values: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            *lane += value;
        }
    }
    total(lanes) + rest.iter().sum::<f32>()
}

/// Halves are added to each other until one is left: the shortest way on every processor.
#[inline(always)]
fn total(mut lanes: [f32; LANES]) -> f32 {
    let mut left = LANES;
    while left > 1 {
        left /= 2;
        for lane in 0..left {
            lanes[lane] += lanes[left + lane];
        }
    }
    lanes[0]
}

/// The nearest whole number of one between -2²² and 2²²; halves to even. Adding 1.5 · 2²³ leaves no place for a fraction.
#[inline(always)]
pub(crate) fn nearest(value: f32) -> f32 {
    const SHIFT: f32 = 12_582_912.0;
    (value + SHIFT) - SHIFT
}

/// `eˣ`, to some 10⁻⁷ of it; 0 where that is less than 10⁻³⁷. Without branches, so that many are computed side by side.
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    /// The natural logarithm of 2: its first bits, so that products with whole numbers are exact, and the rest.
    const LN_2: (f32, f32) = (0.693_359_4, -2.121_944_4e-4);
    let x = x.clamp(-87.0, 88.0);
    let power = nearest(x * std::f32::consts::LOG2_E);
    let rest = x - power * LN_2.0 - power * LN_2.1;
    // The series of eʳ, its last terms weighed for |r| < ln 2 / 2 (Cephes, expf).
    let mut series = 1.987_569_1e-4;
    for weight in [1.398_199_9e-3, 8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 0.5] {
        series = series * rest + weight;
    }
    let series = series * rest * rest + rest + 1.0;
    series * f32::from_bits(((power as i32 + 127) as u32) << 23)
}

#[inline(always)]
pub(crate) fn add(rows: &mut [f32], others: &[f32]) {
    for (value, other) in rows.iter_mut().zip(others) {
        *value += other;
    }
}

/// Adds the others, each times `weight`.
#[inline(always)]
pub(crate) fn add_weighed<const N: usize>(values: &mut [f32; N], weight: f32, others: &[f32; N]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value += weight * other;
    }
}

#[inline(always)]
pub(crate) fn scale(values: &mut [f32], factor: f32) {
    for value in values {
        *value *= factor;
    }
}

/// From scores to weights that sum to 1.
#[inline(always)]
pub(crate) fn softmax(scores: &mut [f32]) {
    let mut largest = f32::NEG_INFINITY;
    for score in &*scores {
        largest = if *score > largest { *score } else { largest };
    }
    for score in &mut *scores {
        *score = exp(*score - largest);
    }
    let total = sum(scores);
    for score in scores {
        *score /= total;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for step in -860..=880 {
            let x = step as f32 / 10.0;
            assert!((exp(x) / libm::expf(x) - 1.0).abs() < 3e-7, "{x}: {} is not {}", exp(x), libm::expf(x));
        }
        assert!(exp(-1e9) < 1e-37);
    }

    #[test]
    fn weights_sum_to_one() {
        let mut scores = vec![3.0, -1.0, 900.0, 899.0];
        softmax(&mut scores);
        assert!((scores.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!((scores[2] / scores[3] - std::f32::consts::E).abs() < 1e-3);
    }
}

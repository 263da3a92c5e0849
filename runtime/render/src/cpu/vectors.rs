//! The processor's vectors: work that is compiled for the widest there are as well as for any, and what is written out
//! for them where the compiler does not find how. The bits are the same with all of them.

use super::raster::{Eight, LANES};
use crate::shadow::Around;

/// What differs between processors.
pub(super) trait Vectors: Copy {
    /// See [`Around::light`].
    fn light(self, around: &Around<'_>, limit: i32, room: u16) -> f32;

    /// See [`Eight::meet`].
    fn meet(self, eight: &Eight, seen: &mut [u32; LANES], nearness: &mut [f32; LANES]);
}

/// No more than what every processor has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plain;

impl Vectors for Plain {
    #[inline(always)]
    fn light(self, around: &Around<'_>, limit: i32, room: u16) -> f32 {
        around.light(limit, room)
    }

    #[inline(always)]
    fn meet(self, eight: &Eight, seen: &mut [u32; LANES], nearness: &mut [f32; LANES]) {
        eight.meet(seen, nearness);
    }
}

/// Proof that the processor has AVX2, and what is compiled for it may run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The proof, if the processor has AVX2.
    pub(crate) fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        return std::arch::is_x86_feature_detected!("avx2").then_some(Self(()));
        #[cfg(not(target_arch = "x86_64"))]
        None
    }
}

/// Runs a function with the widest vectors there are: `wide` says which. The function takes them first, and has to be
/// `#[inline(always)]`, as all that it is to reach, to be compiled for them.
macro_rules! widest {
    ($wide:expr, $work:ident($($argument:ident: $type:ty),* $(,)?)) => {{
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        fn with_avx2(wide: $crate::cpu::vectors::Avx2, $($argument: $type),*) {
            $work(wide, $($argument),*);
        }
        match $wide {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the proof says that the processor has AVX2.
            Some(wide) => unsafe { with_avx2(wide, $($argument),*) },
            _ => $work($crate::cpu::vectors::Plain, $($argument),*),
        }
    }};
}
pub(super) use widest;

#[cfg(target_arch = "x86_64")]
impl Vectors for Avx2 {
    #[inline(always)]
    fn light(self, around: &Around<'_>, limit: i32, room: u16) -> f32 {
        // SAFETY: the proof says that the processor has AVX2.
        unsafe { x86::light(around, limit, room) }
    }

    #[inline(always)]
    fn meet(self, eight: &Eight, seen: &mut [u32; LANES], nearness: &mut [f32; LANES]) {
        // SAFETY: the proof says that the processor has AVX2.
        unsafe { x86::meet(eight, seen, nearness) }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use core::arch::x86_64::*;
    use core::ptr;

    use crate::cpu::raster::{Eight, LANES};
    use crate::shadow::{Around, FADE};

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn light(around: &Around<'_>, limit: i32, room: u16) -> f32 {
        let (across, down) = (tent(around.beyond[0]), tent(around.beyond[1]));
        let across = _mm256_set_m128(across, across);
        let upper = _mm256_set_m128(_mm_shuffle_ps::<0x55>(down, down), _mm_shuffle_ps::<0>(down, down));
        let lower = _mm256_set_m128(_mm_shuffle_ps::<0xFF>(down, down), _mm_shuffle_ps::<0xAA>(down, down));
        let [a, b, c, d] = around.texels;
        let dark = |texels: __m128i, down: __m256| {
            let texels = _mm256_cvtepu16_epi32(texels);
            let over = _mm256_sub_epi32(texels, _mm256_set1_epi32(limit));
            let faded = _mm256_mul_ps(_mm256_cvtepi32_ps(over), _mm256_set1_ps(FADE));
            let own = _mm256_sub_ps(_mm256_set1_ps(1.3), faded);
            let own = _mm256_min_ps(_mm256_max_ps(own, _mm256_setzero_ps()), _mm256_set1_ps(1.0));
            let same = _mm256_cmpeq_epi32(
                _mm256_and_si256(texels, _mm256_set1_epi32(0xF)),
                _mm256_set1_epi32(i32::from(room)),
            );
            let counts = _mm256_and_si256(_mm256_cmpgt_epi32(over, _mm256_setzero_si256()), same);
            _mm256_and_ps(_mm256_castsi256_ps(counts), _mm256_mul_ps(own, _mm256_mul_ps(across, down)))
        };
        let halves = _mm256_add_ps(dark(rows(a, b), upper), dark(rows(c, d), lower));
        let quarters = _mm_add_ps(_mm256_castps256_ps128(halves), _mm256_extractf128_ps::<1>(halves));
        let pairs = _mm_add_ps(quarters, _mm_movehl_ps(quarters, quarters));
        1.0 - _mm_cvtss_f32(_mm_add_ss(pairs, _mm_shuffle_ps::<1>(pairs, pairs)))
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn meet(eight: &Eight, seen: &mut [u32; LANES], nearness: &mut [f32; LANES]) {
        let counted = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let (near, per_x) = eight.near;
        let grown = _mm256_mul_ps(_mm256_set1_ps(per_x), _mm256_cvtepi32_ps(counted));
        let value = _mm256_add_ps(_mm256_set1_ps(near), grown);
        let [least, most] = eight.bounds;
        let value = _mm256_min_ps(_mm256_max_ps(value, _mm256_set1_ps(least)), _mm256_set1_ps(most));
        let mut outside = _mm256_sub_epi32(_mm256_set1_epi32(eight.last), counted);
        for (first, per_x) in eight.sides {
            let grown = _mm256_mullo_epi32(_mm256_set1_epi32(per_x), counted);
            outside = _mm256_or_si256(outside, _mm256_add_epi32(_mm256_set1_epi32(first), grown));
        }
        // SAFETY: both are eight values long, which is what is read and written.
        unsafe {
            let before = _mm256_loadu_ps(nearness.as_ptr());
            let nearer = _mm256_cmp_ps::<_CMP_GT_OQ>(value, before);
            let wins = _mm256_andnot_ps(_mm256_castsi256_ps(outside), nearer);
            _mm256_storeu_ps(nearness.as_mut_ptr(), _mm256_blendv_ps(before, value, wins));
            let seen: *mut f32 = seen.as_mut_ptr().cast();
            let number = _mm256_castsi256_ps(_mm256_set1_epi32(eight.number as i32));
            _mm256_storeu_ps(seen, _mm256_blendv_ps(_mm256_loadu_ps(seen), number, wins));
        }
    }

    /// Two rows of texels.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn rows(upper: &[u16; 4], lower: &[u16; 4]) -> __m128i {
        // SAFETY: rows are eight bytes long, which is what is read of each.
        let [upper, lower] =
            unsafe { [_mm_loadl_epi64(ptr::from_ref(upper).cast()), _mm_loadl_epi64(ptr::from_ref(lower).cast())] };
        _mm_unpacklo_epi64(upper, lower)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn tent(beyond: f32) -> __m128 {
        let slope = _mm_mul_ps(_mm_set1_ps(beyond), _mm_setr_ps(-1.0, -1.0, 1.0, 1.0));
        _mm_mul_ps(_mm_add_ps(_mm_setr_ps(1.0, 2.0, 1.0, 0.0), slope), _mm_set1_ps(0.25))
    }
}

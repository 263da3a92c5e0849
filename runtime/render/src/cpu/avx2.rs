//! Proof that the processor has AVX2, and what is compiled for it may run.

/// Had only where the processor has AVX2. The bits are the same without.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(());

impl Avx2 {
    /// The proof, if the processor has AVX2.
    pub(super) fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        return std::arch::is_x86_feature_detected!("avx2").then_some(Self(()));
        #[cfg(not(target_arch = "x86_64"))]
        None
    }
}

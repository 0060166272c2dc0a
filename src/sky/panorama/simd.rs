//! Which of the processor's vector instructions are used.

use fearless_simd::Level;

/// Returns the instructions to compute with: AVX2 where there is more, since no vector has more than eight floats.
///
/// Only operations whose results IEEE 754 prescribes are used, so that all give the same bits.
#[inline]
pub(crate) fn level() -> Level {
    let level = Level::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    let level = level.as_avx2().map_or(level, Level::Avx2);
    level
}

//! Real numbers, one by one or side by side: formulas that are written once for both, with the same operations in the
//! same order, so that every instruction set gives the same bits.

use core::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

pub(crate) use fearless_simd::{Level, dispatch};
use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x4};

/// One real number, or several of them.
pub(crate) trait Real:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// `value`, as many times as there are numbers in `self`.
    fn all(self, value: f64) -> Self;

    fn sqrt(self) -> Self;

    fn abs(self) -> Self;

    /// `then` where this is less than `other`, `otherwise` where it is not.
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self;

    /// A bit for each number, the first one's the lowest: whether it is less than `other`.
    fn less(self, other: Self) -> u32;

    /// Some functions of each number and its companion.
    fn map<const N: usize>(self, other: Self, f: impl Fn(f64, f64) -> [f64; N]) -> [Self; N];

    /// The larger of two.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.if_less(other, other, self)
    }

    /// The smaller of two.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        other.if_less(self, other, self)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn all(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self < other { then } else { otherwise }
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        u32::from(self < other)
    }

    #[inline(always)]
    fn map<const N: usize>(self, other: Self, f: impl Fn(f64, f64) -> [f64; N]) -> [Self; N] {
        f(self, other)
    }
}

impl<S: Simd> Real for f64x4<S> {
    #[inline(always)]
    fn all(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        SimdFloat::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.simd.abs_f64x4(self)
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        self.simd_lt(other).select(then, otherwise)
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        self.simd_lt(other).to_bitmask() as u32
    }

    #[inline(always)]
    fn map<const N: usize>(self, other: Self, f: impl Fn(f64, f64) -> [f64; N]) -> [Self; N] {
        let (a, b): ([f64; 4], [f64; 4]) = (self.into(), other.into());
        let [f0, f1, f2, f3] = [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])];
        core::array::from_fn(|i| Self::from_slice(self.simd, &[f0[i], f1[i], f2[i], f3[i]]))
    }
}

/// The instruction sets that `DARKNESS_SIMD` may name.
const NAMES: [&str; 4] = ["scalar", "sse4.2", "avx2", "avx512"];

/// The best instruction set of this machine, or the best of those that the environment variable `DARKNESS_SIMD` does
/// not exclude: `scalar`, `sse4.2`, `avx2` or `avx512`.
pub(crate) fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(|| match std::env::var("DARKNESS_SIMD") {
        Ok(name) => capped(&name),
        Err(_) => Level::new(),
    })
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn capped(name: &str) -> Level {
    let best = Level::new();
    match name {
        "scalar" => Level::fallback(),
        "sse4.2" => best.as_sse4_2().map_or(best, Level::Sse4_2),
        "avx2" => best.as_avx2().map_or(best, Level::Avx2),
        _ => best,
    }
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
fn capped(name: &str) -> Level {
    if name == "scalar" {
        Level::fallback()
    } else {
        Level::new()
    }
}

/// Whether `DARKNESS_SIMD` is one of the names there are, or not set.
///
/// # Errors
/// What it is, and the names.
pub fn check_environment() -> Result<(), String> {
    match std::env::var("DARKNESS_SIMD") {
        Ok(name) if !NAMES.contains(&name.as_str()) => Err(format!(
            "DARKNESS_SIMD is `{name}`: set it to {} or {}, or not at all",
            NAMES[..3].join(", "),
            NAMES[3]
        )),
        _ => Ok(()),
    }
}

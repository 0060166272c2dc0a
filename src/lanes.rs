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

    /// One index for each number.
    type Indices: AsRef<[usize]> + Copy;

    /// Rounded to integers, ties to even, none below 0 or above `last`: as indices, and as numbers.
    fn rounded(self, last: i32) -> (Self::Indices, Self);

    /// What stands in a list from each index on.
    fn neighbours(self, list: &[f64], first: Self::Indices) -> [Self; 4];

    /// The least and the greatest in a list from each of one index to each of another one.
    fn range_of(self, list: &[f64], first: Self::Indices, last: Self::Indices) -> [Self; 2];

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

    type Indices = [usize; 1];

    #[inline(always)]
    fn rounded(self, last: i32) -> ([usize; 1], Self) {
        let index = rounded(self, last);
        ([index as usize], f64::from(index))
    }

    #[inline(always)]
    fn neighbours(self, list: &[f64], [first]: [usize; 1]) -> [Self; 4] {
        let four = &list[first..first + 4];
        [four[0], four[1], four[2], four[3]]
    }

    #[inline(always)]
    fn range_of(self, list: &[f64], [first]: [usize; 1], [last]: [usize; 1]) -> [Self; 2] {
        range_of(list, first, last)
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

    type Indices = [usize; 4];

    #[inline(always)]
    fn rounded(self, last: i32) -> ([usize; 4], Self) {
        let (none, last) = (self.all(0.0), self.all(f64::from(last)));
        let number = (self + ROUNDER) - ROUNDER;
        // Not a number is the first one.
        let number = none.if_less(number, number, none);
        let number = number.if_less(last, number, last);
        let sums: [f64; 4] = (number + ROUNDER).into();
        (sums.map(|sum| sum.to_bits() as u32 as usize), number)
    }

    #[inline(always)]
    fn neighbours(self, list: &[f64], [a, b, c, d]: [usize; 4]) -> [Self; 4] {
        let simd = self.simd;
        let (a, b, c, d) = (
            Self::from_slice(simd, &list[a..a + 4]),
            Self::from_slice(simd, &list[b..b + 4]),
            Self::from_slice(simd, &list[c..c + 4]),
            Self::from_slice(simd, &list[d..d + 4]),
        );
        let (ac, bd) = (simd.zip_low_f64x4(a, c), simd.zip_low_f64x4(b, d));
        let (ac_high, bd_high) = (simd.zip_high_f64x4(a, c), simd.zip_high_f64x4(b, d));
        [
            simd.zip_low_f64x4(ac, bd),
            simd.zip_high_f64x4(ac, bd),
            simd.zip_low_f64x4(ac_high, bd_high),
            simd.zip_high_f64x4(ac_high, bd_high),
        ]
    }

    #[inline(always)]
    fn range_of(self, list: &[f64], first: [usize; 4], last: [usize; 4]) -> [Self; 2] {
        let [a, b, c, d] = [
            range_of(list, first[0], last[0]),
            range_of(list, first[1], last[1]),
            range_of(list, first[2], last[2]),
            range_of(list, first[3], last[3]),
        ];
        [
            Self::from_slice(self.simd, &[a[0], b[0], c[0], d[0]]),
            Self::from_slice(self.simd, &[a[1], b[1], c[1], d[1]]),
        ]
    }
}

/// 1.5 · 2⁵²: a sum with it is rounded to an integer, which stands in its lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Whatever the bits hold for what is no such integer, the index is none below 0 or above `last`.
#[inline(always)]
pub(crate) fn rounded(number: f64, last: i32) -> u32 {
    ((number + ROUNDER).to_bits() as i32).max(0).min(last) as u32
}

fn range_of(list: &[f64], first: usize, last: usize) -> [f64; 2] {
    let (mut least, mut greatest) = (list[first], list[first]);
    for &number in &list[first..=last] {
        if number < least {
            least = number;
        }
        if number > greatest {
            greatest = number;
        }
    }
    [least, greatest]
}

/// The instruction sets that `DARKNESS_SIMD` may name.
pub(crate) const NAMES: [&str; 4] = ["scalar", "sse4.2", "avx2", "avx512"];

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
/// What it is.
pub(crate) fn check_environment() -> Result<(), String> {
    match std::env::var("DARKNESS_SIMD") {
        Ok(name) if !NAMES.contains(&name.as_str()) => Err(name),
        Err(std::env::VarError::NotUnicode(name)) => Err(name.to_string_lossy().into_owned()),
        _ => Ok(()),
    }
}

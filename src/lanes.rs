//! Real numbers, one by one or side by side: formulas that are written once for both, with the same operations in the
//! same order, so that every instruction set gives the same bits.

use core::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

use fearless_simd::{Fallback, Select, Simd, SimdBase, SimdFloat, SimdMask, f64x4};

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

/// Four real numbers.
pub(crate) trait Four: Real + Into<[f64; 4]> {
    /// These four: `self` is any.
    fn of(self, numbers: [f64; 4]) -> Self;
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

impl<S: Simd> Four for f64x4<S> {
    #[inline(always)]
    fn of(self, numbers: [f64; 4]) -> Self {
        Self::from_slice(self.simd, &numbers)
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
        ranges_of(self, list, first, last)
    }
}

/// Four numbers one by one, on machines that have no instructions for several at once. (The library's own takes the
/// compiler minutes.)
#[derive(Debug, Clone, Copy)]
pub(crate) struct OneByOne([f64; 4]);

/// One operation on each number.
macro_rules! each {
    ($a:expr, $of:expr) => {{
        let [a0, a1, a2, a3] = $a.0;
        OneByOne([$of(a0), $of(a1), $of(a2), $of(a3)])
    }};
    ($a:expr, $b:expr, $of:expr) => {{
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = ($a.0, $b.0);
        OneByOne([$of(a0, b0), $of(a1, b1), $of(a2, b2), $of(a3, b3)])
    }};
}

/// One operator between numbers, and between them and one number.
macro_rules! operator {
    ($operator:ident, $name:ident) => {
        impl $operator for OneByOne {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                each!(self, other, f64::$name)
            }
        }

        impl $operator<f64> for OneByOne {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: f64) -> Self {
                each!(self, |number: f64| number.$name(other))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for OneByOne {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        each!(self, f64::neg)
    }
}

impl From<OneByOne> for [f64; 4] {
    #[inline(always)]
    fn from(four: OneByOne) -> Self {
        four.0
    }
}

impl Four for OneByOne {
    #[inline(always)]
    fn of(self, numbers: [f64; 4]) -> Self {
        Self(numbers)
    }
}

impl Real for OneByOne {
    #[inline(always)]
    fn all(self, value: f64) -> Self {
        Self([value, value, value, value])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        each!(self, f64::sqrt)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        each!(self, f64::abs)
    }

    #[inline(always)]
    fn if_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        let (a, b, c, d) = (self.0, other.0, then.0, otherwise.0);
        Self([
            a[0].if_less(b[0], c[0], d[0]),
            a[1].if_less(b[1], c[1], d[1]),
            a[2].if_less(b[2], c[2], d[2]),
            a[3].if_less(b[3], c[3], d[3]),
        ])
    }

    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        let (a, b) = (self.0, other.0);
        a[0].less(b[0]) | a[1].less(b[1]) << 1 | a[2].less(b[2]) << 2 | a[3].less(b[3]) << 3
    }

    type Indices = [usize; 4];

    #[inline(always)]
    fn rounded(self, last: i32) -> ([usize; 4], Self) {
        let [a, b, c, d] = [
            rounded(self.0[0], last),
            rounded(self.0[1], last),
            rounded(self.0[2], last),
            rounded(self.0[3], last),
        ];
        (
            [a as usize, b as usize, c as usize, d as usize],
            Self([f64::from(a), f64::from(b), f64::from(c), f64::from(d)]),
        )
    }

    #[inline(always)]
    fn neighbours(self, list: &[f64], [a, b, c, d]: [usize; 4]) -> [Self; 4] {
        let (a, b, c, d) = (
            &list[a..a + 4],
            &list[b..b + 4],
            &list[c..c + 4],
            &list[d..d + 4],
        );
        [
            Self([a[0], b[0], c[0], d[0]]),
            Self([a[1], b[1], c[1], d[1]]),
            Self([a[2], b[2], c[2], d[2]]),
            Self([a[3], b[3], c[3], d[3]]),
        ]
    }

    #[inline(always)]
    fn range_of(self, list: &[f64], first: [usize; 4], last: [usize; 4]) -> [Self; 2] {
        ranges_of(self, list, first, last)
    }
}

#[inline(always)]
fn ranges_of<T: Four>(like: T, list: &[f64], first: [usize; 4], last: [usize; 4]) -> [T; 2] {
    let [a, b, c, d] = [
        range_of(list, first[0], last[0]),
        range_of(list, first[1], last[1]),
        range_of(list, first[2], last[2]),
        range_of(list, first[3], last[3]),
    ];
    [
        like.of([a[0], b[0], c[0], d[0]]),
        like.of([a[1], b[1], c[1], d[1]]),
    ]
}

/// 1.5 · 2⁵²: a sum with it is rounded to an integer, which stands in its lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Whatever the bits hold for what is no such integer, the index is none below 0 or above `last`.
#[inline(always)]
pub(crate) fn rounded(number: f64, last: i32) -> u32 {
    ((number + ROUNDER).to_bits() as i32).max(0).min(last) as u32
}

/// Numbers side by side with others that mean nothing may have the two the other way round: any answer is right then.
fn range_of(list: &[f64], first: usize, last: usize) -> [f64; 2] {
    let (numbers, rest) = list[first..=last.max(first)].as_chunks::<4>();
    let (mut least, mut greatest) = (list[first], list[first]);
    if !numbers.is_empty() {
        // Four that do not wait for each other: close to the disk's plane a patch reaches over all cells.
        let (mut low, mut high) = ([least; 4], [greatest; 4]);
        for four in numbers {
            for i in 0..4 {
                low[i] = four[i].smaller(low[i]);
                high[i] = four[i].larger(high[i]);
            }
        }
        least = (low[0].smaller(low[1])).smaller(low[2].smaller(low[3]));
        greatest = (high[0].larger(high[1])).larger(high[2].larger(high[3]));
    }
    for &number in rest {
        least = number.smaller(least);
        greatest = number.larger(greatest);
    }
    [least, greatest]
}

/// An instruction set that the machine has.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Level {
    /// One number after the other.
    Scalar,
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Sse4_2(fearless_simd::x86::Sse4_2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2(fearless_simd::x86::Avx2),
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512(fearless_simd::x86::Avx512),
    #[cfg(target_arch = "aarch64")]
    Neon(fearless_simd::aarch64::Neon),
}

/// What `$op` is with the instructions of a level: `$simd` is what makes vectors of the library, `$four` any four
/// numbers.
macro_rules! dispatch {
    ($level:expr, |$simd:ident, $four:ident| $op:expr) => {{
        use $crate::lanes::Level;
        match $level {
            Level::Scalar => {
                let ($simd, $four) = $crate::lanes::one_by_one();
                $op
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Sse4_2(simd) => $crate::lanes::dispatch!(@ simd, |$simd, $four| $op),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx2(simd) => $crate::lanes::dispatch!(@ simd, |$simd, $four| $op),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Level::Avx512(simd) => $crate::lanes::dispatch!(@ simd, |$simd, $four| $op),
            #[cfg(target_arch = "aarch64")]
            Level::Neon(simd) => $crate::lanes::dispatch!(@ simd, |$simd, $four| $op),
        }
    }};
    (@ $token:expr, |$simd:ident, $four:ident| $op:expr) => {
        fearless_simd::Simd::vectorize(
            $token,
            #[inline(always)]
            || {
                let ($simd, $four) = $crate::lanes::side_by_side($token);
                $op
            },
        )
    };
}
pub(crate) use dispatch;

#[inline(always)]
pub(crate) fn one_by_one() -> (Fallback, OneByOne) {
    (Fallback::new(), OneByOne([0.0; 4]))
}

#[inline(always)]
pub(crate) fn side_by_side<S: Simd>(simd: S) -> (S, f64x4<S>) {
    (simd, f64x4::splat(simd, 0.0))
}

/// The instruction sets that `DARKNESS_SIMD` may name.
pub(crate) const NAMES: [&str; 4] = ["scalar", "sse4.2", "avx2", "avx512"];

/// The best instruction set of this machine, or the best of those that the environment variable `DARKNESS_SIMD` does
/// not exclude: `scalar`, `sse4.2`, `avx2` or `avx512`.
pub(crate) fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(|| best(std::env::var("DARKNESS_SIMD").ok().as_deref()))
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
fn best(cap: Option<&str>) -> Level {
    let best = fearless_simd::Level::new();
    let (sse4_2, avx2) = (best.as_sse4_2(), best.as_avx2());
    let levels = [
        best.as_avx512().map(Level::Avx512),
        avx2.map(Level::Avx2),
        sse4_2.map(Level::Sse4_2),
    ];
    let excluded = match cap {
        Some("scalar") => 3,
        Some("sse4.2") => 2,
        Some("avx2") => 1,
        _ => 0,
    };
    let mut levels = levels.into_iter().skip(excluded).flatten();
    levels.next().unwrap_or(Level::Scalar)
}

#[cfg(target_arch = "aarch64")]
fn best(cap: Option<&str>) -> Level {
    match fearless_simd::Level::new() {
        fearless_simd::Level::Neon(neon) if cap != Some("scalar") => Level::Neon(neon),
        _ => Level::Scalar,
    }
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64")))]
fn best(_: Option<&str>) -> Level {
    Level::Scalar
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What a lane means nothing of may ask for anything, and ends no other's.
    #[test]
    fn ranges_the_wrong_way_round_are_no_panic() {
        let list = [3.0, 1.0, 2.0, 5.0];
        let four = OneByOne([0.0; 4]);
        let [least, greatest] = four.range_of(&list, [0, 1, 3, 2], [3, 2, 0, 2]);
        assert_eq!(least.0[..2], [1.0, 1.0]);
        assert_eq!(greatest.0[..2], [5.0, 2.0]);
        assert_eq!((least.0[3], greatest.0[3]), (2.0, 2.0));
    }

    fn operations<T: Real>(x: T, y: T, list: &[f64]) -> [T; 9] {
        let (index, rounded) = x.rounded(8);
        let [first, second, third, fourth] = x.neighbours(list, index);
        [
            x + y,
            x * y - 1.5,
            x / y,
            -x.abs() + y.abs().sqrt(),
            x.if_less(y, x, y),
            x.larger(y) - x.smaller(y),
            rounded,
            first + second,
            third * 2.0 + fourth,
        ]
    }

    fn each_is_its_own<T: Four>(four: T) {
        let list: Vec<f64> = (0..12).map(|i| f64::from(i * i)).collect();
        let (a, b) = ([0.5, -3.0, 7.25, f64::NAN], [2.0, -3.0, -0.125, 1.0]);
        let (x, y) = (four.of(a), four.of(b));
        let all = operations(x, y, &list).map(Into::into);
        for i in 0..4 {
            let each = operations(a[i], b[i], &list);
            for (all, each) in all.iter().zip(each) {
                assert!(
                    all[i] == each || all[i].is_nan() && each.is_nan(),
                    "{} and {each} from {} and {}",
                    all[i],
                    a[i],
                    b[i]
                );
            }
            assert_eq!((x.less(y) >> i) & 1, a[i].less(b[i]));
        }
    }

    /// Each operation on four numbers is that on each of them, whatever the instructions.
    #[test]
    fn four_numbers_are_each_of_them() {
        dispatch!(Level::Scalar, |_simd, four| each_is_its_own(four));
        dispatch!(level(), |_simd, four| each_is_its_own(four));
    }
}

//! Intervals of real numbers, each its middle and its radius.

use crate::lanes::Real;

/// The numbers within `radius` of `middle`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Interval<T = f64> {
    /// Its middle.
    pub(crate) middle: T,
    /// Half its width.
    pub(crate) radius: T,
}

impl<T: Real> Interval<T> {
    #[inline(always)]
    pub(super) fn between([least, greatest]: [T; 2]) -> Self {
        Self {
            middle: (least + greatest) * 0.5,
            radius: (greatest - least) * 0.5,
        }
    }

    /// The largest size of a number in it.
    #[inline(always)]
    pub(crate) fn most(self) -> T {
        self.middle.abs() + self.radius
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            middle: self.middle + other.middle,
            radius: self.radius + other.radius,
        }
    }

    #[inline(always)]
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            middle: self.middle * factor,
            radius: self.radius * factor.abs(),
        }
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let (a, b) = (self.middle.abs(), other.middle.abs());
        Self {
            middle: self.middle * other.middle,
            radius: a * other.radius + self.radius * (b + other.radius),
        }
    }

    /// The numbers' squares.
    #[inline(always)]
    pub(super) fn squared(self) -> Self {
        Self {
            middle: self.middle * self.middle,
            radius: self.radius * (self.middle.abs() * 2.0 + self.radius),
        }
    }
}

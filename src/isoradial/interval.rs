//! Intervals of real numbers, each its middle and its radius.

/// The numbers within `radius` of `middle`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Interval {
    /// Its middle.
    pub middle: f64,
    /// Half its width.
    pub radius: f64,
}

impl Interval {
    #[inline]
    pub(super) fn between((least, greatest): (f64, f64)) -> Self {
        Self {
            middle: 0.5 * (least + greatest),
            radius: 0.5 * (greatest - least),
        }
    }

    /// The largest size of a number in it.
    #[inline]
    pub fn most(self) -> f64 {
        self.middle.abs() + self.radius
    }

    #[inline]
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            middle: self.middle + other.middle,
            radius: self.radius + other.radius,
        }
    }

    #[inline]
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            middle: factor * self.middle,
            radius: factor.abs() * self.radius,
        }
    }

    #[inline]
    pub(super) fn times(self, other: Self) -> Self {
        let (a, b) = (self.middle.abs(), other.middle.abs());
        Self {
            middle: self.middle * other.middle,
            radius: a * other.radius + self.radius * (b + other.radius),
        }
    }

    /// The numbers' squares.
    #[inline]
    pub(super) fn squared(self) -> Self {
        Self {
            middle: self.middle * self.middle,
            radius: self.radius * (2.0 * self.middle.abs() + self.radius),
        }
    }
}

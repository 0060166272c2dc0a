//! The axis x of one quarter turn of the orbit angle.

use core::f64::consts::{FRAC_PI_2, PI};

/// The part of a quarter turn that a curve covers.
#[derive(Debug, Clone, Copy)]
pub(super) struct QuarterTurn {
    /// 0 for the first quarter turn of an order, 1 for the second.
    pub(super) index: usize,
    /// The orbit angle at x = 0.
    pub(super) start: f64,
    /// Whether h has a pole at x = 0. Then `x h` is stored in place of h.
    pub(super) pole: bool,
    /// The least and the greatest x.
    pub(super) x: (f64, f64),
}

impl QuarterTurn {
    /// Creates the quarter turn `index` (0 or 1) of order `number` between two x.
    pub(super) fn new(number: u32, index: usize, x: (f64, f64)) -> Self {
        Self {
            index,
            start: f64::from(number) * PI + if index == 0 { 0.0 } else { FRAC_PI_2 },
            pole: number == 0 && index == 0,
            x,
        }
    }

    /// Returns [`x_at`] of this range.
    pub(super) fn x_at(self, share: f64) -> f64 {
        x_at(self.x, share)
    }

    /// Returns whether h has its pole at this x.
    pub(super) fn has_pole_at(self, x: f64) -> bool {
        self.pole && x == 0.0
    }

    /// Returns the ratio of h to the stored value at x.
    pub(super) fn h_over_stored(self, x: f64) -> f64 {
        if self.pole { 1.0 / x } else { 1.0 }
    }

    /// Converts the stored value at x and its first two derivatives in x to h, dh/dφ and d²h/dφ².
    pub(super) fn h_from_stored(
        self,
        x: f64,
        (y, slope, bend): (f64, f64, f64),
    ) -> (f64, f64, f64) {
        let (h, slope, bend) = if self.pole {
            let h = y / x;
            let h_slope = (slope - h) / x;
            (h, h_slope, (bend - 2.0 * h_slope) / x)
        } else {
            (y, slope, bend)
        };
        let rate = dx_dphi(x);
        (
            h,
            slope * rate,
            (bend * rate + slope * (4.0 * x - 2.0)) * rate,
        )
    }

    /// Converts h and dh/dφ at x to the stored value and its derivative in x.
    pub(super) fn stored_from_h(self, x: f64, h: f64, slope: f64) -> (f64, f64) {
        let slope = slope / dx_dphi(x);
        if self.pole {
            (h * x, h + slope * x)
        } else {
            (h, slope)
        }
    }
}

/// Returns `dx/dφ = x² + (1 − x)²`, from `tan(φ − start) = x/(1 − x)`.
fn dx_dphi(x: f64) -> f64 {
    x * x + (1.0 - x) * (1.0 - x)
}

/// Returns the x at a share of the way between two x. Both ends are exact.
pub(super) fn x_at(x: (f64, f64), share: f64) -> f64 {
    if share >= 1.0 {
        x.1
    } else {
        x.0 + (x.1 - x.0) * share
    }
}

/// Returns the x at which a ray crosses the disk's plane, from `tan φ₁ = n/d`, n ≥ 0. The quarter turn is the second
/// where d is negative.
#[inline]
pub(super) fn x_of_crossing(n: f64, d: f64) -> f64 {
    if d < 0.0 {
        -d / (n - d)
    } else if n > 0.0 {
        n / (n + d)
    } else {
        0.0
    }
}

//! What a whole bundle of rays meets: the curves' bounds against the bundle's.

use super::{Isoradials, Piece};
use crate::table::spline::bounds;

/// What is known of a bundle of rays: an interval for `z/s`, and one for `D/N`, the cotangent of φ₁ (see [the module
/// above](super)).
#[derive(Debug, Clone, Copy)]
pub struct Bundle {
    /// Least and greatest `z/s`.
    pub kappa: (f64, f64),
    /// Least and greatest `D/N`; ±∞ where N = 0.
    pub cotangent: (f64, f64),
}

/// What the rays of a bundle meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Every one of them the disk.
    Hit,
    /// None of them the disk.
    Miss,
    /// Some may, some may not.
    Mixed,
}

/// Share of its size by which each bound is widened: the rounding of a pixel's own `z/s` and x is a few ε.
const ROUNDING: f64 = 1e-13;

impl Isoradials {
    /// What the rays of `bundle` meet. [`Verdict::Hit`] and [`Verdict::Miss`] are certain: [`Self::meets`] says the
    /// same of each of its rays.
    pub fn verdict(&self, bundle: &Bundle) -> Verdict {
        let (low, high) = bundle.kappa;
        let rounding = ROUNDING * (low.abs() + high.abs() + self.critical.abs());
        let h = (
            low - self.critical - rounding,
            high - self.critical + rounding,
        );
        let (least, greatest) = bundle.cotangent;
        // x falls with the cotangent in the first quarter turn and rises with its size in the second.
        let first =
            (greatest >= 0.0).then(|| (1.0 / (1.0 + greatest), 1.0 / (1.0 + least.max(0.0))));
        let beyond = |cotangent: f64| {
            if cotangent.is_infinite() {
                1.0
            } else {
                cotangent / (1.0 + cotangent)
            }
        };
        let second = (least < 0.0).then(|| (beyond(-greatest.min(0.0)), beyond(-least)));
        match (first, second) {
            (Some(x), None) => self.quarter_verdict(0, h, x),
            (None, Some(x)) => self.quarter_verdict(1, h, x),
            (Some(x0), Some(x1)) => {
                let verdict = self.quarter_verdict(0, h, x0);
                if verdict == self.quarter_verdict(1, h, x1) {
                    verdict
                } else {
                    Verdict::Mixed
                }
            }
            (None, None) => Verdict::Mixed,
        }
    }

    fn quarter_verdict(&self, quarter: usize, h: (f64, f64), x: (f64, f64)) -> Verdict {
        let x = ((x.0 - ROUNDING).max(0.0), (x.1 + ROUNDING).min(1.0));
        let mut verdict = Verdict::Miss;
        for (k, order) in self.orders.iter().enumerate() {
            let piece = &order.pieces[quarter];
            if h.1 < piece.lowest || h.0 > piece.highest {
                continue;
            }
            match piece.verdict(h, x, k == 0 && quarter == 0) {
                Verdict::Hit => return Verdict::Hit,
                Verdict::Mixed => verdict = Verdict::Mixed,
                Verdict::Miss => {}
            }
        }
        verdict
    }
}

impl Piece {
    fn verdict(&self, h: (f64, f64), x: (f64, f64), pole: bool) -> Verdict {
        let span = |coefficients: &[f64]| {
            let values = bounds(coefficients, self.axis, x);
            if pole { over(values, x) } else { values }
        };
        let (inner, outer) = (span(&self.inner), span(&self.outer));
        if h.0 >= outer.1 && h.1 <= inner.0 {
            Verdict::Hit
        } else if h.1 < outer.0 || h.0 > inner.1 {
            Verdict::Miss
        } else {
            Verdict::Mixed
        }
    }
}

/// The quotients of an interval by one of numbers ≥ 0.
fn over(values: (f64, f64), x: (f64, f64)) -> (f64, f64) {
    let low = if values.0 >= 0.0 {
        values.0 / x.1
    } else {
        values.0 / x.0
    };
    let high = if values.1 >= 0.0 {
        values.1 / x.0
    } else {
        values.1 / x.1
    };
    // 0/0, where nothing is known.
    (
        if low.is_nan() { f64::NEG_INFINITY } else { low },
        if high.is_nan() { f64::INFINITY } else { high },
    )
}

//! What a whole bundle of rays meets: the curves' bounds against the bundle's.

use super::piece::Piece;
use super::{Edge, Isoradials};
use crate::scene::{Affine, View};

/// What is known of a bundle of rays: an interval for `z/s`, and one for `D/N`, the cotangent of φ₁ (see [the module
/// above](super)).
#[derive(Debug, Clone, Copy, PartialEq)]
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

impl Bundle {
    /// Every ray there is.
    pub const ALL: Self = Self {
        kappa: (f64::NEG_INFINITY, f64::INFINITY),
        cotangent: (f64::NEG_INFINITY, f64::INFINITY),
    };

    /// Bounds of the rays of a rectangle of the picture, its sides in pixels from the left and from the top: from the
    /// ray at its centre and the circle about it that the rectangle lies in. None where it may hold the ray straight
    /// at the hole or straight away from it.
    pub fn new(view: &View, columns: (f64, f64), rows: (f64, f64)) -> Option<Self> {
        let (z, ta, tb) = (view.z(), view.ta(), view.tb());
        let (left, right) = (view.x_at(columns.0), view.x_at(columns.1));
        let (top, bottom) = (view.y_at(rows.0), view.y_at(rows.1));
        let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let (half_x, half_y) = (0.5 * (right - left), 0.5 * (top - bottom));
        let reach = |affine: Affine| (affine.per_x * half_x).abs() + (affine.per_y * half_y).abs();
        let (z_centre, ta_centre, tb_centre) = (z.at(x, y), ta.at(x, y), tb.at(x, y));
        let s = (ta_centre * ta_centre + tb_centre * tb_centre).sqrt();
        let (reach_a, reach_b) = (reach(ta), reach(tb));
        let radius = (reach_a * reach_a + reach_b * reach_b).sqrt();
        let (s_least, s_most) = (s - radius, s + radius);
        if s_least <= 0.0 {
            return None;
        }
        let (z_least, z_most) = (z_centre - reach(z), z_centre + reach(z));
        let kappa = (
            z_least / if z_least < 0.0 { s_least } else { s_most },
            z_most / if z_most < 0.0 { s_most } else { s_least },
        );
        // The gradient of t_a/s is |t_b|/s² ≤ 1/s.
        let (cosine, spread) = (ta_centre / s, radius / s_least);
        let (least, most) = ((cosine - spread).max(-1.0), (cosine + spread).min(1.0));
        // D = n_a t_a: with n or its opposite for the disk's normal the plane is the same; of the two the one away
        // from the camera has N ≥ 0.
        let (n, n_a) = (view.n_p().abs(), view.plane_slope());
        let over_n = |d: f64| {
            if n > 0.0 {
                d / n
            } else {
                f64::INFINITY.copysign(d)
            }
        };
        let ends = (over_n(n_a * least), over_n(n_a * most));
        let cotangent = if n_a < 0.0 { (ends.1, ends.0) } else { ends };
        Some(Self { kappa, cotangent })
    }

    /// The interval of x on each quarter turn's axis that the bundle reaches, if it does.
    pub(super) fn quarters(&self) -> [Option<(f64, f64)>; 2] {
        let (least, greatest) = self.cotangent;
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
        let widened = |x: (f64, f64)| ((x.0 - ROUNDING).max(0.0), (x.1 + ROUNDING).min(1.0));
        [first.map(widened), second.map(widened)]
    }
}

impl Isoradials {
    /// What the rays of `bundle` meet, which are rays of the picture that the curves were drawn for.
    /// [`Verdict::Hit`] and [`Verdict::Miss`] are certain: [`Self::meets`] says the same of each of its rays.
    pub fn verdict(&self, bundle: &Bundle) -> Verdict {
        let (low, high) = bundle.kappa;
        let rounding = ROUNDING * (low.abs() + high.abs() + self.critical().abs());
        let h = (
            low - self.critical() - rounding,
            high - self.critical() + rounding,
        );
        match bundle.quarters() {
            [Some(x), None] => self.quarter_verdict(0, h, x),
            [None, Some(x)] => self.quarter_verdict(1, h, x),
            [Some(x0), Some(x1)] => {
                let verdict = self.quarter_verdict(0, h, x0);
                if verdict == self.quarter_verdict(1, h, x1) {
                    verdict
                } else {
                    Verdict::Mixed
                }
            }
            [None, None] => Verdict::Mixed,
        }
    }

    fn quarter_verdict(&self, quarter: usize, h: (f64, f64), x: (f64, f64)) -> Verdict {
        let mut verdict = Verdict::Miss;
        for piece in self.quarter(quarter) {
            if h.1 < piece.lowest || h.0 > piece.highest {
                continue;
            }
            match piece.verdict(h, x) {
                Verdict::Hit => return Verdict::Hit,
                Verdict::Mixed => verdict = Verdict::Mixed,
                Verdict::Miss => {}
            }
        }
        verdict
    }
}

impl Piece {
    fn verdict(&self, h: (f64, f64), x: (f64, f64)) -> Verdict {
        let (inner, outer) = (self.bounds(Edge::Inner, x), self.bounds(Edge::Outer, x));
        if h.0 >= outer.1 && h.1 <= inner.0 {
            Verdict::Hit
        } else if h.1 < outer.0 || h.0 > inner.1 {
            Verdict::Miss
        } else {
            Verdict::Mixed
        }
    }
}

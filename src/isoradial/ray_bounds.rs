//! Bounds of the rays in a picture.

use super::ray_angles::{angle_of, cotangent_of};
use crate::scene::{Direction, Projection, View};

/// Bounds of a set of rays: an interval of κ, and an interval of `D/N`, the cotangent of φ₁ (see the
/// [module's page](super)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayBounds {
    /// The least and the greatest `κ = z/s`.
    pub kappa: (f64, f64),
    /// The least and the greatest `D/N`; ±∞ where N = 0.
    pub cotangent: (f64, f64),
}

/// The amount by which bounds of x are widened: a pixel's own κ and x are rounded by a few ε.
const ROUNDING: f64 = 1e-13;

/// The share of its size by which each bound of a picture is widened. These bounds take more operations.
const PICTURE_ROUNDING: f64 = 1e-12;

impl RayBounds {
    /// The bounds of all rays.
    pub(super) const ALL: Self = Self {
        kappa: (f64::NEG_INFINITY, f64::INFINITY),
        cotangent: (f64::NEG_INFINITY, f64::INFINITY),
    };

    /// Bounds the rays of a picture. `axis` is the angle between its centre and the hole's direction, `corner` the
    /// angle between its centre and its corners.
    ///
    /// The picture's rectangle and the circle through its corners both bound the rays. The narrower bound is taken.
    pub(super) fn of_picture(view: &View, axis: f64, corner: f64) -> Self {
        let rectangle = Self::of_rectangle(view).unwrap_or_else(|| {
            let most = view.n_a() / view.n_p().abs();
            let cotangent = if most.is_nan() {
                (0.0, 0.0)
            } else {
                (-most, most)
            };
            Self {
                cotangent,
                ..Self::ALL
            }
        });
        let (widest, narrowest) = (axis + corner, axis - corner);
        let low = cotangent_of(widest * (1.0 + PICTURE_ROUNDING));
        let high = cotangent_of(narrowest - PICTURE_ROUNDING * axis);
        let (least, greatest) = rectangle.cotangent;
        Self {
            kappa: (
                lowered(rectangle.kappa.0.max(low), PICTURE_ROUNDING),
                lowered(rectangle.kappa.1.min(high), -PICTURE_ROUNDING),
            ),
            cotangent: (
                lowered(least, PICTURE_ROUNDING),
                lowered(greatest, -PICTURE_ROUNDING),
            ),
        }
    }

    /// Bounds the rays of a picture's rectangle. All their transverse parts lie in a circle about that of the central
    /// ray. Returns `None` if that circle contains zero (the ray straight at the hole, or straight away from it), and
    /// for pictures that are not flat.
    fn of_rectangle(view: &View) -> Option<Self> {
        // The rays of other pictures than flat ones bound no rectangle.
        if view.lens().projection() != Projection::Perspective {
            return None;
        }
        let [z, ta, tb] = view.parts();
        let (half_x, half_y) = (view.x_at(f64::from(view.width())), view.y_at(0.0));
        let reach = |[_, right, up]: Direction| (right * half_x).abs() + (up * half_y).abs();
        let s = (ta[0] * ta[0] + tb[0] * tb[0]).sqrt();
        let (reach_a, reach_b) = (reach(ta), reach(tb));
        let radius = (reach_a * reach_a + reach_b * reach_b).sqrt();
        let (s_least, s_most) = (s - radius, s + radius);
        if s_least <= 0.0 {
            return None;
        }
        let (z_least, z_most) = (z[0] - reach(z), z[0] + reach(z));
        let kappa = (
            z_least / if z_least < 0.0 { s_least } else { s_most },
            z_most / if z_most < 0.0 { s_most } else { s_least },
        );
        // The gradient of t_a/s is |t_b|/s² ≤ 1/s.
        let (cosine, spread) = (ta[0] / s, radius / s_least);
        let (least, most) = ((cosine - spread).max(-1.0), (cosine + spread).min(1.0));
        let (n, d) = (view.n_p().abs(), view.plane_slope());
        let over_n = |d: f64| {
            if n > 0.0 {
                d / n
            } else {
                f64::INFINITY.copysign(d)
            }
        };
        let ends = (over_n(d * least), over_n(d * most));
        let cotangent = if d < 0.0 { (ends.1, ends.0) } else { ends };
        Some(Self { kappa, cotangent })
    }

    /// Returns the narrowest bounds that contain both sets of rays.
    pub(super) fn union(&self, other: &Self) -> Self {
        let hull = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        Self {
            kappa: hull(self.kappa, other.kappa),
            cotangent: hull(self.cotangent, other.cotangent),
        }
    }

    /// Widens the bounds of κ by an angle, and those of the cotangent to three times their width.
    pub(super) fn widened(&self, angle: f64) -> Self {
        let wider = |bound: f64, angle: f64| cotangent_of(angle_of(bound) + angle);
        let (low, high) = self.kappa;
        let (least, greatest) = self.cotangent;
        // Not a number where both are the same infinity, which no bound is beyond.
        let width = (greatest - least).max(0.0);
        Self {
            kappa: (low.min(wider(low, angle)), high.max(wider(high, -angle))),
            cotangent: (least - width, greatest + width),
        }
    }

    /// Returns the interval of x that the rays reach in each of the two quarter turns, or `None` where they reach none.
    pub(super) fn quarters(&self) -> [Option<(f64, f64)>; 2] {
        let (least, greatest) = self.cotangent;
        // x falls with the cotangent in the first quarter turn, and rises with its size in the second.
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

/// Lowers a bound by a share of its size, or raises it if the share is negative.
fn lowered(bound: f64, share: f64) -> f64 {
    if bound.is_finite() {
        bound - share * (1.0 + bound.abs())
    } else {
        bound
    }
}

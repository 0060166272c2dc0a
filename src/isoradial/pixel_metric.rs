//! Distances in the picture without trigonometry.

use super::curve_spec::CurveSpec;
use super::ray_angles::angle_between;
use crate::scene::Projection;

/// Measures distances between rays of one plane in pixels: the bounds of [`CurveSpec::pixels`], computed faster.
#[derive(Debug, Clone, Copy)]
pub(super) struct PixelMetric {
    /// κ of the critical ray.
    pub(super) critical: f64,
    /// The least and the greatest h in the picture.
    h_range: (f64, f64),
    /// The cosine and the sine of [`CurveSpec::axis`].
    axis: (f64, f64),
    /// The cosine of [`CurveSpec::corner`].
    corner: f64,
    pixel: f64,
    projection: Projection,
    max_per_radian: f64,
}

impl PixelMetric {
    pub(super) fn new(spec: &CurveSpec) -> Self {
        let corner = libm::cos(spec.corner);
        Self {
            critical: spec.critical(),
            h_range: spec.h_range(),
            axis: (libm::cos(spec.axis), libm::sin(spec.axis)),
            corner,
            pixel: spec.pixel,
            projection: spec.projection,
            max_per_radian: spec.projection.stretch(corner) / spec.pixel,
        }
    }

    /// Returns the most pixels in a radian anywhere in the picture.
    pub(super) fn max_per_radian(&self) -> f64 {
        self.max_per_radian
    }

    /// Returns [`CurveSpec::pixels_per_radian`] at the angle whose cotangent is `kappa`.
    pub(super) fn per_radian(&self, kappa: f64) -> f64 {
        let length = (1.0 + kappa * kappa).sqrt();
        let (along, across) = if length.is_finite() {
            (kappa / length, 1.0 / length)
        } else {
            (1.0_f64.copysign(kappa), 0.0)
        };
        let (cosine, sine) = self.axis;
        // Where ψ + a > π its cosine rises again, but the corner is the lesser angle there.
        let cosine = if across * cosine + along * sine >= 0.0 {
            (along * cosine - across * sine).max(self.corner)
        } else {
            self.corner
        };
        self.projection.stretch(cosine) / self.pixel
    }

    /// Returns whether any ray of an interval of h is in the picture.
    pub(super) fn shows(&self, h: (f64, f64)) -> bool {
        h.0.min(h.1) <= self.h_range.1 && h.0.max(h.1) >= self.h_range.0
    }

    /// Returns the greater of `known` and the distance of two rays in pixels.
    #[inline]
    pub(super) fn max_distance(&self, known: f64, (low, high): (f64, f64)) -> f64 {
        if self.is_surely_within(known, low, high) {
            return known;
        }
        known.max(self.per_radian(self.critical + low) * angle_between(low, high, self.critical))
    }

    /// Returns the greater of `known` and the distance of two rays in pixels, or `known` if their cell is not in the
    /// picture. The cell is taken to extend beyond its `ends` and beyond the two rays by their distance.
    #[inline]
    pub(super) fn max_visible_distance(&self, known: f64, a: f64, b: f64, ends: (f64, f64)) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        if self.is_surely_within(known, low, high) {
            return known;
        }
        let apart = high - low;
        let cell = (
            ends.0.min(ends.1).min(low) - apart,
            ends.0.max(ends.1).max(high) + apart,
        );
        if !self.shows(cell) {
            return known;
        }
        // Pixels are smallest at the visible ray that is farthest from the hole's direction.
        let farthest = self.critical + cell.0.max(self.h_range.0);
        known.max(self.per_radian(farthest) * angle_between(low, high, self.critical))
    }

    /// Returns whether two rays with `low ≤ high` are at most `distance` pixels apart even where pixels are smallest.
    /// An angle is at most its tangent, `(high − low)/(1 + κ₁ κ₂)`.
    #[inline]
    fn is_surely_within(&self, distance: f64, low: f64, high: f64) -> bool {
        let over = 1.0 + (self.critical + low) * (self.critical + high);
        over > 0.0 && (high - low) * self.max_per_radian <= distance * over
    }
}

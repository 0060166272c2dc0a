//! What curves are drawn for: one camera radius, one disk, and how much of the sky a picture shows, how large.
//!
//! # Pixels
//! In a flat picture of pixels with the height p in the plane at distance 1, a radian at the angle θ from the centre is
//! at most `1/(p cos²θ)` pixels, whichever way it points. A ray at the angle ψ from the hole's direction is at `θ ≤
//! min(ψ + a, c)`, a being the angle between the picture's centre and the hole, c that between the centre and the
//! corners: so a radian there is at most [`Sight::pixels_per_radian`]`(ψ) = 1/(p cos² min(ψ + a, c))` pixels.

use super::ray_bounds::RayBounds;
use crate::orbit::invariants::{critical_slope, three_u_minus_two};
use crate::scene::{Scene, View};

/// What the curves are drawn for: one camera radius, one disk, one picture or several of the same radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// The camera's inverse radius.
    pub u0: f64,
    /// `u0 √(1 − u0)`: du/dφ over κ.
    pub slope_scale: f64,
    /// Inverse radius of the disk's inner edge.
    pub u_inner: f64,
    /// Inverse radius of the disk's outer edge.
    pub u_outer: f64,
    /// A pixel's height in the plane at distance 1.
    pub pixel: f64,
    /// The angle between the picture's centre and the hole's direction, in radians.
    pub axis: f64,
    /// The angle between the picture's centre and its corners, in radians.
    pub corner: f64,
    /// The rays that the picture shows.
    pub window: RayBounds,
    /// What an edge may be off by, in pixels.
    pub tolerance: f64,
}

impl Sight {
    /// What the picture of `scene` asks for, its edges right to `tolerance` pixels.
    pub fn new(scene: &Scene, view: &View, tolerance: f64) -> Self {
        let centre = view.ray_at(0.0, 0.0);
        let (x, y) = (view.x_at(0.0), view.y_at(0.0));
        let axis = libm::atan2(centre.transverse(), centre.z);
        let corner = libm::atan((x * x + y * y).sqrt());
        Self {
            tolerance,
            pixel: (view.y_at(0.0) - view.y_at(1.0)).abs(),
            axis,
            corner,
            window: RayBounds::of_picture(view, axis, corner),
            ..Self::all_round(
                view.u0(),
                view.slope_scale(),
                (scene.disk().inner, scene.disk().outer),
            )
        }
    }

    /// All rays of a camera at inverse radius `u0` (`slope_scale` is `u0 √(1 − u0)`), to be drawn for pixels of one
    /// radian: for [`Sight::pixel`] and [`Sight::tolerance`] to be set.
    pub fn all_round(u0: f64, slope_scale: f64, (inner, outer): (f64, f64)) -> Self {
        Self {
            u0,
            slope_scale,
            u_inner: 1.0 / inner,
            u_outer: 1.0 / outer,
            pixel: 1.0,
            axis: 0.0,
            corner: 0.0,
            window: RayBounds::ALL,
            tolerance: 1.0,
        }
    }

    /// What curves are drawn for that serve two pictures; none if these are not of one camera radius and one disk.
    pub fn and(&self, other: &Self) -> Option<Self> {
        let of = |sight: &Self| (sight.u0, sight.slope_scale, sight.u_inner, sight.u_outer);
        (of(self) == of(other)).then(|| Self {
            pixel: self.pixel.min(other.pixel),
            axis: self.axis.max(other.axis),
            corner: self.corner.max(other.corner),
            window: self.window.union(&other.window),
            tolerance: self.tolerance.min(other.tolerance),
            ..*self
        })
    }

    /// κ of the critical ray: towards the hole from outside the photon sphere, away from it from inside.
    pub fn critical(&self) -> f64 {
        let size = critical_slope(self.u0) / self.slope_scale;
        if three_u_minus_two(self.u0) < 0.0 {
            size
        } else {
            -size
        }
    }

    /// `1/(p cos² min(psi + a, c))`: the most pixels that a radian is, for rays at the angle `psi` from the hole's
    /// direction or closer to it. p is [`Self::pixel`], a [`Self::axis`], c [`Self::corner`].
    pub fn pixels_per_radian(&self, psi: f64) -> f64 {
        let cosine = libm::cos((psi + self.axis).min(self.corner));
        1.0 / (self.pixel * cosine * cosine)
    }

    /// How far apart two rays of one plane are in the picture, at most: in pixels, from their distances `κ − κ_c`
    /// from the critical ray.
    pub fn pixels(&self, h: (f64, f64)) -> f64 {
        let critical = self.critical();
        let (low, high) = (h.0.min(h.1), h.0.max(h.1));
        self.pixels_per_radian(angle(critical + low)) * between(low, high, critical)
    }

    /// Least and greatest `h = κ − κ_c` that the picture shows.
    pub(super) fn heights(&self) -> (f64, f64) {
        let (low, high) = self.window.kappa;
        (low - self.critical(), high - self.critical())
    }
}

/// What the picture shows of curves: a [`Sight`]'s distances without trigonometry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown {
    pub(super) critical: f64,
    /// Least and greatest h.
    heights: (f64, f64),
    /// Cosine and sine of [`Sight::axis`].
    axis: (f64, f64),
    /// Cosine of [`Sight::corner`].
    corner: f64,
    pixel: f64,
    most_per_radian: f64,
}

impl Shown {
    pub(super) fn new(sight: &Sight) -> Self {
        let corner = libm::cos(sight.corner);
        Self {
            critical: sight.critical(),
            heights: sight.heights(),
            axis: (libm::cos(sight.axis), libm::sin(sight.axis)),
            corner,
            pixel: sight.pixel,
            most_per_radian: 1.0 / (sight.pixel * corner * corner),
        }
    }

    /// The most pixels that a radian is anywhere.
    pub(super) fn most_per_radian(&self) -> f64 {
        self.most_per_radian
    }

    /// [`Sight::pixels_per_radian`] at the angle of which `kappa` is the cotangent.
    pub(super) fn per_radian(&self, kappa: f64) -> f64 {
        let length = (1.0 + kappa * kappa).sqrt();
        let (along, across) = if length.is_finite() {
            (kappa / length, 1.0 / length)
        } else {
            (1.0_f64.copysign(kappa), 0.0)
        };
        let (cosine, sine) = self.axis;
        // Beyond π the cosine rises again, and the corner is what is nearer.
        let cosine = if across * cosine + along * sine >= 0.0 {
            (along * cosine - across * sine).max(self.corner)
        } else {
            self.corner
        };
        1.0 / (self.pixel * cosine * cosine)
    }

    /// Whether the picture shows any ray of an interval of h.
    pub(super) fn reaches(&self, h: (f64, f64)) -> bool {
        h.0.min(h.1) <= self.heights.1 && h.0.max(h.1) >= self.heights.0
    }

    /// The distance of two rays in pixels, at most: [`Sight::pixels`], if more than `most`.
    #[inline]
    pub(super) fn apart(&self, most: f64, (low, high): (f64, f64)) -> f64 {
        let (first, second) = (self.critical + low, self.critical + high);
        // The tangent of the angle between them is (high − low) over this.
        let over = 1.0 + first * second;
        if over > 0.0 && (high - low) * self.most_per_radian <= most * over {
            return most;
        }
        most.max(self.per_radian(first) * between(low, high, self.critical))
    }

    /// The distance of two rays in pixels, if more than `most`; not where the cell they lie in, from one of its ends to
    /// the other and as far beyond as the two are apart, is not in the picture.
    #[inline]
    pub(super) fn farthest(&self, most: f64, a: f64, b: f64, ends: (f64, f64)) -> f64 {
        let (low, high) = (a.min(b), a.max(b));
        let over = 1.0 + (self.critical + low) * (self.critical + high);
        if over > 0.0 && (high - low) * self.most_per_radian <= most * over {
            return most;
        }
        let apart = high - low;
        let reach = (
            ends.0.min(ends.1).min(low) - apart,
            ends.0.max(ends.1).max(high) + apart,
        );
        if !self.reaches(reach) {
            return most;
        }
        // The farthest from the hole's direction that the picture shows of it, where pixels are smallest.
        let farthest = self.critical + reach.0.max(self.heights.0);
        most.max(self.per_radian(farthest) * between(low, high, self.critical))
    }
}

/// The angle between a ray of cotangent κ and the hole's direction, in [0, π].
pub(super) fn angle(kappa: f64) -> f64 {
    libm::atan2(1.0, kappa)
}

/// The angle between two rays with `low ≤ high` for their `κ − κ_c`, in radians: without subtracting two angles.
pub(super) fn between(low: f64, high: f64, critical: f64) -> f64 {
    let (first, second) = (critical + low, critical + high);
    if first.is_infinite() || second.is_infinite() {
        return angle(first) - angle(second);
    }
    let over = 1.0 + first * second;
    let tangent = (high - low) / over;
    // The tangent of a small angle is larger by a third of its cube.
    if (0.0..1e-5).contains(&tangent) {
        tangent
    } else {
        libm::atan2(high - low, over)
    }
}

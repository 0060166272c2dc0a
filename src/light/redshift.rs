//! Redshift, emission angle and azimuth of the light that a pixel sees.
//!
//! # Derivation
//! The disk's matter moves on circular orbits, counterclockwise about the disk's normal n, with angular velocity
//! `Ω = √(u³/2)` and `dt/dτ = 1/√(1 − 3u/2)` (Bardeen, Press & Teukolsky 1972, eq. 2.16, without spin). A light ray has
//! the energy E and the angular momentum λE about n. Matter measures the energy `E (1 − Ωλ) dt/dτ`, the camera at rest
//! `E/√(1 − u0)`; g is their ratio.
//!
//! The camera sees the light in the direction d, so that the light moves along −d there. With d and n in the
//! coordinates of [`View`], `p̂ × d = t_a b̂ − t_b â` up to the part along p̂, and
//!
//! * `b = r0 s/(|d| √(1 − u0))`, the impact parameter;
//! * `λ = −r0 n·(p̂ × d)/(|d| √(1 − u0)) = r0 n_a t_b/(|d| √(1 − u0))`;
//! * `b² − λ² = r0² (t_a² + (n·p̂)² t_b²)/(|d|² (1 − u0))`, a sum, since `n_a² + (n·p̂)² = 1`. Its root is the light's
//!   angular momentum across n.
//!
//! In the disk's plane, â's trace c (the direction of the camera's foot) and −b̂ are a right-handed basis about n.
//! There the crossing's direction `p̂ cos φ + t̂ sin φ`, φ = φ₁ + kπ, has the components `∓(t_a, (n·p̂) t_b)` over the
//! same root: no angle is needed. The upper sign is for the side of the disk to which n points, and both change from
//! one order to the next.

use super::sight::Sight;
use crate::scene::{PixelRay, View};
use glam::DVec3;

/// n is parallel to the x axis where `|n × x̂|` is below this. The azimuth then begins at the projection of +y.
const ALONG_X: f64 = 1e-6;

/// Returns the ratio of observed to emitted frequency, `g = √(1 − 3u/2)/(√(1 − u0) (1 − Ωλ))`, `Ω = √(u³/2)`.
///
/// The light comes from matter on a circular orbit at inverse radius `u ≤ 1/3` and has the angular momentum `lambda`
/// (in Schwarzschild radii, per unit of energy) about the orbit's axis, positive where both go around in the same
/// sense.
/// `clock_rate` is √(1 − u0) of the observer at rest, 1 far away.
#[inline]
pub fn redshift(u: f64, clock_rate: f64, lambda: f64) -> f64 {
    matter_redshift(u, lambda) / clock_rate
}

/// Returns the cosine of the angle between the light and the disk's normal for the matter that emits it:
/// `√(b² − λ²) u √(1 − 3u/2)/(1 − Ωλ)`. `across` is `√(b² − λ²)`; `u` and `lambda` are those of [`redshift`].
///
/// It is the ratio of the momentum across the plane, `E u √(b² − λ²)`, to the energy that the matter measures.
#[inline]
pub fn emission_cosine(u: f64, across: f64, lambda: f64) -> f64 {
    across * u * matter_redshift(u, lambda)
}

/// The redshift at infinity. On circular orbits `Ωλ` is at most ½ (u = 1/3), so that nothing cancels.
#[inline]
fn matter_redshift(u: f64, lambda: f64) -> f64 {
    let angular_velocity = (0.5 * u * u * u).sqrt();
    (1.0 - 1.5 * u).sqrt() / (1.0 - angular_velocity * lambda)
}

/// The angular momentum of a pixel's light, in Schwarzschild radii, per unit of energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularMomentum {
    /// λ, its part along the disk's normal: positive where the light goes counterclockwise.
    pub along: f64,
    /// `√(b² − λ²)`, its part across the normal.
    pub across: f64,
}

/// Computes what pixels of one view see of the disk, from the place where their rays meet it.
#[derive(Debug, Clone, Copy)]
pub struct SightGeometry {
    /// `u0 √(1 − u0)`
    slope_scale: f64,
    clock_rate: f64,
    n_p: f64,
    n_a: f64,
    /// c in the axes of azimuth 0 and π/2: −b̂, a quarter turn ahead of it, is `(−foot.1, foot.0)`.
    foot: (f64, f64),
}

impl SightGeometry {
    /// Prepares a view.
    pub fn new(view: &View) -> Self {
        let (n, b) = (view.normal(), view.level());
        // n × x̂ is along the axis of azimuth π/2, and (n × x̂) × n along that of azimuth 0.
        let from_x = n.cross(DVec3::X);
        let quarter = if from_x.length() < ALONG_X {
            n.cross(DVec3::Y)
        } else {
            from_x
        };
        let quarter = quarter.normalize();
        let zero = quarter.cross(n).normalize();
        Self {
            slope_scale: view.slope_scale(),
            clock_rate: view.clock_rate(),
            n_p: view.n_p(),
            n_a: view.n_a(),
            foot: (-b.dot(quarter), b.dot(zero)),
        }
    }

    /// Returns the angular momentum of the light that comes along a pixel's ray.
    #[inline]
    pub fn angular_momentum(&self, pixel: PixelRay) -> AngularMomentum {
        let PixelRay { z, ta, tb } = pixel;
        let length = (z * z + (ta * ta + tb * tb)).sqrt();
        // r0/√(1 − u0) = 1/(u0 √(1 − u0)).
        let scale = 1.0 / (length * self.slope_scale);
        AngularMomentum {
            along: self.n_a * tb * scale,
            across: self.root(ta, tb) * scale,
        }
    }

    /// Returns the azimuth at which a pixel's ray meets the disk's plane, from 0 to below 2π; see [`Sight::azimuth`].
    #[inline]
    pub fn azimuth(&self, pixel: PixelRay, order: u32) -> f64 {
        let (along_foot, beside) = if self.n_p > 0.0 {
            (-pixel.ta, -self.n_p * pixel.tb)
        } else if self.n_p < 0.0 {
            (pixel.ta, self.n_p * pixel.tb)
        } else {
            // Order 0 is at φ = π, opposite the camera.
            (-1.0, 0.0)
        };
        let (x, y) = (
            along_foot * self.foot.0 - beside * self.foot.1,
            along_foot * self.foot.1 + beside * self.foot.0,
        );
        let angle = if order.is_multiple_of(2) {
            libm::atan2(y, x)
        } else {
            libm::atan2(-y, -x)
        };
        if angle >= 0.0 {
            return angle;
        }
        let turned = angle + core::f64::consts::TAU;
        if turned < core::f64::consts::TAU {
            turned
        } else {
            0.0
        }
    }

    /// Returns what a pixel sees that meets the disk at inverse radius `u` as part of the image of this order.
    #[inline]
    pub fn sight(&self, pixel: PixelRay, order: u32, u: f64) -> Sight {
        let AngularMomentum { along, across } = self.angular_momentum(pixel);
        Sight {
            order,
            u,
            azimuth: self.azimuth(pixel, order),
            redshift: redshift(u, self.clock_rate, along),
            emission_cosine: emission_cosine(u, across, along),
        }
    }

    /// `√(t_a² + (n·p̂)² t_b²)`.
    #[inline]
    fn root(&self, ta: f64, tb: f64) -> f64 {
        let beside = self.n_p * tb;
        (ta * ta + beside * beside).sqrt()
    }
}

//! Angles between rays, from the cotangents κ of their angles to the hole's direction.

use core::f64::consts::PI;

/// Returns κ at an angle from the hole's direction; ±∞ at and beyond the ends of [0, π].
pub(super) fn cotangent_of(psi: f64) -> f64 {
    if psi <= 0.0 {
        f64::INFINITY
    } else if psi >= PI {
        f64::NEG_INFINITY
    } else {
        libm::cos(psi) / libm::sin(psi)
    }
}

/// Returns the angle between a ray and the hole's direction, in [0, π].
pub(super) fn angle_of(kappa: f64) -> f64 {
    libm::atan2(1.0, kappa)
}

/// Returns the angle between the two rays with `κ = critical + low` and `κ = critical + high`, `low ≤ high`, in
/// radians.
///
/// The tangent of this angle is `(high − low)/(1 + κ₁ κ₂)`. Subtracting two angles would lose the digits of a small
/// one.
pub(super) fn angle_between(low: f64, high: f64, critical: f64) -> f64 {
    let (first, second) = (critical + low, critical + high);
    if first.is_infinite() || second.is_infinite() {
        return angle_of(first) - angle_of(second);
    }
    let over = 1.0 + first * second;
    let tangent = (high - low) / over;
    // The tangent of a small angle exceeds it by a third of its cube.
    if (0.0..1e-5).contains(&tangent) {
        tangent
    } else {
        libm::atan2(high - low, over)
    }
}

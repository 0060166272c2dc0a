//! Taylor steps of the orbit equation, along an orbit whose constants of motion are known.
//!
//! The coefficients of `u(φ + h) = Σ c_k h^k` follow from `d²u/dφ² = 3/2 u² − u`:
//! `(k + 1)(k + 2) c_{k+2} = 3/2 Σ c_i c_{k−i} − c_k`. With `x = u − 2/3` the equation is `d²x/dφ² = 3/2 x² + x`, which
//! keeps the digits of x about the photon sphere.
//!
//! The photon sphere is a saddle of the phase plane: an error across the orbits grows as e^φ there. Since Δ is known,
//! `w² = x² (1 + x) + Δ` removes it after each step. What is left is an error along the orbit, which does not grow.

use super::elliptic::turning_point;
use super::invariants::{Orbit, three_u_minus_two};
use super::ray::within_flight;

/// The longest step, in radians. `u = 1/3 + 4℘` has its poles 2 or more away from the points between infinity and the
/// horizon where `|du/dφ|` is below 2, so that the terms fall by a factor of 8 or more.
pub(super) const LONGEST_STEP: f64 = 0.25;

/// The largest change of u in one step, to first order: as |du/dφ| = e grows, the poles come closer as `e^{−1/3}` only.
const LONGEST_FALL: f64 = 0.5;

/// The most steps. The ray that is nearest to critical, Δ = 5e-324, flies for some 750 radians.
const MOST_STEPS: u32 = 4096;

/// The most terms of a step.
const TERMS: usize = 40;

/// The terms of a step end where they are below this share of the first ones.
const SMALLEST_TERM: f64 = f64::EPSILON / 16.0;

/// A point of an orbit in the phase plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct PhasePoint {
    /// Inverse radius.
    pub(super) u: f64,
    /// `u − 2/3`.
    x: f64,
    /// du/dφ.
    pub(super) w: f64,
}

impl PhasePoint {
    pub(super) fn new(u: f64, w: f64) -> Self {
        let x = three_u_minus_two(u) / 3.0;
        Self { u, x, w }
    }

    /// Returns where an orbit with a turning point turns.
    pub(super) fn turning(orbit: &Orbit) -> Self {
        let (u, x) = turning_point(orbit);
        Self { u, x, w: 0.0 }
    }

    /// Returns the point of the orbit that is `angle` ahead (behind, where negative), `None` where the orbit ends on
    /// the way. `delta` is the orbit's Δ.
    pub(super) fn advanced(mut self, angle: f64, delta: f64) -> Option<Self> {
        let mut left = angle;
        for _ in 0..MOST_STEPS {
            let longest = LONGEST_STEP.min(LONGEST_FALL / self.w.abs());
            let h = left.clamp(-longest, longest);
            self = self.step(h, delta);
            if !within_flight(self.u) {
                return None;
            }
            if h == left {
                break;
            }
            left -= h;
        }
        Some(self)
    }

    fn step(self, h: f64, delta: f64) -> Self {
        if self.u < 1.0 / 3.0 {
            let (u, w) = taylor(self.u, self.w, -1.0, h);
            return Self::new(u, w);
        }
        let (x, w) = taylor(self.x, self.w, 1.0, h);
        // Near the turning point the two cancel, and w itself has more digits.
        let critical = x * x * (1.0 + x);
        let squared = critical + delta;
        let w = if squared > 0.5 * critical {
            squared.sqrt().copysign(w)
        } else {
            w
        };
        Self {
            // 2/3 is its floating-point number plus ε/6.
            u: (x + f64::EPSILON / 6.0) + 2.0 / 3.0,
            x,
            w,
        }
    }
}

/// Returns the value and the slope at `h` of the solution of `y″ = 3/2 y² + linear·y` with `y(0) = value` and
/// `y′(0) = slope`.
#[inline]
fn taylor(value: f64, slope: f64, linear: f64, h: f64) -> (f64, f64) {
    // Terms c_k h^k.
    let mut terms = [0.0; TERMS];
    terms[0] = value;
    terms[1] = slope * h;
    let small = SMALLEST_TERM * value.abs().max(terms[1].abs());
    let mut count = 2;
    while count < TERMS {
        let k = count - 2;
        let pairs: f64 = (0..k.div_ceil(2)).map(|i| terms[i] * terms[k - i]).sum();
        let mut product = 2.0 * pairs;
        // `k.div_ceil(2)` pairs leave the middle one of an even k.
        if k.is_multiple_of(2) {
            product += terms[k / 2] * terms[k / 2];
        }
        terms[count] = h * h * (1.5 * product + linear * terms[k]) / (((k + 1) * (k + 2)) as f64);
        count += 1;
        // One term alone may be small by chance.
        if terms[count - 1].abs() + terms[count - 2].abs() <= small {
            break;
        }
    }
    // From the smallest: the first two are rounded once.
    let (mut change, mut slope_change) = (0.0, 0.0);
    for k in (2..count).rev() {
        change += terms[k];
        slope_change += k as f64 * terms[k];
    }
    let slope_change = if h == 0.0 { 0.0 } else { slope_change / h };
    (value + (terms[1] + change), slope + slope_change)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::invariants::CRITICAL_E2;

    /// The critical ray: `u = tanh²(φ/2) − 1/3` (Chandrasekhar, §20).
    #[test]
    fn the_critical_ray_is_followed_to_the_photon_sphere() {
        let at = |phase: f64| {
            let tanh = libm::tanh(0.5 * phase);
            let w = tanh * (1.0 - tanh * tanh);
            (tanh * tanh - 1.0 / 3.0, w)
        };
        let (u, w) = at(1.5);
        for angle in [0.01, 0.3, 2.0, 8.0, 30.0] {
            let point = PhasePoint::new(u, w).advanced(angle, 0.0).unwrap();
            let (known, slope) = at(1.5 + angle);
            assert!((point.u - known).abs() <= 4e-16, "{angle}: {}", point.u);
            assert!((point.w - slope).abs() <= 4e-16, "{angle}: {}", point.w);
        }
    }

    /// `e²` is conserved by steps that do not use it.
    #[test]
    fn steps_conserve_the_first_integral() {
        for (u, w) in [(0.3, 0.1), (0.1, -0.3), (1e-9, 0.2), (0.2, 50.0)] {
            let start = PhasePoint::new(u, w);
            let e2 = w * w + u * u * (1.0 - u);
            let end = start.advanced(0.2 / w.abs().max(1.0), e2 - CRITICAL_E2);
            let end = end.unwrap_or_else(|| panic!("({u}, {w}) ends"));
            let after = end.w * end.w + end.u * end.u * (1.0 - end.u);
            assert!((after - e2).abs() <= 4.0 * f64::EPSILON * e2, "({u}, {w})");
        }
    }
}

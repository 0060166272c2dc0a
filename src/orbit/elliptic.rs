//! Swept angles as elliptic integrals of the first kind, in forms that keep their digits for every ray.
//!
//! `φ = ∫ du/√P`, `P(u) = u³ − u² + e² = (u − u1)(u − u2)(u − u3)`. The roots come from one angle η, so that neither
//! a near-critical ray (u2 ≈ u3) nor a far one (u1 ≈ u2 ≈ 0) subtracts nearly equal numbers. The forms used here stay
//! within `1e-12 + 16 ε·condition` of the truth for every ray outside the horizon.

use super::carlson::rf;
use super::invariants::{
    CRITICAL_E2, Family, Orbit, OrbitPoint, PHOTON_SPHERE_U, three_u_minus_two,
};

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Returns the inverse radius at which an orbit with `e² < 4/27` turns: u2 outside the photon sphere, u3 inside.
pub(crate) fn turning_u(orbit: &Orbit) -> f64 {
    let (u, _) = turning_point(orbit);
    // Rounding must not lead to the other side of the start or of the photon sphere.
    match orbit.family {
        Family::Scattered => u.clamp(orbit.start.u, PHOTON_SPHERE_U),
        Family::Trapped => u.clamp(PHOTON_SPHERE_U.next_up(), orbit.start.u),
        Family::Monotone => u,
    }
}

/// Returns [`turning_u`], and its difference from the photon sphere's 2/3 to its own last digits.
pub(super) fn turning_point(orbit: &Orbit) -> (f64, f64) {
    let roots = RealRoots::new(orbit.e2, orbit.delta);
    let periapsis = roots.u1 + roots.a;
    if orbit.family == Family::Trapped {
        (periapsis + roots.delta, 0.5 * roots.delta - roots.shift)
    } else {
        (periapsis, -0.5 * roots.delta - roots.shift)
    }
}

/// The roots `u1 ≤ 0 ≤ u2 < u3` of P for `e² < 4/27`, by their differences.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RealRoots {
    /// Smallest root, ≤ 0.
    u1: f64,
    /// `u2 − u1`.
    a: f64,
    /// `u3 − u2`.
    delta: f64,
    /// `2/3 − (u2 + u3)/2`.
    shift: f64,
}

impl RealRoots {
    /// Computes the roots by Viète's trigonometric solution (DLMF 1.11.32-33). With `cos 3η = 27e²/2 − 1`,
    /// η ∈ (0, π/3], ζ = π/3 − η: `u3 − u2 = (2/√3) sin η`, `u2 − u1 = (2/√3) sin ζ`, `u1 = 1/3 − (2/3) cos η`. The
    /// smaller one of η and ζ is computed from the small one of `−Δ` and `e²`, and the other from it.
    pub(crate) fn new(e2: f64, delta: f64) -> Self {
        const THIRD_OF_PI: f64 = core::f64::consts::FRAC_PI_3;
        let near_critical = -delta < 0.5 * CRITICAL_E2;
        let (eta, zeta) = if near_critical {
            let eta = 2.0 / 3.0 * libm::asin((-delta / CRITICAL_E2).sqrt());
            (eta, THIRD_OF_PI - eta)
        } else {
            let zeta = 2.0 / 3.0 * libm::asin((e2 / CRITICAL_E2).sqrt());
            (THIRD_OF_PI - zeta, zeta)
        };
        let (sin_eta, sin_zeta) = (libm::sin(eta), libm::sin(zeta));
        let u1 = if near_critical {
            1.0 / 3.0 - 2.0 / 3.0 * libm::cos(eta)
        } else {
            let half = libm::sin(0.5 * zeta);
            2.0 / 3.0 * half * half - sin_zeta / SQRT_3
        };
        let half = libm::sin(0.5 * eta);
        Self {
            u1,
            a: 2.0 / SQRT_3 * sin_zeta,
            delta: 2.0 / SQRT_3 * sin_eta,
            shift: 2.0 / 3.0 * half * half,
        }
    }

    /// Computes `∫ du/√P` from u to the periapsis u2, for a point outside the photon sphere.
    ///
    /// With `sin²θ = (u2 − u)/a = u̇²/((u3 − u)(u − u1) a)`:
    /// `2∫₀^θ dθ/√(δ + a sin²θ) = (2 sin θ/√δ) R_F(cos²θ, 1 + (a/δ) sin²θ, 1)` (DLMF 19.25.5), where
    /// `cos²θ = (u − u1)/a` and `1 + (a/δ) sin²θ = (u3 − u)/δ`.
    pub(super) fn to_periapsis(self, point: OrbitPoint) -> f64 {
        let from_u1 = point.u - self.u1;
        // u3 − u, written about the photon sphere so that every term but the first keeps its sign and its digits.
        let to_u3 = 0.5 * self.delta - self.shift - three_u_minus_two(point.u) / 3.0;
        let sine = point.slope / (to_u3 * from_u1 * self.a).sqrt();
        2.0 * sine / self.delta.sqrt() * rf(from_u1 / self.a, to_u3 / self.delta, 1.0)
    }

    /// Computes the analytic function `V(u) = (∫ du/√P from u to the periapsis u2) / |du/dφ|`, beyond u2 too, where
    /// both are imaginary.
    pub(crate) fn to_periapsis_over_slope(self, u: f64) -> f64 {
        let from_u1 = u - self.u1;
        let to_u3 = 0.5 * self.delta - self.shift - three_u_minus_two(u) / 3.0;
        2.0 / (to_u3 * from_u1 * self.a * self.delta).sqrt()
            * rf(from_u1 / self.a, to_u3 / self.delta, 1.0)
    }

    /// Computes `∫ du/√P` from the apoapsis u3 to u, for a point inside the photon sphere.
    ///
    /// With `x = u − u3 = u̇²/((u − u1)(u − u2))`, `b = u3 − u1`:
    /// `2√(x/(δb)) R_F(1, 1 + x/δ, 1 + x/b)` (DLMF 19.29.4 with the lower limit at a root).
    pub(super) fn to_apoapsis(self, point: OrbitPoint) -> f64 {
        let from_u2 = three_u_minus_two(point.u) / 3.0 + self.shift + 0.5 * self.delta;
        let b = self.a + self.delta;
        let scale = ((point.u - self.u1) * from_u2).sqrt();
        let x_root = point.slope / scale;
        let x = x_root * x_root;
        2.0 * x_root / (self.delta * b).sqrt() * rf(1.0, 1.0 + x / self.delta, 1.0 + x / b)
    }

    /// Computes the analytic function `Z(u) = (∫ du/√P from the apoapsis u3 to u) / |du/dφ|`, below u3 too.
    pub(crate) fn to_apoapsis_over_slope(self, u: f64) -> f64 {
        let from_u2 = three_u_minus_two(u) / 3.0 + self.shift + 0.5 * self.delta;
        let x = from_u2 - self.delta;
        let b = self.a + self.delta;
        2.0 / (self.delta * b * (u - self.u1) * from_u2).sqrt()
            * rf(1.0, 1.0 + x / self.delta, 1.0 + x / b)
    }
}

/// Computes `∫ du/√P` between two inverse radii for `e² > 4/27`, where `P = (u − u1)((u − p)² + q²)` has no root
/// between the limits.
///
/// With `cosh 3η = 1 + 27Δ/2`: `u1 = 1/3 − (2/3) cosh η`, `p = (1 − u1)/2`, `q = sinh η/√3`, `c = p − u1 = cosh η`
/// (the cubic's one real root, DLMF 1.11.34). By DLMF 19.29.19–33 with the factors `Q1 = u − u1` and
/// `Q2 = (u − p)² + q²`, `∫ = 4 |x − y| R_F(S, S + (D + V)(x − y)², S + (D − V)(x − y)²)`, `S = S1 S2`,
/// `S1 = (√Q1(x) + √Q1(y))²`, `S2 = (√Q2(x) + √Q2(y))² − (x − y)²`, `D = 2c`, `V = 2√(c² + q²)`.
pub(crate) fn without_turning_point(e2: f64, delta: f64, from: f64, to: f64) -> f64 {
    let (x, y) = if from > to { (from, to) } else { (to, from) };
    let width = x - y;
    if e2 > 1e40 {
        // The ray is radial to every digit: u²(1 − u)/e² < 1e-40.
        return width / e2.sqrt();
    }
    let eta = 2.0 / 3.0 * libm::asinh((delta / CRITICAL_E2).sqrt());
    let half = libm::sinh(0.5 * eta);
    let c = libm::cosh(eta);
    let q = libm::sinh(eta) / SQRT_3;
    let minus_u1 = 1.0 / 3.0 + 4.0 / 3.0 * half * half;
    // u − p, as p − 2/3 = (cosh η − 1)/3.
    let from_p = |u: f64| three_u_minus_two(u) / 3.0 - 2.0 / 3.0 * half * half;
    let (px, py) = (from_p(x), from_p(y));
    let (rx, ry) = ((px * px + q * q).sqrt(), (py * py + q * q).sqrt());
    let root = (x + minus_u1).sqrt() + (y + minus_u1).sqrt();
    // √Q2(x) + √Q2(y) − (x − y) = (√Q2(x) − (x − p)) + (√Q2(y) + (y − p)), each computed by its conjugate where it
    // would subtract.
    let above = if px > 0.0 { q * q / (rx + px) } else { rx - px };
    let below = if py < 0.0 { q * q / (ry - py) } else { ry + py };
    let excess = above + below;
    let s = root * root * excess * (rx + ry + width);
    let v = 2.0 * (c * c + q * q).sqrt();
    // D − V without subtracting: 4(c² − c² − q²)/(D + V).
    let lower = -4.0 * q * q / (2.0 * c + v);
    let w2 = width * width;
    4.0 * width * rf(s, s + (2.0 * c + v) * w2, s + lower * w2)
}

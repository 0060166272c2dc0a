//! The four charts of the phase plane, and the smooth function that each of them stores.
//!
//! A swept angle is `∫ du/√P`, `P = u³ − u² + e² = (du/dφ)²`. As one function of `(u0, du/dφ)` it would be singular on
//! the critical line `e² = 4/27`, at every turning point and at both ends of e. Each chart removes in closed form what
//! is singular in its part of the plane. The rest is analytic well beyond the chart's borders.
//!
//! | chart | where | axes | stored | swept angle |
//! |---|---|---|---|---|
//! | critical | 0.64 ≤ 27e²/4 ≤ 3 | γ = √(u + 1/3), e | A(e), B(γ, e) | a difference or a sum of two J |
//! | weak | 27e²/4 < 0.64, u < 2/3 | v = u/e, `t = √(1 − e/e_c)` | V(v, t) | to the periapsis: \|u̇\|/(e + u) V |
//! | trapped | 27e²/4 < 0.64, u > 2/3 | u, t | Z(u, t) | to the apoapsis: \|u̇\|/(u − 0.39) Z |
//! | radial | 27e²/4 > 3 | u, 1/e² | H(u, 1/e²) | difference of two H, over e |
//!
//! `J = ±A ln((s + |u̇|)/√|Δ|) + |u̇|/(u + 0.28) B`, `Δ = e² − 4/27`, `e_c² = 4/27`. The borders are where the charts
//! on both sides need equally many nodes, by measurement.
//!
//! # Derivation
//! *Critical.* With `s = |u − 2/3| √(u + 1/3)` and its signed form `σ`, `P = σ² + Δ`. Near the photon sphere the
//! integrand is an analytic function of σ over `√(σ² + Δ)`, so that term by term
//! `∫ du/√P = A asinh(σ/√Δ) + √P B/(u + 0.28)`, with A and B analytic in Δ through zero: **the critical line is no
//! singularity of either**. (For Δ < 0 read `± acosh(|σ|/√−Δ)`; both are `± ln((s + |u̇|)/√|Δ|)`.) B/(u + 0.28) is
//! next singular at the root u1, where it has a pole in √(u − u1); u1 lies between −0.273 and −1/3 where Δ < 0. The
//! factor u + 0.28 removes most of that pole. As functions of e both are singular at e = 0 only.
//!
//! B itself comes from a power series. With the cubic's lone root u1, p the mean of the other two, `c = p − u1`, `y =
//! (u − p)/c`, `m = (1 − c⁻²)/3`: `√c ∫ du/√P = ∫ dy/(√(1 + y) √(y² + m)) = A₁ asinh(y/√m) + √(y² + m) Σ bₙ yⁿ`.
//! Its derivative gives, with `aₙ = binom(−½, n)`, `n bₙ₋₁ + m (n + 1) bₙ₊₁ = aₙ` and `A₁ = 1 − m b₁`. The recurrence
//! is stable downwards, and is solved from n = 140 down. So `A = A₁/√c`, and with the difference of the two logarithms,
//! `asinh(|u̇| ν)`, `B = (u + 0.28) (Σ bₙ yⁿ / (c √(c (u − u1))) + A asinh(|u̇| ν)/|u̇|)`, where, with `x = u − 2/3`,
//! `d = c − 1`, `ν = 9 (2x/(3(√(u − u1) + γ)) − √(u − u1)/3) / (√(u − u1) (3 + 2d) √(2(2 + d)))`: no term of it is
//! small or large near the critical line, where the orbit's own logarithm is infinite.
//!
//! *Weak* and *trapped*: the angle to the turning point is odd in u̇ and analytic in u̇², so that divided by u̇ it is
//! analytic in u, beyond the turning point too. Its next singularity is the other turning point: for small e the
//! mirrored one at v = −1, where the factor 1 + v turns a pole into a root. The factor u − 0.39 does the same for
//! trapped rays, whose next singularity is the periapsis at u2 < 0.3963. In flat space `V = acos v √((1 + v)/(1 − v))`.
//!
//! *Radial*: `H = ∫₀ᵘ du/√(1 − u²(1 − u)/e²)` is analytic in u and 1/e², and gives short angles with small absolute
//! error.

use crate::orbit::carlson::rf;
pub(crate) use crate::orbit::invariants::CRITICAL_E2;
use crate::orbit::{RealRoots, without_turning_point};

/// The border between the weak or the trapped chart and the critical one.
pub(crate) const LOWER_E2: f64 = 0.64 * CRITICAL_E2;

/// The border between the critical chart and the radial one.
pub(crate) const UPPER_E2: f64 = 3.0 * CRITICAL_E2;

/// The smallest u of the trapped chart, just below the apoapsis u3, which is 0.87662 where e² is [`LOWER_E2`].
pub(crate) const TRAPPED_U: f64 = 0.8766;

/// A number near −u1, which is 0.27292 where e² is [`LOWER_E2`] and 1/3 for the critical ray.
pub(crate) const CRITICAL_POLE: f64 = 0.28;

/// A number near the largest periapsis u2 of the trapped chart's orbits, beyond the photon sphere: 0.39630 where e² is
/// [`LOWER_E2`].
pub(crate) const TRAPPED_POLE: f64 = 0.39;

/// The largest v of the weak chart, just above u2/e = 1/√(1 − u2), which is 1.28704 where e² is [`LOWER_E2`].
pub(crate) const WEAK_V: f64 = 1.2871;

/// The critical impact parameter, `1/e_c = 3√3/2`.
pub(crate) const CRITICAL_B: f64 = 2.598_076_211_353_316;

/// How many powers of y are kept. In the critical chart |y| < 0.71 and |m| < 0.14, and 0.71¹⁴⁰ is below 1e-20.
const TERMS: usize = 140;

/// A row of the critical chart: everything that depends on Δ alone.
pub(crate) struct CriticalRow {
    delta: f64,
    /// `c − 1`.
    d: f64,
    c: f64,
    amplitude: f64,
    series: Vec<f64>,
}

impl CriticalRow {
    /// Computes the row of `e`.
    pub(crate) fn new(e: f64) -> Self {
        let delta = (e - CRITICAL_E2.sqrt()) * (e + CRITICAL_E2.sqrt());
        // c = cosh η or cos η with 4c³ − 3c = 1 + 27Δ/2. c − 1 is computed without cancellation.
        let d = if delta > 0.0 {
            let half = libm::sinh(libm::asinh((delta / CRITICAL_E2).sqrt()) / 3.0);
            2.0 * half * half
        } else {
            let half = libm::sin(libm::asin((-delta / CRITICAL_E2).sqrt()) / 3.0);
            -2.0 * half * half
        };
        let c = 1.0 + d;
        let m = d * (2.0 + d) / (3.0 * c * c);
        let mut binomials = vec![1.0; TERMS];
        for n in 1..TERMS {
            let k = n as f64;
            binomials[n] = binomials[n - 1] * (0.5 - k) / k;
        }
        let mut series = vec![0.0; TERMS + 1];
        for n in (1..TERMS).rev() {
            let k = n as f64;
            series[n - 1] = (binomials[n] - m * (k + 1.0) * series[n + 1]) / k;
        }
        let amplitude = (1.0 - m * series[1]) / c.sqrt();
        Self {
            delta,
            d,
            c,
            amplitude,
            series,
        }
    }

    /// Returns `A`, the logarithm's factor. It is 1 at the critical line.
    pub(crate) fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Computes `B` at γ.
    pub(crate) fn value(&self, gamma: f64) -> f64 {
        // u − 2/3, u − u1, y.
        let x = (gamma - 1.0) * (gamma + 1.0);
        let from_u1 = 1.0 + x + 2.0 / 3.0 * self.d;
        let y = (x - self.d / 3.0) / self.c;
        let sum = self.series.iter().rev().fold(0.0, |sum, &b| sum * y + b);
        // u̇² = σ² + Δ; √(y² + m)/√c = |u̇| / (c √c √(u − u1)).
        let slope2 = x * x * (1.0 + x) + self.delta;
        let over_slope = sum / (self.c * (self.c * from_u1).sqrt())
            + self.amplitude * self.log_difference(x, from_u1, slope2);
        (gamma * gamma - 1.0 / 3.0 + CRITICAL_POLE) * over_slope
    }

    /// Computes `(asinh(y/√m) − asinh(σ/√Δ)) / |u̇|`.
    ///
    /// The hyperbolic sine of the numerator is `|u̇| ν`, `ν = (y − σ√((y² + m)/P))/√(mΔ)`. With `x = u − 2/3`, `d = c
    /// − 1`: `mΔ = d² · 2(2 + d)(3 + 2d)²/(81c²)` and `y − … = d (2x/3/(√(u − u1) + √(u + 1/3)) − √(u − u1)/3)/(c√(u
    /// − u1))`, so that d cancels.
    fn log_difference(&self, x: f64, from_u1: f64, slope2: f64) -> f64 {
        let root = from_u1.sqrt();
        let numerator = 2.0 / 3.0 * x / (root + (1.0 + x).sqrt()) - root / 3.0;
        let nu = 9.0 * numerator / (root * (3.0 + 2.0 * self.d) * (2.0 * (2.0 + self.d)).sqrt());
        nu * asinh_over(nu * nu * slope2)
    }
}

/// Computes `asinh(√z)/√z`, which is analytic at 0 and `asin(√−z)/√−z` for z < 0.
fn asinh_over(z: f64) -> f64 {
    if z.abs() < 1e-3 {
        // The next term is 63 z⁵/2816 < 3e-17.
        1.0 - z * (1.0 / 6.0 - z * (3.0 / 40.0 - z * (15.0 / 336.0 - z * (105.0 / 3456.0))))
    } else if z > 0.0 {
        libm::asinh(z.sqrt()) / z.sqrt()
    } else {
        libm::asin((-z).sqrt()) / (-z).sqrt()
    }
}

/// Returns `e` at a place of the weak and the trapped charts' axis, `t = √(1 − e/e_c)`. The root stretches the axis
/// towards the critical line, where both are singular.
fn slope_at_infinity(t: f64) -> f64 {
    (1.0 - t) * (1.0 + t) * CRITICAL_E2.sqrt()
}

/// Computes `V(v, t)`: the angle from u = ve to the periapsis, over |u̇|/(e + u); `e = e_c(1 − t²)`.
pub(crate) fn weak(v: f64, t: f64) -> f64 {
    let e = slope_at_infinity(t);
    if e == 0.0 {
        // Flat space, where the roots are −e, e and 1.
        return (2.0 * (v + 1.0)).sqrt() * rf(0.5 * (v + 1.0), 1.0, 1.0);
    }
    let e2 = e * e;
    e * (v + 1.0) * RealRoots::new(e2, e2 - CRITICAL_E2).to_periapsis_over_slope(v * e)
}

/// Computes `Z(u, t)`: the angle from u to the apoapsis, over |u̇|/(u − 0.39); `e = e_c(1 − t²)`.
pub(crate) fn trapped(u: f64, t: f64) -> f64 {
    let e = slope_at_infinity(t);
    let e2 = e * e;
    (u - TRAPPED_POLE) * RealRoots::new(e2, e2 - CRITICAL_E2).to_apoapsis_over_slope(u)
}

/// Computes `H(u, 1/e²)`: the angle from infinity to u, times e.
pub(crate) fn radial(u: f64, inverse_e2: f64) -> f64 {
    if inverse_e2 == 0.0 {
        return u;
    }
    let e2 = 1.0 / inverse_e2;
    without_turning_point(e2, e2 - CRITICAL_E2, 0.0, u) * e2.sqrt()
}

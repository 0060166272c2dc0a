//! Swept angles by numerical quadrature, with Δ in exact arithmetic. It uses no elliptic integrals, no trigonometric
//! roots and no code of the library. The relative error is about 1e-14.
//!
//! With `x = u − 2/3` the integrand is `1/√P`, `P = x²(1 + x) + Δ`. Substitutions that take P's two nearest roots into
//! the variable of integration leave one square root, of the distance from the farthest root:
//!
//! * Δ > 0, `P = (x + z)((x − p)² + q²)`, `x = p + q sinh t`: `∫ dt/√(x + z)`.
//! * Δ < 0, roots −z, −X (periapsis), Y (apoapsis), `δ = X + Y`, `x = −X − δ sinh² t` or `Y + δ sinh² t`:
//!   `2 ∫ dt/√(x + z)` from the turning point.
//! * e² small, roots u1 < 0 < u2 < u3 of `u³ − u² + e²`, `u = u2 − (u2 − u1) sin² t`: `2 ∫ dt/√(u3 − u)`.

use std::sync::OnceLock;

use darkness::orbit::{Event, EventKind};

use crate::natural;

/// A ray whose two numbers are taken as exact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrueRay {
    u: f64,
    w: f64,
    /// `Δ = e² − 4/27`.
    pub(crate) delta: f64,
    e2: f64,
}

impl TrueRay {
    pub(crate) fn new(u: f64, w: f64) -> Self {
        Self {
            u,
            w,
            delta: natural::distance_from_critical(u, w),
            e2: natural::squared_slope(u, w, 0.0),
        }
    }

    /// Whether the ray starts inside the photon sphere.
    pub(crate) fn inside(&self) -> bool {
        from_photon_sphere(self.u) > 0.0
    }

    /// The angle swept until an event that does happen.
    pub(crate) fn angle(&self, event: &Event) -> f64 {
        self.angle_with(event, 0.0)
    }

    /// The same for a ray whose Δ is larger by `shift`.
    fn angle_with(&self, event: &Event, shift: f64) -> f64 {
        let delta = self.delta + shift;
        // Also for an infinite radius.
        let end = 1.0 / event.radius;
        if delta > 0.0 {
            return monotone(delta, from_photon_sphere(self.u), from_photon_sphere(end)).abs();
        }
        let to_turn = |u: f64, squared: f64| {
            if -delta > 2.0 / 27.0 && !self.inside() {
                from_periapsis(self.e2 + shift, u, squared)
            } else {
                from_turning_point(delta, from_photon_sphere(u), squared)
            }
        };
        let first = to_turn(self.u, self.w * self.w + shift);
        let second = to_turn(end, natural::squared_slope(self.u, self.w, end) + shift);
        let starts_inward = self.w > 0.0;
        let happens_inward = match event.kind {
            EventKind::Inbound => true,
            EventKind::Outbound => false,
            EventKind::End(_) => self.inside(),
        };
        if starts_inward == happens_inward {
            (first - second).abs()
        } else {
            first + second
        }
    }

    /// `|∂angle/∂ln dudphi| + |∂angle/∂ln u0|`: with Δ's derivatives `2w` and `2u − 3u²`, and the start's own part of
    /// the path.
    pub(crate) fn condition(&self, event: &Event) -> f64 {
        // Small enough for some digits of the difference, and to stay on this side of critical.
        let step = 1e-4 * self.delta.abs().min(self.w * self.w);
        let by_delta =
            (self.angle_with(event, step) - self.angle_with(event, -step)) / (2.0 * step);
        let (u, w) = (self.u, self.w);
        let by_u = by_delta * (2.0 * u - 3.0 * u * u) - 1.0 / w;
        (by_delta * 2.0 * w * w).abs() + (by_u * u).abs()
    }
}

/// `u − 2/3`, where 2/3 is its floating-point number plus ε/6.
fn from_photon_sphere(u: f64) -> f64 {
    (u - 2.0 / 3.0) - f64::EPSILON / 6.0
}

/// A root by Newton's method, from a start from which it converges.
fn newton(mut x: f64, mut step: impl FnMut(f64) -> f64) -> f64 {
    for _ in 0..100 {
        let next = x - step(x);
        // The last steps alternate between neighbouring numbers.
        if (next - x).abs() <= 2.0 * f64::EPSILON * next.abs() {
            return next;
        }
        x = next;
    }
    panic!("Newton's method does not converge: {x}");
}

fn monotone(delta: f64, from: f64, to: f64) -> f64 {
    // z²(z − 1) = Δ.
    let z = newton(1.0 + delta, |z| {
        (z * z * (z - 1.0) - delta) / (z * (3.0 * z - 2.0))
    });
    let p = delta / (2.0 * z * z);
    let q = (delta / z - p * p).sqrt();
    let ends = [from, to].map(|x| libm::asinh((x - p) / q));
    integral(ends[0], ends[1], |t| {
        1.0 / (p + q * libm::sinh(t) + z).sqrt()
    })
}

/// From the turning point on the side of x to x, where `(du/dφ)²` is `squared`.
fn from_turning_point(delta: f64, x: f64, squared: f64) -> f64 {
    let root = (-delta).sqrt();
    // X √(1 − X) = √−Δ = Y √(1 + Y).
    let turn = |sign: f64| {
        newton(root, |x| {
            let s = (1.0 + sign * x).sqrt();
            (x * s - root) / (s + sign * 0.5 * x / s)
        })
    };
    let (periapsis, apoapsis) = (turn(-1.0), turn(1.0));
    let z = 1.0 - periapsis + apoapsis;
    let apart = periapsis + apoapsis;
    // P = y² (δ + y²)(x + z) with y the distance from the turning point: divide by the factor that keeps its digits.
    let beyond = if x < 0.0 { apoapsis - x } else { x + periapsis };
    let y2 = squared / (beyond * (x + z));
    let end = libm::asinh((y2 / apart).sqrt());
    let sign = if x < 0.0 { -1.0 } else { 1.0 };
    let turning_x = if x < 0.0 { -periapsis } else { apoapsis };
    integral(0.0, end, |t| {
        let sinh = libm::sinh(t);
        2.0 / (turning_x + sign * apart * sinh * sinh + z).sqrt()
    })
}

/// From the periapsis to u, where e² is small.
pub(crate) fn from_periapsis(e2: f64, u: f64, squared: f64) -> f64 {
    let e = e2.sqrt();
    // u2 √(1 − u2) = e = −u1 √(1 − u1).
    let root = |sign: f64| {
        newton(e, |u| {
            let s = (1.0 + sign * u).sqrt();
            (u * s - e) / (s + sign * 0.5 * u / s)
        })
    };
    let (u2, minus_u1) = (root(-1.0), root(1.0));
    let u3 = 1.0 - u2 + minus_u1;
    let a = u2 + minus_u1;
    let sine = (squared / ((u3 - u) * (u + minus_u1) * a)).sqrt();
    let delta = u3 - u2;
    integral(0.0, libm::asin(sine.min(1.0)), |t| {
        let sin = libm::sin(t);
        2.0 / (delta + a * sin * sin).sqrt()
    })
}

/// By Gauss and Legendre's rule with 16 nodes on panels of at most ¼. The integrands' nearest singularities are 0.2
/// from the ends of the range (ln √(u − u1) of the farthest root at u = 0): the error of a panel is below
/// (0.3)³² of the integrand there, less than 1e-16.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    static RULE: OnceLock<[(f64, f64); 8]> = OnceLock::new();
    let panels = ((to - from).abs() * 4.0).ceil().max(1.0);
    let half = 0.5 * (to - from) / panels;
    let rule = RULE.get_or_init(gauss_legendre);
    (0..panels as u32)
        .map(|k| {
            let middle = from + half * (2.0 * f64::from(k) + 1.0);
            let sum: f64 = rule
                .iter()
                .map(|&(x, weight)| weight * (f(middle + half * x) + f(middle - half * x)))
                .sum();
            half * sum
        })
        .sum()
}

/// The positive nodes of the rule of 16, and their weights `2/((1 − x²) P₁₆′(x)²)` (DLMF 3.5.25 and table 3.5.1).
fn gauss_legendre() -> [(f64, f64); 8] {
    const NODES: i32 = 16;
    core::array::from_fn(|k| {
        let guess = libm::cos(core::f64::consts::PI * (k as f64 + 0.75) / (f64::from(NODES) + 0.5));
        let legendre = |x: f64| {
            let (mut before, mut value) = (1.0, x);
            for n in 1..NODES {
                let n = f64::from(n);
                (before, value) = (
                    value,
                    ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0),
                );
            }
            let derivative = f64::from(NODES) * (before - x * value) / (1.0 - x * x);
            (value, derivative)
        };
        let x = (0..10).fold(guess, |x, _| {
            let (value, derivative) = legendre(x);
            x - value / derivative
        });
        let (_, derivative) = legendre(x);
        (x, 2.0 / ((1.0 - x * x) * derivative * derivative))
    })
}

//! One point of an isoradial curve: the slope that carries a ray to a radius in a given angle.

use super::{Edge, Sight};
use crate::orbit::Fate;
use crate::orbit::invariants::Orbit;
use crate::orbit::path::{Crossings, SweptAngles};

/// From where, to which radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub(super) u0: f64,
    pub(super) slope_scale: f64,
    /// κ of the critical ray.
    pub(super) critical: f64,
    /// Inverse radius to be met.
    pub(super) u_disk: f64,
}

impl Target {
    /// An edge of the disk, seen by the camera of `sight`.
    pub(super) fn new(sight: &Sight, edge: Edge) -> Self {
        Self {
            u0: sight.u0,
            slope_scale: sight.slope_scale,
            critical: sight.critical(),
            u_disk: match edge {
                Edge::Inner => sight.u_inner,
                Edge::Outer => sight.u_outer,
            },
        }
    }

    /// A guess of h for the ray that meets the radius at `angle`: flat space's ray in the first half turn, where `u =
    /// u0 cos φ + w sin φ`, and the rings' decay towards the critical ray beyond.
    pub(super) fn first_guess(&self, angle: f64) -> f64 {
        if angle < core::f64::consts::PI {
            let flat = (self.u_disk / self.u0 - libm::cos(angle)) / libm::sin(angle).max(0.1);
            flat - self.critical
        } else {
            -self.critical.abs() * libm::exp(-angle)
        }
    }

    /// The orbit with `κ = κ_c + h`. `Δ = (w − w_c)(w + w_c)` from h itself: exact however close to critical.
    fn orbit(&self, h: f64) -> Orbit {
        let excess = self.slope_scale * h;
        let critical = self.slope_scale * self.critical;
        Orbit::with_delta(
            self.u0,
            critical + excess,
            excess * (2.0 * critical + excess),
        )
    }

    /// Positive where the ray of `h` is closer to the hole than the radius sought when it has swept `angle`; rises
    /// with h (see the [module above](super)), through zero where it is just there. The size is the angle that is
    /// missing. Infinite where the ray never meets the radius.
    fn residual(&self, h: f64, angle: f64, angles: &impl SweptAngles) -> f64 {
        let orbit = self.orbit(h);
        let Crossings { inbound, outbound } = angles.crossings(&orbit, self.u_disk);
        match (inbound, outbound) {
            (Some(enter), Some(leave)) => (angle - enter).min(leave - angle),
            (Some(enter), None) => angle - enter,
            (None, Some(leave)) => leave - angle,
            // Never there: all the way inside the radius, or all the way outside.
            (None, None) if orbit.fate() == Fate::Capture => f64::INFINITY,
            (None, None) => f64::NEG_INFINITY,
        }
    }

    /// The h with which a ray meets the radius at `angle`, found from a guess.
    ///
    /// Secant steps, kept within the bracket that the residuals' signs have shown so far; bisection, or doubling the
    /// step where one end is not known yet, wherever the secant leaves it or the residual is infinite.
    pub(super) fn solve(&self, angle: f64, guess: f64, angles: &impl SweptAngles) -> f64 {
        const STEPS: usize = 200;
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let scale = if guess == 0.0 {
            self.critical.abs().max(f64::MIN_POSITIVE)
        } else {
            guess.abs()
        };
        let mut stride = 1e-4 * scale;
        let mut previous: Option<(f64, f64)> = None;
        let mut h = guess;
        for step in 0..STEPS {
            let residual = self.residual(h, angle, angles);
            if residual == 0.0 {
                return h;
            }
            if residual < 0.0 {
                low = low.max(h);
            } else {
                high = high.min(h);
            }
            let secant = previous.and_then(|(h0, r0)| {
                let next = h - residual * (h - h0) / (residual - r0);
                // A last step that changes nothing is an answer, bracket or no bracket.
                (next.is_finite() && ((next > low && next < high) || next == h)).then_some(next)
            });
            // Every eighth step halves the bracket, should the secant creep.
            let next = match secant {
                Some(next) if step % 8 != 7 => next,
                _ if low.is_finite() && high.is_finite() => 0.5 * (low + high),
                _ => {
                    stride *= 4.0;
                    if residual < 0.0 {
                        h + stride
                    } else {
                        h - stride
                    }
                }
            };
            let change = (next - h).abs();
            previous = residual.is_finite().then_some((h, residual));
            h = next;
            // Where the residual bends like a root (a ray that grazes the radius) the secant's error is of the size
            // of its step.
            let bracketed = high - low <= 4.0 * f64::EPSILON * h.abs();
            if (secant == Some(next) && change <= 1e-13 * h.abs()) || bracketed {
                return h;
            }
        }
        h
    }
}

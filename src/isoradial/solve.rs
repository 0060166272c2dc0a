//! One point of an isoradial curve: the slope that carries a ray to a radius in a given angle.
//!
//! # From a neighbour's slope
//! A ray with `κ = κ_c + h` is a point of the curve itself: of the angle φ at which it meets the radius. So one swept
//! angle tells how far the curve is off a guess, `h(φ*) = h + h′ (φ* − φ) + …`, and the slope h′ of the curve is known
//! already from the nodes about it: no derivative of an angle is ever needed. If h′ is wrong by a share of
//! `b |φ* − φ|`, what is left is `b |h′| (φ* − φ)²`; where that is too much, the next slope is the secant's, and what is
//! left after it is at most what the two slopes disagree in.

use super::{Edge, Sight};
use crate::orbit::Fate;
use crate::orbit::invariants::{Orbit, RadialLeg};
use crate::orbit::path::{Branch, Crossings, FixedRadiiAngles, SweptAngles, ahead, turns};

/// From where, to which radius.
#[derive(Debug, Clone)]
pub(super) struct Target<B> {
    u0: f64,
    slope_scale: f64,
    /// κ of the critical ray,
    pub(super) critical: f64,
    /// and its slope.
    critical_slope: f64,
    /// Inverse radius to be met.
    u_disk: f64,
    /// There from `u0`.
    way: RadialLeg,
    angles: B,
}

/// Where a curve may be, and how steep.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guess {
    pub(super) h: f64,
    /// dh/dφ; not a number where nothing is known of it.
    pub(super) slope: f64,
    /// By what share of itself the slope may be wrong for each radian that the guess is off.
    pub(super) blur: f64,
    /// The way that the neighbours take.
    pub(super) branch: Branch,
}

/// A point of the curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) h: f64,
    /// dh/dφ about there; not a number where nothing is known of it.
    pub(super) slope: f64,
    /// The way that the ray takes there.
    pub(super) branch: Branch,
}

/// How right a point has to be: whichever is less strict.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closeness {
    /// In radians between rays.
    pub(super) psi: f64,
    /// In radians of φ; of the coarsest nodes, over the distance to the next.
    pub(super) phi: f64,
}

/// An edge of the disk, seen by the camera of `sight`.
pub(super) fn target<A: SweptAngles>(
    sight: &Sight,
    edge: Edge,
    angles: &A,
) -> Target<impl FixedRadiiAngles> {
    let u_disk = match edge {
        Edge::Inner => sight.u_inner,
        Edge::Outer => sight.u_outer,
    };
    Target {
        u0: sight.u0,
        slope_scale: sight.slope_scale,
        critical: sight.critical(),
        critical_slope: sight.slope_scale * sight.critical(),
        u_disk,
        way: RadialLeg::new(sight.u0, u_disk),
        angles: angles.between(sight.u0, u_disk),
    }
}

impl<B: FixedRadiiAngles> Target<B> {
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
    #[inline(always)]
    fn orbit(&self, h: f64) -> Orbit {
        let excess = self.slope_scale * h;
        Orbit::with_delta(
            self.u0,
            self.critical_slope + excess,
            excess * (2.0 * self.critical_slope + excess),
        )
    }

    /// Positive where the ray of `h` is closer to the hole than the radius sought when it has swept `angle`; rises
    /// with h (see the [module above](super)), through zero where it is just there. The size is the angle that is
    /// missing. Infinite where the ray never meets the radius.
    fn residual(&self, h: f64, angle: f64) -> f64 {
        let orbit = self.orbit(h);
        let Crossings { inbound, outbound } = self.angles.crossings(&orbit, self.way.end(&orbit));
        match (inbound, outbound) {
            (Some(enter), Some(leave)) => (angle - enter).min(leave - angle),
            (Some(enter), None) => angle - enter,
            (None, Some(leave)) => leave - angle,
            // Never there: all the way inside the radius, or all the way outside.
            (None, None) if orbit.fate() == Fate::Capture => f64::INFINITY,
            (None, None) => f64::NEG_INFINITY,
        }
    }

    /// The angle at which the ray of `h` meets the radius, and the way that it takes there: `branch`, where it does
    /// so twice.
    #[inline(always)]
    fn swept(&self, h: f64, branch: Branch) -> Option<(f64, Branch)> {
        let orbit = self.orbit(h);
        let point = self.way.end(&orbit)?;
        let taken = match (ahead(&orbit, self.u_disk), turns(&orbit)) {
            (true, true) => branch,
            (true, false) => Branch::Direct,
            (false, true) => Branch::Around,
            (false, false) => return None,
        };
        let swept = match taken {
            Branch::Direct => self.angles.direct(&orbit, point),
            Branch::Around => self.angles.around(&orbit, point),
        };
        Some((swept, taken))
    }

    /// What is kept at x = 0 in the piece with the pole: φ → 0, where `w φ → u_d − u0`, and x ~ φ.
    pub(super) fn at_pole(&self) -> f64 {
        (self.u_disk - self.u0) / self.slope_scale
    }

    /// The ray that meets the radius at `angle`, from a guess of it: see the [module's page](self).
    pub(super) fn follow(&self, angle: f64, guess: Guess, closeness: Closeness) -> Found {
        self.converge(angle, guess, closeness)
            .unwrap_or_else(|| self.search(angle, guess, closeness))
    }

    /// The same, where the way or the guess is a wrong one.
    #[cold]
    fn search(&self, angle: f64, guess: Guess, closeness: Closeness) -> Found {
        // Where both ways meet, the rays graze the radius: if it was not the one way, it may be the other now.
        let other = Guess {
            branch: guess.branch.other(),
            ..guess
        };
        if let Some(found) = self.converge(angle, other, closeness) {
            return found;
        }
        let h = if guess.h.is_finite() {
            guess.h
        } else {
            self.first_guess(angle)
        };
        let (h, slope) = self.bracket(angle, h, 1e-4);
        // Its slope is that of the angle that is missing: h rises with what a ray sweeps on its way out, and falls with
        // what it sweeps on its way in.
        for Guess { branch, .. } in [guess, other] {
            for slope in [slope, -slope] {
                let guess = Guess {
                    h,
                    slope,
                    blur: f64::INFINITY,
                    branch,
                };
                if let Some(found) = self.converge(angle, guess, closeness) {
                    return found;
                }
            }
        }
        Found {
            h: self.bracket(angle, h, 1e-13).0,
            slope: f64::NAN,
            branch: guess.branch,
        }
    }

    /// Newton's step with the guess's slope, and secant steps after it; none where they do not settle.
    #[inline(always)]
    fn converge(&self, angle: f64, guess: Guess, closeness: Closeness) -> Option<Found> {
        /// A secant that has not settled by then will not.
        const STEPS: usize = 8;
        let Guess {
            mut h,
            mut slope,
            blur,
            branch,
        } = guess;
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..STEPS {
            let (swept, branch) = self.swept(h, branch)?;
            let missing = angle - swept;
            let doubt = if let Some((h0, swept0)) = last {
                let secant = (h - h0) / (swept - swept0);
                let doubt = (secant - slope).abs();
                slope = secant;
                doubt
            } else {
                blur * (slope * missing).abs()
            };
            let step = slope * missing;
            let next = h + step;
            let left = doubt * missing.abs();
            // The farthest of the two from straight across, where h is fewest radians, may not be there.
            let kappa = (self.critical + h).abs().min((self.critical + next).abs());
            // Far away from the curve, where all rays are nearly straight, every estimate is small.
            let near =
                next.is_finite() && doubt <= 0.25 * slope.abs() && missing.abs() <= 0.25 * angle;
            let close = left <= closeness.psi * (1.0 + kappa * kappa)
                || left <= closeness.phi * slope.abs()
                || (last.is_some() && step.abs() <= 1e-13 * h.abs());
            if near && close {
                return Some(Found {
                    h: next,
                    slope,
                    branch,
                });
            }
            last = Some((h, swept));
            h = next;
        }
        None
    }

    /// The h with which a ray meets the radius at `angle`, found from a guess, to the share `close` of itself.
    ///
    /// Secant steps, kept within the bracket that the residuals' signs have shown so far; bisection, or doubling the
    /// step where one end is not known yet, wherever the secant leaves it or the residual is infinite.
    ///
    /// With it comes its slope over the residual.
    pub(super) fn bracket(&self, angle: f64, guess: f64, close: f64) -> (f64, f64) {
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
        let mut slope = f64::NAN;
        for step in 0..STEPS {
            let residual = self.residual(h, angle);
            if residual == 0.0 {
                return (h, slope);
            }
            if residual < 0.0 {
                low = low.max(h);
            } else {
                high = high.min(h);
            }
            let secant = previous.and_then(|(h0, r0)| {
                slope = (h - h0) / (residual - r0);
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
            if (secant == Some(next) && change <= close * h.abs()) || bracketed {
                break;
            }
        }
        (h, slope)
    }
}

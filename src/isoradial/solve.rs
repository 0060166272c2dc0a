//! Solves for one point of an isoradial curve: the slope with which a ray reaches a radius in a given angle.
//!
//! # From a neighbour's slope
//! Every ray is a point of the curve at some angle: the ray with `κ = κ_c + h` at the angle φ at which it meets the
//! radius. So one swept angle tells how far a guess is off, `h(φ*) = h + h′ (φ* − φ) + …`. The slope h′ of the curve is
//! known from its neighbouring nodes, so no derivative of an angle is ever computed.
//!
//! If h′ is wrong by a share of `b |φ* − φ|`, the error after this step is `b |h′| (φ* − φ)²`. Where that is too much,
//! the next step takes the secant's slope. The error after it is at most the difference of the two slopes times the
//! missing angle.

use super::curve_spec::CurveSpec;
use super::edge::Edge;
use crate::orbit::Fate;
use crate::orbit::invariants::{Orbit, RadialLeg};
use crate::orbit::path::{Branch, Crossings, FixedRadiiAngles, SweptAngles, ahead, turns};

/// Solves for points of one curve: rays of one camera radius that meet one radius of the disk.
#[derive(Debug, Clone)]
pub(super) struct CurveSolver<B> {
    u0: f64,
    slope_scale: f64,
    /// κ of the critical ray.
    pub(super) critical: f64,
    /// du/dφ of the critical ray.
    critical_slope: f64,
    /// The inverse radius to be met.
    u_disk: f64,
    /// The way from `u0` to `u_disk`.
    leg: RadialLeg,
    angles: B,
}

/// A guess of a point of a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveGuess {
    pub(super) h: f64,
    /// dh/dφ, or NaN where it is unknown.
    pub(super) slope: f64,
    /// The relative error of the slope for each radian by which the guess is off.
    pub(super) blur: f64,
    /// The branch of the neighbouring points.
    pub(super) branch: Branch,
}

/// A point of a curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurvePoint {
    pub(super) h: f64,
    /// dh/dφ near the point, or NaN where it is unknown.
    pub(super) slope: f64,
    /// The branch on which the ray meets the radius.
    pub(super) branch: Branch,
}

/// The allowed error of a point. Meeting one of the two is enough.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolveTolerance {
    /// In radians between rays.
    pub(super) psi: f64,
    /// In radians of φ; for the coarsest nodes, as a share of the distance to the next node.
    pub(super) phi: f64,
}

/// Creates the solver for an edge of the disk at inverse radius `u_disk`, seen by the camera of `spec`.
pub(super) fn curve_solver<A: SweptAngles>(
    spec: &CurveSpec,
    u_disk: f64,
    angles: &A,
) -> CurveSolver<impl FixedRadiiAngles> {
    CurveSolver {
        u0: spec.u0,
        slope_scale: spec.slope_scale,
        critical: spec.critical(),
        critical_slope: spec.slope_scale * spec.critical(),
        u_disk,
        leg: RadialLeg::new(spec.u0, u_disk),
        angles: angles.between(spec.u0, u_disk),
    }
}

/// Returns `κ − κ_c` of the ray that reaches an edge in a given angle, as right as the method's angles are. `angle` is
/// above 0; it is the `φ₁ + kπ` of [`Isoradials::height`](super::Isoradials::height). Returns NaN without a disk.
pub fn height_at(spec: &CurveSpec, edge: Edge, angle: f64, angles: &impl SweptAngles) -> f64 {
    let Some([u_inner, u_outer]) = spec.u_edges else {
        return f64::NAN;
    };
    let u_disk = match edge {
        Edge::Inner => u_inner,
        Edge::Outer => u_outer,
    };
    let solver = curve_solver(spec, u_disk, angles);
    solver.bracket(angle, solver.first_guess(angle), 1e-13).0
}

impl<B: FixedRadiiAngles> CurveSolver<B> {
    /// Guesses h of the ray that meets the radius at `angle`. In the first half turn it is the ray of flat space,
    /// `u = u0 cos φ + w sin φ`. Beyond, the guess decays towards the critical ray as the photon rings do.
    pub(super) fn first_guess(&self, angle: f64) -> f64 {
        if angle < core::f64::consts::PI {
            let flat = (self.u_disk / self.u0 - libm::cos(angle)) / libm::sin(angle).max(0.1);
            flat - self.critical
        } else {
            -self.critical.abs() * libm::exp(-angle)
        }
    }

    /// Returns the orbit with `κ = κ_c + h`. `Δ = (w − w_c)(w + w_c)` is computed from h itself, so that it keeps its
    /// digits however close to critical the orbit is.
    #[inline(always)]
    fn orbit(&self, h: f64) -> Orbit {
        let excess = self.slope_scale * h;
        Orbit::with_delta(
            self.u0,
            self.critical_slope + excess,
            excess * (2.0 * self.critical_slope + excess),
        )
    }

    /// Returns the angle by which the ray of `h` misses the radius after it has swept `angle`: positive where it is
    /// closer to the hole, negative where it is farther away. It rises with h (see the [module above](super)). It is
    /// infinite where the ray never meets the radius.
    fn residual(&self, h: f64, angle: f64) -> f64 {
        let orbit = self.orbit(h);
        let Crossings { inbound, outbound } = self.angles.crossings(&orbit, self.leg.end(&orbit));
        match (inbound, outbound) {
            (Some(enter), Some(leave)) => (angle - enter).min(leave - angle),
            (Some(enter), None) => angle - enter,
            (None, Some(leave)) => leave - angle,
            // The ray stays within the radius, or outside it.
            (None, None) if orbit.fate() == Fate::Capture => f64::INFINITY,
            (None, None) => f64::NEG_INFINITY,
        }
    }

    /// Returns the angle at which the ray of `h` meets the radius, and on which branch. Where it meets the radius
    /// twice, `branch` selects one.
    #[inline(always)]
    fn swept(&self, h: f64, branch: Branch) -> Option<(f64, Branch)> {
        let orbit = self.orbit(h);
        let point = self.leg.end(&orbit)?;
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

    /// Returns the limit of `x h` at the pole: as φ → 0, `w φ → u_d − u0` and x ~ φ.
    pub(super) fn at_pole(&self) -> f64 {
        (self.u_disk - self.u0) / self.slope_scale
    }

    /// Returns the point of the curve at `angle`, from a guess of it (see the [module's page](self)).
    pub(super) fn follow(
        &self,
        angle: f64,
        guess: CurveGuess,
        tolerance: SolveTolerance,
    ) -> CurvePoint {
        self.converge(angle, guess, tolerance)
            .unwrap_or_else(|| self.search(angle, guess, tolerance))
    }

    /// Does the same where the branch or the guess is wrong.
    #[cold]
    fn search(&self, angle: f64, guess: CurveGuess, tolerance: SolveTolerance) -> CurvePoint {
        // The two branches meet where rays graze the radius. Neighbouring points may lie on either side.
        let other = CurveGuess {
            branch: guess.branch.other(),
            ..guess
        };
        if let Some(found) = self.converge(angle, other, tolerance) {
            return found;
        }
        let h = if guess.h.is_finite() {
            guess.h
        } else {
            self.first_guess(angle)
        };
        let (h, slope) = self.bracket(angle, h, 1e-4);
        // The bracket's slope is dh over the residual. On the way out the swept angle rises with the residual, on the
        // way in it falls.
        for CurveGuess { branch, .. } in [guess, other] {
            for slope in [slope, -slope] {
                let guess = CurveGuess {
                    h,
                    slope,
                    blur: f64::INFINITY,
                    branch,
                };
                if let Some(found) = self.converge(angle, guess, tolerance) {
                    return found;
                }
            }
        }
        CurvePoint {
            h: self.bracket(angle, h, 1e-13).0,
            slope: f64::NAN,
            branch: guess.branch,
        }
    }

    /// Takes a Newton step with the guess's slope, and secant steps after it. Returns `None` if they do not converge.
    #[inline(always)]
    fn converge(
        &self,
        angle: f64,
        guess: CurveGuess,
        tolerance: SolveTolerance,
    ) -> Option<CurvePoint> {
        /// Secants that have not converged by then will not.
        const STEPS: usize = 8;
        let CurveGuess {
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
            // An angle of one radian is `1 + κ²` in h. The lesser |κ| of the two is the safe choice.
            let kappa = (self.critical + h).abs().min((self.critical + next).abs());
            // Far from the curve all rays are nearly straight, and the estimates below would be too small.
            let is_near =
                next.is_finite() && doubt <= 0.25 * slope.abs() && missing.abs() <= 0.25 * angle;
            let is_close = left <= tolerance.psi * (1.0 + kappa * kappa)
                || left <= tolerance.phi * slope.abs()
                || (last.is_some() && step.abs() <= 1e-13 * h.abs());
            if is_near && is_close {
                return Some(CurvePoint {
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

    /// Returns the h of the ray that meets the radius at `angle`, to the relative error `close`, and dh over the
    /// residual.
    ///
    /// Secant steps are kept within the bracket that the residuals' signs have shown so far. Where the secant leaves it
    /// or the residual is infinite, the bracket is halved, or the stride grows while one end is unknown.
    fn bracket(&self, angle: f64, guess: f64, close: f64) -> (f64, f64) {
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
                // A step that changes nothing is the answer, within the bracket or not.
                (next.is_finite() && ((next > low && next < high) || next == h)).then_some(next)
            });
            // Every eighth step halves the bracket, in case the secant converges slowly.
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
            // Where a ray grazes the radius the residual behaves like a square root, and the secant's error is as large
            // as its step.
            let bracketed = high - low <= 4.0 * f64::EPSILON * h.abs();
            if (secant == Some(next) && change <= close * h.abs()) || bracketed {
                break;
            }
        }
        (h, slope)
    }
}

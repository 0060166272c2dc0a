//! Integration in steps of one length.

use super::crossings::{CrossingSearch, EventLog, MonotonePiece};
use super::flight::{
    DEFAULT_MAX_STEPS, Departure, Flight, State, Step, acceleration, depart, opposite,
};
use crate::orbit::events::{Event, Orbits, TurningPoint, WatchedRadius};
use crate::orbit::ray::{OrbitError, Ray, within_flight};

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// Euler's method, of order 1; crossings by linear interpolation.
    Euler,
    /// The classical Runge–Kutta method, of order 4; crossings by the Hermite cubic through the step's u and du/dφ at
    /// both ends, whose error is of order 4 too.
    Rk4,
}

/// The orbit equation integrated in steps of one length: what a renderer tries first, and the baseline of all
/// comparisons.
///
/// A ray with `e² = (du/dφ)² + u²(1 − u) > 1/h²` takes steps of 1/e in place of h, so that no step is longer than the
/// way from the horizon to infinity. A step `h` that is not above 0 gives [`OrbitError::StepLimit`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedStep {
    /// How a step is taken.
    pub scheme: Scheme,
    /// The length of a step in φ, in radians; 0.02 is typical.
    pub h: f64,
    /// The number of steps after which [`OrbitError::StepLimit`] is returned.
    pub max_steps: u64,
}

impl FixedStep {
    /// Integrates in steps of `h` radians, at most 100,000 of them.
    pub fn new(scheme: Scheme, h: f64) -> Self {
        Self {
            scheme,
            h,
            max_steps: DEFAULT_MAX_STEPS,
        }
    }

    /// Returns the length of each step of a ray that starts at `from`.
    fn step_length(&self, from: State) -> Result<f64, OrbitError> {
        if self.h.is_nan() || self.h <= 0.0 {
            return Err(OrbitError::StepLimit {
                steps: 0,
                angle: 0.0,
            });
        }
        let e = (from.w * from.w + from.u * from.u * (1.0 - from.u)).sqrt();
        Ok(self.h.min(1.0 / e))
    }

    #[inline]
    fn fly_by<'a, L: EventLog>(
        &self,
        step: impl Fn(State, f64) -> State,
        pass_step: impl Fn(&mut CrossingSearch<'a, L>, &Step) -> bool,
        ray: Ray,
        watched: &'a [WatchedRadius],
        log: L,
    ) -> Result<CrossingSearch<'a, L>, OrbitError> {
        let (mut from, mut crossings) = match depart(ray, watched, log) {
            Departure::Done(crossings) => return Ok(crossings),
            Departure::Bound(state, crossings) => (state, crossings),
        };
        let h = self.step_length(from)?;
        for taken in 0..self.max_steps {
            let to = step(from, h);
            let uneventful = crossings.clear_until(to.u) && from.w * to.w > 0.0;
            if !uneventful
                && pass_step(
                    &mut crossings,
                    &Step {
                        from,
                        to,
                        h,
                        angle: taken as f64 * h,
                    },
                )
            {
                return Ok(crossings);
            }
            from = to;
        }
        Err(OrbitError::StepLimit {
            steps: self.max_steps,
            angle: self.max_steps as f64 * h,
        })
    }
}

impl Flight for FixedStep {
    fn fly<'a, L: EventLog>(
        &self,
        ray: Ray,
        watched: &'a [WatchedRadius],
        log: L,
    ) -> Result<CrossingSearch<'a, L>, OrbitError> {
        match self.scheme {
            Scheme::Euler => self.fly_by(euler, pass_line, ray, watched, log),
            Scheme::Rk4 => self.fly_by(rk4, pass_cubic, ray, watched, log),
        }
    }

    /// The last step is as much shorter as it has to be.
    fn fly_for(&self, start: State, angle: f64) -> Result<Option<State>, OrbitError> {
        let h = self.step_length(start)?;
        let mut state = start;
        for taken in 0..self.max_steps {
            let left = angle - taken as f64 * h;
            let length = left.min(h);
            state = match self.scheme {
                Scheme::Euler => euler(state, length),
                Scheme::Rk4 => rk4(state, length),
            };
            if !within_flight(state.u) {
                return Ok(None);
            }
            if left <= h {
                return Ok(Some(state));
            }
        }
        Err(OrbitError::StepLimit {
            steps: self.max_steps,
            angle: self.max_steps as f64 * h,
        })
    }
}

impl Orbits for FixedStep {
    fn follow(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        self.all_events(ray, radii)
    }

    fn turning_point(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        self.turn(ray)
    }

    fn first_crossing(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        self.first_event(ray, radius)
    }

    fn u_at_angle(&self, ray: Ray, angle: f64) -> Result<Option<f64>, OrbitError> {
        self.u_after(ray, angle)
    }
}

#[inline]
pub(super) fn euler(at: State, h: f64) -> State {
    State {
        u: at.u + h * at.w,
        w: at.w + h * acceleration(at.u),
    }
}

/// Takes a step of the classical method with its slopes of u written out. Since `dw/dφ` depends on u alone, its four
/// stages have the form of Nyström (Hairer, Nørsett & Wanner, *Solving Ordinary Differential Equations I*, §II.14), and
/// two of them can be computed at the same time.
#[inline]
pub(super) fn rk4(State { u, w }: State, h: f64) -> State {
    let half = 0.5 * h;
    let middle = u + half * w;
    let end = u + h * w;
    let a1 = acceleration(u);
    let a2 = acceleration(middle);
    let a3 = acceleration(middle + (half * half) * a1);
    let a4 = acceleration(end + (half * h) * a2);
    let inner = a2 + a3;
    State {
        u: end + (h * h / 6.0) * (a1 + inner),
        w: w + (h / 6.0) * ((a1 + a4) + 2.0 * inner),
    }
}

/// Reports the events on a step of Euler's method, a straight line. Returns whether the flight ends on it.
fn pass_line<L: EventLog>(crossings: &mut CrossingSearch<'_, L>, step: &Step) -> bool {
    let Step { from, to, h, angle } = *step;
    // The polygon turns at its corners: where du/dφ changes sign over the step, u still follows the first sign.
    let piece = MonotonePiece {
        from: from.u,
        to: to.u,
        inward: from.w > 0.0,
        turns: opposite(from.w, to.w) || to.w == 0.0,
    };
    if piece.turns {
        crossings.turn(to.u, angle + h);
    }
    crossings.pass(piece, |u| angle + h * ((u - from.u) / (to.u - from.u)))
}

/// Reports the events on a step of the Runge–Kutta method, on its cubic. Returns whether the flight ends on it.
fn pass_cubic<L: EventLog>(crossings: &mut CrossingSearch<'_, L>, step: &Step) -> bool {
    let cubic = HermiteCubic::new(step);
    step.pass(crossings, step.from.u, |x| cubic.at(x))
}

/// `u − u_from = c₁x + c₂x² + c₃x³` at angle x from a step's start, with the step's u and du/dφ at both ends.
struct HermiteCubic {
    c1: f64,
    c2: f64,
    c3: f64,
}

impl HermiteCubic {
    fn new(step: &Step) -> Self {
        let Step { from, to, h, .. } = *step;
        let mean = (to.u - from.u) / h;
        Self {
            c1: from.w,
            c2: (3.0 * mean - 2.0 * from.w - to.w) / h,
            c3: (from.w + to.w - 2.0 * mean) / (h * h),
        }
    }

    /// Returns `u − u_from` and its two derivatives at x.
    fn at(&self, x: f64) -> [f64; 3] {
        [
            x * (self.c1 + x * (self.c2 + x * self.c3)),
            self.c1 + x * (2.0 * self.c2 + x * 3.0 * self.c3),
            2.0 * self.c2 + x * 6.0 * self.c3,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::EventKind;
    use crate::orbit::integrate::Adaptive;

    const RADII: [f64; 2] = [4.0, 8.0];

    /// Worst error over the events of a scattered, a captured and a trapped ray, against the adaptive method.
    fn worst_error(scheme: Scheme, h: f64) -> f64 {
        let truth = Adaptive::new(1e-13);
        let mut worst = 0.0_f64;
        for (u, w) in [(0.05, 0.29), (0.01, 0.45), (0.8, -0.05)] {
            let ray = Ray::new(u, w).unwrap();
            let stepped = FixedStep::new(scheme, h).follow(ray, &RADII).unwrap();
            let exact = truth.follow(ray, &RADII).unwrap();
            assert_eq!(stepped.len(), exact.len(), "{stepped:?} {exact:?}");
            for (a, b) in stepped.iter().zip(&exact) {
                assert_eq!((a.kind, a.radius), (b.kind, b.radius));
                worst = worst.max((a.angle - b.angle).abs());
            }
        }
        worst
    }

    #[test]
    fn euler_converges_with_order_one() {
        let order = libm::log2(worst_error(Scheme::Euler, 2e-3) / worst_error(Scheme::Euler, 1e-3));
        assert!((0.9..1.1).contains(&order), "{order}");
    }

    #[test]
    fn rk4_converges_with_order_four_crossings_included() {
        for h in [0.08, 0.04] {
            let (coarse, fine) = (
                worst_error(Scheme::Rk4, h),
                worst_error(Scheme::Rk4, 0.5 * h),
            );
            let order = libm::log2(coarse / fine);
            assert!(
                (3.5..4.7).contains(&order),
                "order {order}: {coarse:e} and {fine:e} at h = {h}"
            );
        }
    }

    #[test]
    fn rk4_finds_a_graze_inside_one_step() {
        // With periapsis 1e-6 inside radius 5 the ray stays within for some 2.5e-3 rad, an eighth of a step.
        let (u_p, u_0): (f64, f64) = (0.2 * (1.0 + 1e-6), 0.1);
        let w = (u_p * u_p * (1.0 - u_p) - u_0 * u_0 * (1.0 - u_0)).sqrt();
        let events = FixedStep::new(Scheme::Rk4, 0.02)
            .follow(Ray::new(u_0, w).unwrap(), &[5.0])
            .unwrap();
        let [inbound, outbound, _] = events[..] else {
            panic!("{events:?}")
        };
        assert_eq!(
            (inbound.kind, outbound.kind),
            (EventKind::Inbound, EventKind::Outbound)
        );
        let apart = outbound.angle - inbound.angle;
        // Half the time within is √(2·2e-7/|u̇̇|), with u̇̇ = 3/2 u² − u = −0.14.
        let expected = 2.0 * (4e-7_f64 / 0.14).sqrt();
        assert!(
            (apart / expected - 1.0).abs() < 0.02,
            "{apart} for {expected}"
        );
    }

    #[test]
    fn a_useless_step_is_an_error() {
        let ray = Ray::new(0.05, 0.2).unwrap();
        for h in [0.0, -0.02, f64::NAN] {
            let answer = FixedStep::new(Scheme::Rk4, h).follow(ray, &[]);
            assert!(
                matches!(answer, Err(OrbitError::StepLimit { steps: 0, .. })),
                "h = {h}: {answer:?}"
            );
        }
    }
}

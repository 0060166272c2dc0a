//! Integration in steps as long as an error estimate allows.

use super::crossings::{CrossingSearch, EventLog};
use super::dop853;
use super::flight::{
    DEFAULT_MAX_STEPS, Departure, Flight, State, Step, acceleration, depart, opposite,
};
use crate::orbit::events::{Event, Orbits, TurningPoint, WatchedRadius};
use crate::orbit::ray::{OrbitError, Ray, within_flight};

/// The orbit equation integrated with the Runge–Kutta method DOP853 in steps that keep each swept angle's error below
/// a tolerance.
///
/// Crossings and turning points are not interpolated: the step is taken again from its start, with the length at which
/// u is the radius (or du/dφ is 0), found by Newton's method.
///
/// # Accuracy
/// `tolerance` bounds the error of every angle below 10 radians (up to the rounding of the ray's two numbers, which
/// changes the angle by some 2⁻⁵² times |∂angle/∂ln dudphi| + |∂angle/∂ln u0|). More than 1e-3 radians counts as 1e-3;
/// from 1e-10 down the steps are as short as rounding makes worthwhile. Beyond 10 radians, near the photon sphere,
/// errors grow as e^angle, and a ray a few units in the last place from critical may end on the wrong side. Whether a
/// ray crosses a radius is not certain where its turning point comes within a share of 1e-5 `tolerance` of it.
///
/// ```
/// use darkness::orbit::{EventKind, Fate, Orbits, Ray, integrate::Adaptive};
///
/// let ray = Ray::new(1.0 / 30.0, 0.1)?;
/// let events = Adaptive::default().follow(ray, &[12.0])?;
/// let kinds: Vec<_> = events.iter().map(|event| event.kind).collect();
/// assert_eq!(kinds, [EventKind::Inbound, EventKind::Outbound, EventKind::End(Fate::Escape)]);
/// # Ok::<(), darkness::orbit::OrbitError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// The error allowed in a swept angle, in radians.
    pub tolerance: f64,
    /// The number of steps, refused ones included, after which [`OrbitError::StepLimit`] is returned.
    pub max_steps: u64,
}

/// The error allowed in one step relative to hypot(u, w), as a share of the tolerance.
///
/// Near the photon sphere, the phase plane's saddle with eigenvalues ±1, an error grows as e^φ, by e¹⁰ = 2.2e4 in ten
/// radians. The steps' errors add up to at most e¹⁰/(e^h − 1) times that of the first, which is three times e¹⁰ for
/// steps of h ≈ 0.3. 1/6e4 is rounded down to this.
const STEP_SHARE: f64 = 1e-5;

/// The smallest error of a step worth asking for: five units in the last place. Below it the step's own rounding is
/// larger.
const FINEST: f64 = 1e-15;

/// The largest error of a step allowed. The estimate is valid only where it is small.
const COARSEST: f64 = 1e-8;

/// The length of the first step where du/dφ is moderate. The first error estimate corrects it.
const FIRST_STEP: f64 = 0.1;

/// The longest step. From periapsis to infinity a ray sweeps more than π/2, and [`LONGEST_FALL`] stops it soon beyond,
/// so that du/dφ never changes sign twice in one step, which would hide both turns.
const LONGEST_STEP: f64 = 0.5;

/// The largest change of u in one step, to first order. The whole flight changes u by less than 1, and far beyond its
/// ends the equation's u² runs away, to its next turning point (u < 0) or to infinity (u > 1).
const LONGEST_FALL: f64 = 0.5;

impl Adaptive {
    /// Integrates to `tolerance` radians in at most 100,000 steps.
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            max_steps: DEFAULT_MAX_STEPS,
        }
    }

    /// Returns the error allowed in one step, relative to hypot(u, w).
    fn step_error(&self) -> f64 {
        (STEP_SHARE * self.tolerance.max(0.0)).clamp(FINEST, COARSEST)
    }
}

impl Default for Adaptive {
    /// A tolerance of 1e-9 radians.
    fn default() -> Self {
        Self::new(1e-9)
    }
}

impl Orbits for Adaptive {
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

impl Flight for Adaptive {
    fn fly<'a, L: EventLog>(
        &self,
        ray: Ray,
        watched: &'a [WatchedRadius],
        log: L,
    ) -> Result<CrossingSearch<'a, L>, OrbitError> {
        let (mut state, mut crossings) = match depart(ray, watched, log) {
            Departure::Done(crossings) => return Ok(crossings),
            Departure::Bound(state, crossings) => (state, crossings),
        };
        let allowed = self.step_error();
        let mut angle = 0.0;
        let mut h = FIRST_STEP;
        for _ in 0..self.max_steps {
            h = h.min(LONGEST_STEP).min(LONGEST_FALL / state.w.abs());
            let (next, error) = dop853::step_with_error(state, h);
            let factor = step_factor(error, allowed);
            if error > allowed {
                h *= factor;
                continue;
            }
            let turns = opposite(state.w, next.w) || next.w == 0.0;
            let eventful = turns || !crossings.clear_until(next.u);
            let step = Step {
                from: state,
                to: next,
                h,
                angle,
            };
            if eventful && pass_step(&mut crossings, &step) {
                return Ok(crossings);
            }
            angle += h;
            state = next;
            h *= factor;
        }
        Err(OrbitError::StepLimit {
            steps: self.max_steps,
            angle,
        })
    }

    fn fly_for(&self, start: State, angle: f64) -> Result<Option<State>, OrbitError> {
        let allowed = self.step_error();
        let (mut state, mut left) = (start, angle);
        let mut h = FIRST_STEP;
        for _ in 0..self.max_steps {
            h = h.min(LONGEST_STEP).min(LONGEST_FALL / state.w.abs());
            let taken = h.min(left);
            let (next, error) = dop853::step_with_error(state, taken);
            if error <= allowed {
                if !within_flight(next.u) {
                    return Ok(None);
                }
                if taken == left {
                    return Ok(Some(next));
                }
                state = next;
                left -= taken;
            }
            h = taken * step_factor(error, allowed);
        }
        Err(OrbitError::StepLimit {
            steps: self.max_steps,
            angle: angle - left,
        })
    }
}

/// Returns by how much the next step is longer than one with this error. The estimate falls as h⁸. 0.9 is the usual
/// allowance for its own error (Hairer, Nørsett & Wanner, §II.4), and the bounds limit the effect of one odd estimate.
fn step_factor(error: f64, allowed: f64) -> f64 {
    (0.9 / (error / allowed).sqrt().sqrt().sqrt()).clamp(0.2, 4.0)
}

/// Reports the events on a step. Returns whether the flight ends on it.
fn pass_step<L: EventLog>(crossings: &mut CrossingSearch<'_, L>, step: &Step) -> bool {
    step.pass(crossings, 0.0, |x| {
        let State { u, w } = dop853::step(step.from, x);
        [u, w, acceleration(u)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::{EventKind, Fate};

    /// The critical ray's swept angle between two radii, from `u = tanh²(φ/2) − 1/3` (Chandrasekhar, §20).
    fn critical_angle(u_from: f64, u_to: f64) -> f64 {
        let phase = |u: f64| 2.0 * libm::atanh((u + 1.0 / 3.0).sqrt());
        phase(u_to) - phase(u_from)
    }

    fn critical_ray(u: f64) -> Ray {
        Ray::new(u, (2.0 / 3.0 - u) * (u + 1.0 / 3.0).sqrt()).unwrap()
    }

    #[test]
    fn the_critical_ray_passes_radii_at_the_closed_forms_angles() {
        let radii = [10.0, 6.0, 3.0, 2.0, 1.6];
        let events = Adaptive::default()
            .follow(critical_ray(0.01), &radii)
            .unwrap();
        for (event, radius) in events.iter().zip(radii) {
            assert_eq!((event.kind, event.radius), (EventKind::Inbound, radius));
            let error = (event.angle - critical_angle(0.01, 1.0 / radius)).abs();
            assert!(error < 1e-12, "r = {radius}: {error:e}");
        }
    }

    #[test]
    fn the_error_falls_with_the_tolerance() {
        let truth = critical_angle(0.01, 1.0 / 1.6);
        let mut last = f64::INFINITY;
        for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
            let events = Adaptive::new(tolerance)
                .follow(critical_ray(0.01), &[1.6])
                .unwrap();
            let error = (events[0].angle - truth).abs();
            assert!(error <= tolerance, "tolerance {tolerance:e}: {error:e}");
            assert!(
                error < 0.5 * last || error < 1e-14,
                "tolerance {tolerance:e}: {error:e} after {last:e}"
            );
            last = error;
        }
    }

    #[test]
    fn both_crossings_of_a_grazed_radius_are_found_inside_one_step() {
        // From its periapsis a step or less away: the ray of periapsis u_p dips below radius 1/u_d by a hair.
        for hair in [1e-3, 1e-6, 1e-9, 1e-12] {
            let (u_p, u_d) = (0.2 * (1.0 + hair), 0.2);
            let from_periapsis = Ray::new(u_p, 0.0).unwrap();
            let out = Adaptive::default()
                .follow(from_periapsis, &[10.0, 5.0])
                .unwrap();
            let [graze, ten, end] = out[..] else {
                panic!("hair {hair:e}: {out:?}")
            };
            // By the first integral, the slope at radius 10 on the way in.
            let w = (u_p * u_p * (1.0 - u_p) - 0.01 * 0.9).sqrt();
            let both = Adaptive::default()
                .follow(Ray::new(0.1, w).unwrap(), &[1.0 / u_d])
                .unwrap();
            let [inbound, outbound, _] = both[..] else {
                panic!("hair {hair:e}: {both:?}")
            };
            assert_eq!(
                (inbound.kind, outbound.kind),
                (EventKind::Inbound, EventKind::Outbound)
            );
            // The flight is symmetric about periapsis. A rounding δ of u moves a crossing by δ/|w| at the radius.
            let slope = (hair * u_d * u_d * (2.0 - 3.0 * u_d)).sqrt();
            let tolerance = 1e-13 + 4e-16 / slope;
            assert!(
                (inbound.angle - (ten.angle - graze.angle)).abs() < tolerance,
                "hair {hair:e}"
            );
            assert!(
                (outbound.angle - (ten.angle + graze.angle)).abs() < tolerance,
                "hair {hair:e}"
            );
            assert_eq!(end.kind, EventKind::End(Fate::Escape));
        }
    }

    #[test]
    fn a_radius_just_missed_is_not_crossed() {
        let u_p: f64 = 0.2 * (1.0 - 1e-12);
        let w = (u_p * u_p * (1.0 - u_p) - 0.01 * 0.9).sqrt();
        let events = Adaptive::default()
            .follow(Ray::new(0.1, w).unwrap(), &[5.0])
            .unwrap();
        assert_eq!(events.len(), 1, "{events:?}");
    }

    #[test]
    fn the_photon_sphere_is_left_at_last() {
        // 2/3 is no f64: the ray at its rounding is 4e-17 away, which grows to 1 within about ln(1/4e-17) = 38.
        let events = Adaptive::default()
            .follow(Ray::new(2.0 / 3.0, 0.0).unwrap(), &[])
            .unwrap();
        assert!(
            events[0].angle > 30.0 && events[0].angle < 60.0,
            "{events:?}"
        );
    }

    #[test]
    fn any_tolerance_gives_an_answer() {
        for tolerance in [f64::NAN, -1.0, 0.0, 1e-300, f64::INFINITY] {
            let events = Adaptive::new(tolerance)
                .follow(Ray::new(0.1, 0.2).unwrap(), &[5.0])
                .unwrap();
            assert_eq!(events.len(), 3, "tolerance {tolerance}: {events:?}");
        }
    }
}

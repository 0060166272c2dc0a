//! Direct integration: the orbit equation itself, stepped in the swept angle φ.
//!
//! The equation is `du/dφ = w`, `dw/dφ = 3/2 u² − u` (Chandrasekhar, *The Mathematical Theory of Black Holes*, §20).
//! [`Adaptive`] takes the steps an error estimate asks for and is accurate to a tolerance; [`FixedStep`] takes steps
//! of one length, the plain first attempt that everything faster is measured against. Neither uses the first
//! integral or an elliptic integral, so both are independent checks of the methods that do.
//!
//! Both walk the same way. A step is cut at the turning point inside it, if there is one (no ray has more than one
//! in all its flight), and each monotone piece is searched for the watched radii it passes, in order.

mod adaptive;
mod crossings;
mod disk;
mod dop853;
mod fixed;
mod root;

pub use adaptive::Adaptive;
pub use fixed::{FixedStep, Scheme};

use super::{Event, EventKind, OrbitError, Ray, TurningPoint, WatchedRadius, inverse_radii};
use crossings::{Crossings, Log, Piece};

/// Steps after which a stepped solution gives up, where nothing else is asked for. A ray one unit in the last place
/// from critical winds some 40 radians, which even steps of 0.001 cover in less than half of this.
const DEFAULT_MAX_STEPS: u64 = 100_000;

/// |du/dφ| from which a ray's path is straight in (φ, u) to the last bit. Between the horizon and infinity
/// `w² = e² − u²(1 − u)` varies by no more than 4/27, hence w by a share of 2/(27w²) at most: less than 2⁻⁵⁵ here.
const STRAIGHT: f64 = (1_u64 << 26) as f64;

/// A point of the phase plane.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    /// Inverse radius.
    u: f64,
    /// du/dφ.
    w: f64,
}

/// `d²u/dφ² = 3/2 u² − u`, as `3/2 u (u − 2/3)` with 2/3 in two parts, the second being what the first is rounded by:
/// correct to a few units in its own last place on all sides of the photon sphere, so that this repels even the ray
/// that starts at its rounded place.
#[inline]
fn acceleration(u: f64) -> f64 {
    const HIGH: f64 = 2.0 / 3.0;
    const LOW: f64 = f64::EPSILON / 6.0;
    1.5 * u * ((u - HIGH) - LOW)
}

/// Whether a and b have opposite signs, zero having none.
fn opposite(a: f64, b: f64) -> bool {
    (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)
}

/// What is left of a ray's flight when it is about to be stepped.
enum Departure<'a, L> {
    /// The path is straight: nothing is left to do.
    Done(Crossings<'a, L>),
    /// The state to step from, and the crossings to look for.
    Bound(State, Crossings<'a, L>),
}

/// Prepares a flight: the rays that are straight lines in (φ, u), among them those with infinite du/dφ, whose angles
/// are all 0, are answered here.
fn depart<L: Log>(ray: Ray, watched: &[WatchedRadius], log: L) -> Departure<'_, L> {
    let start = State {
        u: ray.u(),
        w: ray.dudphi(),
    };
    if start.w.abs() >= STRAIGHT {
        let inward = start.w > 0.0;
        let mut crossings = Crossings::new(watched, log, start.u);
        let piece = Piece {
            from: start.u,
            to: if inward { 1.0 } else { 0.0 },
            inward,
            turns: false,
        };
        crossings.pass(piece, |u| (u - start.u).abs() / start.w.abs());
        return Departure::Done(crossings);
    }
    Departure::Bound(start, Crossings::new(watched, log, start.u))
}

/// A method that steps along a flight until its end, or until nothing more is wanted of it.
trait Flight {
    /// Flies past `watched` (by ascending u), noting in `log` what happens.
    ///
    /// # Errors
    /// [`OrbitError::StepLimit`]
    fn fly<'a, L: Log>(
        &self,
        ray: Ray,
        watched: &'a [WatchedRadius],
        log: L,
    ) -> Result<Crossings<'a, L>, OrbitError>;

    /// [`Orbits::follow`](super::Orbits::follow)
    fn all_events(&self, ray: Ray, radii: &[f64]) -> Result<Vec<Event>, OrbitError> {
        let watched = inverse_radii(radii)?;
        // Every radius is passed twice at most.
        let log = Vec::with_capacity(2 * watched.len() + 1);
        self.fly(ray, &watched, log).map(Crossings::into_log)
    }

    /// [`Orbits::first_crossing`](super::Orbits::first_crossing)
    fn first_event(&self, ray: Ray, radius: f64) -> Result<Option<f64>, OrbitError> {
        let watched = [WatchedRadius::new(radius)?];
        let first = self.fly(ray, &watched, None)?.into_log();
        Ok(first.and_then(|event: Event| match event.kind {
            EventKind::Inbound | EventKind::Outbound => Some(event.angle),
            EventKind::End(_) => None,
        }))
    }

    /// [`Orbits::turning_point`](super::Orbits::turning_point)
    fn turn(&self, ray: Ray) -> Result<Option<TurningPoint>, OrbitError> {
        let flight = self.fly(ray, &[], None)?;
        Ok(flight.turning_point())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::{EventKind, Fate, Orbits};

    fn all_methods() -> Vec<(&'static str, Box<dyn Orbits>)> {
        vec![
            ("adaptive", Box::new(Adaptive::default())),
            ("Euler", Box::new(FixedStep::new(Scheme::Euler, 0.001))),
            ("RK4", Box::new(FixedStep::new(Scheme::Rk4, 0.02))),
        ]
    }

    fn story(orbits: &dyn Orbits, u: f64, w: f64) -> Vec<(EventKind, f64)> {
        let events = orbits
            .follow(Ray::new(u, w).unwrap(), &[6.0, 3.0, 12.0, 3.0])
            .unwrap();
        assert!(
            events.iter().all(|event| event.angle >= 0.0),
            "a negative angle in {events:?}"
        );
        assert!(
            events.is_sorted_by(|a, b| a.angle <= b.angle),
            "out of order: {events:?}"
        );
        events
            .iter()
            .map(|event| (event.kind, event.radius))
            .collect()
    }

    const CAPTURE: (EventKind, f64) = (EventKind::End(Fate::Capture), 1.0);
    const ESCAPE: (EventKind, f64) = (EventKind::End(Fate::Escape), f64::INFINITY);

    fn inbound(radius: f64) -> (EventKind, f64) {
        (EventKind::Inbound, radius)
    }

    fn outbound(radius: f64) -> (EventKind, f64) {
        (EventKind::Outbound, radius)
    }

    #[test]
    fn radial_rays_pass_every_radius_in_order() {
        for (name, method) in all_methods() {
            for w in [3.0, 100.0, 1e5, 1e12, f64::MAX, f64::INFINITY] {
                let inward = story(method.as_ref(), 0.01, w);
                assert_eq!(
                    inward,
                    [inbound(12.0), inbound(6.0), inbound(3.0), CAPTURE],
                    "{name}, w = {w:e}"
                );
                let outward = story(method.as_ref(), 0.9, -w);
                assert_eq!(
                    outward,
                    [outbound(3.0), outbound(6.0), outbound(12.0), ESCAPE],
                    "{name}, w = {w:e}"
                );
            }
        }
    }

    #[test]
    fn the_first_crossing_is_the_first_of_all() {
        for (name, method) in all_methods() {
            for (u, w) in [
                (0.05, 0.29),
                (0.01, 0.45),
                (0.3, -0.2),
                (0.8, -0.05),
                (0.1, 1e9),
            ] {
                let ray = Ray::new(u, w).unwrap();
                for radius in [1.2, 3.0, 6.0, 12.0] {
                    let events = method.follow(ray, &[radius]).unwrap();
                    let first = (events.len() > 1).then(|| events[0].angle);
                    let found = method.first_crossing(ray, radius).unwrap();
                    assert_eq!(found, first, "{name}, {ray:?} at r = {radius}");
                }
            }
        }
    }

    #[test]
    fn infinite_slope_sweeps_no_angle() {
        for (name, method) in all_methods() {
            for w in [f64::INFINITY, f64::NEG_INFINITY] {
                let events = method
                    .follow(Ray::new(0.2, w).unwrap(), &[2.0, 10.0])
                    .unwrap();
                assert_eq!(events.len(), 2, "{name}");
                assert!(
                    events.iter().all(|event| event.angle == 0.0),
                    "{name}: {events:?}"
                );
            }
        }
    }

    #[test]
    fn a_ray_at_its_turning_point_goes_where_the_equation_sends_it() {
        for (name, method) in all_methods() {
            for w in [0.0, -0.0, 5e-324, -5e-324] {
                let out = story(method.as_ref(), 0.5, w);
                assert_eq!(
                    out,
                    [outbound(3.0), outbound(6.0), outbound(12.0), ESCAPE],
                    "{name}, w = {w:e}"
                );
                assert_eq!(
                    story(method.as_ref(), 0.7, w),
                    [CAPTURE],
                    "{name}, w = {w:e}"
                );
            }
        }
    }

    #[test]
    fn the_start_is_no_crossing_but_coming_back_through_it_is() {
        for (name, method) in all_methods() {
            let u = 1.0 / 6.0;
            let there_and_back = story(method.as_ref(), u, 0.05);
            assert_eq!(
                there_and_back,
                [outbound(6.0), outbound(12.0), ESCAPE],
                "{name}"
            );
            assert_eq!(
                story(method.as_ref(), u, -0.05),
                [outbound(12.0), ESCAPE],
                "{name}"
            );
            assert_eq!(
                story(method.as_ref(), u, 0.0),
                [outbound(12.0), ESCAPE],
                "{name}"
            );
        }
    }

    #[test]
    fn the_faintest_orbits_end_too() {
        for (name, method) in all_methods() {
            for u in [1e-100, 1e-60, 1e-30] {
                // So far out space is flat: from its periapsis a ray sweeps a right angle.
                let events = method.follow(Ray::new(u, 0.0).unwrap(), &[3.0]).unwrap();
                let [end] = events[..] else {
                    panic!("{name}, u = {u:e}: {events:?}")
                };
                let error = (end.angle - core::f64::consts::FRAC_PI_2).abs();
                assert!(error < 1e-3, "{name}, u = {u:e}: {end:?}");
            }
        }
    }

    #[test]
    fn a_radius_inside_the_horizon_is_refused() {
        for (name, method) in all_methods() {
            for radius in [1.0, 0.5, -3.0, f64::INFINITY, f64::NAN] {
                let answer = method.follow(Ray::new(0.1, 0.1).unwrap(), &[radius]);
                assert!(
                    matches!(answer, Err(OrbitError::Radius { .. })),
                    "{name}, radius {radius}: {answer:?}"
                );
            }
        }
    }

    #[test]
    fn too_few_steps_are_an_error_that_says_how_far_it_came() {
        let ray = Ray::new(0.1, 0.2).unwrap();
        let adaptive = Adaptive {
            max_steps: 3,
            ..Adaptive::default()
        };
        let fixed = FixedStep {
            max_steps: 3,
            ..FixedStep::new(Scheme::Rk4, 0.02)
        };
        assert!(
            matches!(adaptive.follow(ray, &[]), Err(OrbitError::StepLimit { steps: 3, angle }) if angle > 0.0)
        );
        assert_eq!(
            fixed.follow(ray, &[]),
            Err(OrbitError::StepLimit {
                steps: 3,
                angle: 0.06
            })
        );
    }
}

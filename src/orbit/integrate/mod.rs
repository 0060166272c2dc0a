//! Direct integration: the orbit equation itself, stepped in the swept angle φ.
//!
//! The equation is `du/dφ = w`, `dw/dφ = 3/2 u² − u` (Chandrasekhar, *The Mathematical Theory of Black Holes*, §20).
//! [`Adaptive`] takes steps as long as an error estimate allows, to a tolerance. [`FixedStep`] takes steps of one
//! length: the plain first attempt that everything faster is compared with. Neither uses the first integral or an
//! elliptic integral, so that both are independent checks of the methods that do.
//!
//! Both cut a step at the turning point within it, if there is one (no ray has more than one in its whole flight), and
//! search each monotone piece for the watched radii that it passes, in order.

mod adaptive;
mod crossings;
mod disk;
mod dop853;
mod fixed;
mod flight;
mod root;

pub use adaptive::Adaptive;
pub use fixed::{FixedStep, Scheme};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::{EventKind, Fate, OrbitError, Orbits, Ray};

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

//! Guards against paths whose points are wrong, not on the ray, or not where they should be along it.

use darkness::orbit::exact::Exact;
use darkness::orbit::{ArcPoint, OrbitError, Orbits, Ray, TurningPoint, arc_points};

use crate::natural::critical_slope;

/// The largest error of a radius, in Schwarzschild radii.
const ALLOWED: f64 = 1e-9;

/// Points known to 20 digits, by Taylor series of the orbit equation with 75 digits: u0, dudphi, phi and r.
fn reference_points() -> Vec<[f64; 4]> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/paths.csv");
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("u0,dudphi,phi,r"));
    let row = |line: &str| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|field| field.parse().unwrap())
            .collect();
        numbers.try_into().unwrap()
    };
    lines.map(row).collect()
}

#[test]
fn radii_at_given_angles_are_right_over_ten_windings() {
    let mut longest: f64 = 0.0;
    for [u0, dudphi, phi, r] in reference_points() {
        let ray = Ray::new(u0, dudphi).unwrap();
        let u = Exact.u_at_angle(ray, phi).unwrap().unwrap();
        let error = (1.0 / u - r).abs();
        assert!(error <= ALLOWED, "{ray:?} at {phi}: {error:e}");
        longest = longest.max(phi);
    }
    assert!(longest > 10.0 * std::f64::consts::TAU, "only {longest}");
}

/// Rays of all families and both directions, some of them near critical, steep or far away.
fn rays() -> Vec<Ray> {
    let mut rays = Vec::new();
    for u in [1e-5, 0.01, 0.1, 0.5, 0.66, 0.67, 0.9, 0.999] {
        for share in [0.0, 0.5, 0.99, 1.0 - 1e-12, 1.0 + 1e-12, 1.1, 30.0, 1e9] {
            for sign in [1.0, -1.0] {
                rays.push(Ray::new(u, sign * share * critical_slope(u)).unwrap());
            }
        }
        rays.push(Ray::new(u, f64::INFINITY).unwrap());
        rays.push(Ray::new(u, f64::NEG_INFINITY).unwrap());
    }
    let reference = reference_points();
    rays.extend(
        reference
            .iter()
            .map(|&[u0, dudphi, ..]| Ray::new(u0, dudphi).unwrap()),
    );
    rays.dedup();
    rays
}

/// Tells the turning point apart from points about it that have the same u.
fn is(turning: TurningPoint) -> impl Fn(&ArcPoint) -> bool {
    move |point| (point.angle, point.u) == (turning.angle, turning.u)
}

fn farthest(ray: Ray) -> f64 {
    (2.0 / ray.u()).max(30.0)
}

#[test]
fn points_of_a_path_are_on_the_ray_and_so_are_its_ends_and_its_turning_point() {
    for ray in rays() {
        let to = farthest(ray);
        let points = arc_points(ray, 60, to).unwrap();
        assert_eq!(points.len(), 60);
        assert_eq!(
            points[0],
            ArcPoint {
                angle: 0.0,
                u: ray.u()
            }
        );
        let end = *points.last().unwrap();
        assert!(end.u == 1.0 || end.u == 1.0 / to, "{ray:?}: {end:?}");
        assert!(
            points.windows(2).all(|pair| pair[0].angle <= pair[1].angle),
            "{ray:?}"
        );
        if let Some(turning) = Exact.turning_point(ray).unwrap() {
            assert!(points.iter().any(is(turning)), "{ray:?}");
            // No periapsis is inside the photon sphere, no apoapsis outside.
            let outside = ray.u() < 2.0 / 3.0;
            let radius = 1.0 / turning.u;
            let right = if outside {
                radius >= 1.5
            } else {
                radius <= 1.5
            };
            assert!(right, "{ray:?}: {turning:?}");
        }
        for ArcPoint { angle, u } in points {
            if angle == 0.0 || angle == end.angle {
                continue;
            }
            let found = Exact.u_at_angle(ray, angle).unwrap();
            let found = found.unwrap_or_else(|| panic!("{ray:?} at {angle} has ended"));
            // A rounding of the angle moves a far point by |du/dφ| r² times it. Near critical, the angle is a
            // difference of longer ones.
            let rounding =
                64.0 * f64::EPSILON * (1.0 + angle) * ray.impact_parameter().recip() / (u * u);
            let error = (1.0 / found - 1.0 / u).abs();
            assert!(error <= ALLOWED + rounding, "{ray:?} at {angle}: {error:e}");
        }
    }
}

/// The chords of many points: all of them on one side of the turning point have the same length, up to the square of
/// the angle that the path turns from one to the next.
#[test]
fn points_of_a_path_are_equally_spaced() {
    // Points of farther rays are so far apart that a chord tells nothing.
    for ray in rays().into_iter().filter(|ray| ray.u() >= 0.01) {
        let points = arc_points(ray, 4000, farthest(ray)).unwrap();
        let turning = Exact.turning_point(ray).unwrap();
        let middle = turning.and_then(|turning| points.iter().position(is(turning)));
        let (before, after) = points.split_at(middle.unwrap_or(0));
        // The turning point belongs to both sides.
        let before = [before, &after[..1]].concat();
        for side in [&before, after] {
            let chord = |pair: &[ArcPoint]| {
                let (near, far) = (pair[0].radius(), pair[1].radius());
                let half = libm::sin(0.5 * (pair[1].angle - pair[0].angle));
                libm::hypot(far - near, 2.0 * half * (near * far).sqrt())
            };
            let chords: Vec<f64> = side.windows(2).map(chord).collect();
            let Some(longest) = chords.iter().copied().reduce(f64::max) else {
                continue;
            };
            // A path's curvature, 3/2 u⁵/(u² + w²)^{3/2}, is at most 3/2. A chord is shorter than its arc by a share of
            // the square of the bend over 24. Far points are rounded.
            let bend = 1.5 * longest;
            let allowed = longest * bend * bend / 24.0 + 1e-11 / ray.u();
            let shortest = chords.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(
                longest - shortest <= allowed,
                "{ray:?}: {shortest} to {longest}"
            );
        }
    }
}

#[test]
fn paths_that_do_not_lead_out_through_their_end_are_refused() {
    let outward = Ray::new(0.1, -0.01).unwrap();
    let passing = Ray::from_impact_parameter(30.0, 20.0).unwrap();
    for (ray, to) in [
        (outward, 5.0),
        (outward, 10.0),
        (passing, 10.0),
        (passing.reversed(), 30.0),
    ] {
        let refused = Err(OrbitError::NotThrough { radius: to });
        assert_eq!(arc_points(ray, 10, to), refused);
        assert!(arc_points(ray, 10, 40.0).is_ok());
    }
    // A path that falls in ends at the horizon, wherever an escaping one would end.
    let falling = Ray::from_impact_parameter(30.0, 1.0).unwrap();
    assert_eq!(arc_points(falling, 10, 5.0), arc_points(falling, 10, 50.0));
    for to in [1.0, 0.0, -3.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(arc_points(falling, 10, to), Err(OrbitError::Radius { .. })),
            "{to}"
        );
    }
}

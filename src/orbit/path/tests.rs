use std::sync::atomic::{AtomicU32, Ordering};

use super::*;
use crate::orbit::exact::Exact;
use crate::orbit::invariants::critical_slope;

/// The exact method, which counts the angles asked of it.
#[derive(Default)]
struct Counted(AtomicU32);

impl Counted {
    /// Returns the count, and begins again.
    fn take(&self) -> u32 {
        self.0.swap(0, Ordering::Relaxed)
    }
}

impl SweptAngles for Counted {
    fn direct(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed);
        Exact.direct(orbit, from, to)
    }

    fn around(&self, orbit: &Orbit, from: OrbitPoint, to: OrbitPoint) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed);
        Exact.around(orbit, from, to)
    }

    fn error(&self) -> f64 {
        Exact.error()
    }
}

/// Orbits of all families that start on both sides of the photon sphere, inward and outward, ordinary and so near to
/// critical that only their Δ tells them apart.
fn orbits() -> Vec<Orbit> {
    let mut orbits = Vec::new();
    for u in [1e-6, 0.03, 0.3, 0.5, 0.66, 0.7, 0.9] {
        for sign in [-1.0, 1.0] {
            for share in [0.0, 0.3, 0.9, 0.999, 1.001, 1.2, 3.0] {
                let w = sign * share * critical_slope(u);
                orbits.push(Orbit::new(Ray::new(u, w).unwrap()));
            }
            for exponent in [8, 14, 20, 30, 40, 60, 100, 300] {
                for delta in [-1.0, 1.0] {
                    let delta = delta * libm::pow(10.0, -f64::from(exponent));
                    let s = critical_slope(u);
                    orbits.push(Orbit::with_delta(u, sign * (s * s + delta).sqrt(), delta));
                }
            }
        }
    }
    orbits
}

/// Both branches of an orbit, with the angle to the inverse radius `u` on each that reaches it.
fn crossed(orbit: &Orbit, u: f64) -> Vec<(f64, Branch, f64)> {
    let Some(point) = orbit.point_at(u) else {
        return Vec::new();
    };
    let mut crossed = Vec::new();
    if ahead(orbit, u) {
        crossed.push((u, Branch::Direct, Exact.direct(orbit, orbit.start, point)));
    }
    if turns(orbit) {
        crossed.push((u, Branch::Around, Exact.around(orbit, orbit.start, point)));
    }
    crossed
}

fn radii() -> impl Iterator<Item = f64> {
    (1..80)
        .map(|k| f64::from(k) / 80.0)
        .chain([1e-7, 0.66, 0.666, 0.6667, 0.67, 0.9999])
}

/// What rounding the angle, and a few roundings of the swept angle, do to u. Between two points near critical the exact
/// method subtracts their angles to the turning point, each up to ½ |ln |Δ|| longer.
fn allowed(orbit: &Orbit, u: f64, angle: f64) -> f64 {
    let slope = orbit.point_at(u).unwrap_or(orbit.end()).slope;
    let legs = 1.0 + angle - libm::log(orbit.delta.abs()).min(0.0);
    8.0 * f64::EPSILON * (u + slope * legs)
}

#[test]
fn points_at_an_angle_invert_the_swept_angle() {
    let mut count = 0;
    for orbit in orbits() {
        for (u, branch, angle) in radii().flat_map(|u| crossed(&orbit, u)) {
            let (found, on) = point_at_angle(&Exact, &orbit, angle, None)
                .unwrap_or_else(|| panic!("{orbit:?} to {u} at {angle} has ended"));
            let error = (found - u).abs();
            assert!(
                error <= allowed(&orbit, u, angle),
                "{error:e}: {found}, not {u} at {angle}, {orbit:?}"
            );
            assert!(
                on == branch || orbit.point_at(u).unwrap().slope < 1e-6,
                "{orbit:?}, {u}"
            );
            count += 1;
        }
    }
    assert!(count > 10_000, "{count}");
}

/// A guess changes the answer by rounding only, whatever it is; a good one costs one swept angle, and one more on
/// the wrong branch.
#[test]
fn a_good_guess_costs_one_angle_and_a_bad_one_does_no_harm() {
    let counted = Counted::default();
    let mut good = 0;
    for orbit in orbits() {
        for (u, branch, angle) in radii().step_by(7).flat_map(|u| crossed(&orbit, u)) {
            for guessed in [u, 0.98 * u, 1.02 * u, 0.1, 0.64, 0.7, 1.5, -1.0, f64::NAN] {
                for taken in [branch, branch.other()] {
                    let guess = Some((guessed, taken));
                    counted.take();
                    let found = point_at_angle(&counted, &orbit, angle, guess);
                    let (found, _) = found
                        .unwrap_or_else(|| panic!("{guess:?} at {angle}: {orbit:?} has ended"));
                    let error = (found - u).abs();
                    assert!(
                        error <= 2.0 * allowed(&orbit, u, angle),
                        "{error:e}: {found}, not {u} at {angle} by {guess:?}, {orbit:?}"
                    );
                    if guessed == u {
                        let angles = counted.take();
                        let most = if taken == branch { 1 } else { 2 };
                        assert!(
                            angles <= most,
                            "{angles} angles for {u} at {angle}, {orbit:?}"
                        );
                        good += 1;
                    }
                }
            }
        }
    }
    assert!(good > 1000, "{good}");
}

#[test]
fn an_orbit_is_nowhere_after_its_end() {
    for orbit in orbits() {
        let end = Exact.to_end(&orbit);
        for guess in [
            None,
            Some((0.3, Branch::Direct)),
            Some((0.9, Branch::Around)),
        ] {
            for angle in [1.000_001 * end, end + 0.1, end + 1e4, f64::INFINITY] {
                let found = point_at_angle(&Exact, &orbit, angle, guess);
                assert_eq!(found, None, "{angle} for {end}: {orbit:?}");
            }
            let before = 1e-6 * end.min(1.0);
            let (u, _) = point_at_angle(&Exact, &orbit, end - before, guess).unwrap();
            let from_end = (u - orbit.end().u).abs();
            let known = before * orbit.end().slope;
            assert!(
                (from_end - known).abs() <= 1e-5 * known + allowed(&orbit, 0.0, end),
                "{u}: {orbit:?}"
            );
        }
        for angle in [-1e-300, -1.0, f64::NAN] {
            assert_eq!(point_at_angle(&Exact, &orbit, angle, None), None);
        }
        assert_eq!(
            point_at_angle(&Exact, &orbit, 0.0, None),
            Some((orbit.start.u, Branch::Direct))
        );
    }
}

#[test]
fn straight_rays_are_followed_to_their_end() {
    for w in [1e9, 1e100, 1e200, f64::MAX, -1e9, -f64::MAX] {
        let ray = Ray::new(0.5, w).unwrap();
        let u = Exact.u_at_angle(ray, 0.25 / w.abs()).unwrap();
        assert_eq!(u, Some(0.5 + 0.25_f64.copysign(w)), "{w:e}");
        assert_eq!(Exact.u_at_angle(ray, 0.6 / w.abs()), Ok(None), "{w:e}");
    }
    let radial = Ray::new(0.5, f64::INFINITY).unwrap();
    assert_eq!(Exact.u_at_angle(radial, 0.0), Ok(Some(0.5)));
    assert_eq!(Exact.u_at_angle(radial, 1e-300), Ok(None));
}

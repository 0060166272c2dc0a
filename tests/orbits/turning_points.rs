//! Guards against a turning point that is missed, invented or misplaced: every method is compared with the cubic's
//! roots and with the others.

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::{Adaptive, FixedStep, Scheme};
use darkness::orbit::{Orbits, Ray};
use darkness::table::{Spec, Table};

/// Scattered and trapped rays, with their turning points ahead.
fn turning_rays() -> Vec<Ray> {
    let mut rays = Vec::new();
    for k in 1..60 {
        let share = f64::from(k) / 60.0;
        // Inward, outside the photon sphere, below the critical slope there.
        let u = 0.66 * share * share;
        let critical = (2.0 / 3.0 - u) * (u + 1.0 / 3.0).sqrt();
        rays.push(Ray::new(u, critical * (0.02 + 0.97 * (1.0 - share))).unwrap());
        // Outward, inside it.
        let u = 0.68 + 0.31 * share;
        let critical = (u - 2.0 / 3.0) * (u + 1.0 / 3.0).sqrt();
        rays.push(Ray::new(u, -critical * (0.02 + 0.97 * share)).unwrap());
    }
    rays
}

#[test]
fn all_methods_find_the_root_at_the_same_angle() {
    let table = Table::generate(&Spec::standard()).unwrap();
    let rk4 = FixedStep::new(Scheme::Rk4, 0.005);
    let euler = FixedStep::new(Scheme::Euler, 0.0005);
    for ray in turning_rays() {
        let (u, w) = (ray.u(), ray.dudphi());
        let truth = Exact.turning_point(ray).unwrap().unwrap();
        // du/dφ = 0 there: e² = u²(1 − u), to the rounding of both sides.
        let residual = w * w + u * u * (1.0 - u) - truth.u * truth.u * (1.0 - truth.u);
        assert!(
            residual.abs() <= 4.0 * f64::EPSILON,
            "{ray:?}: {residual:e}"
        );
        assert!(
            if u < 2.0 / 3.0 {
                truth.u > u
            } else {
                truth.u < u
            },
            "{ray:?}: {truth:?}"
        );
        // The promises of the table and of the adaptive method; RK4 and Euler by their orders, 30 h⁴ and 30 h being
        // what rays that wind for some radians near the photon sphere make of a local error of h⁵ and h².
        let methods: [(&str, &dyn Orbits, f64); 4] = [
            ("table", &table, 1e-9),
            ("adaptive", &Adaptive::default(), 1e-9),
            ("RK4", &rk4, 2e-8),
            ("Euler", &euler, 1.5e-2),
        ];
        for (name, method, allowed) in methods {
            let found = method.turning_point(ray).unwrap().unwrap();
            assert!(
                (found.angle - truth.angle).abs() <= allowed,
                "{name}, {ray:?}: {found:?}, not {truth:?}"
            );
            assert!(
                (found.u - truth.u).abs() <= allowed,
                "{name}, {ray:?}: {found:?}, not {truth:?}"
            );
        }
    }
}

#[test]
fn rays_that_do_not_turn_have_none() {
    let table = Table::generate(&Spec::draft()).unwrap();
    let methods: [&dyn Orbits; 4] = [
        &Exact,
        &table,
        &Adaptive::default(),
        &FixedStep::new(Scheme::Rk4, 0.01),
    ];
    for (u, w) in [
        (0.1, 0.6),
        (0.9, -0.6),
        (0.1, -0.1),
        (0.9, 0.1),
        (0.1, f64::INFINITY),
        (0.9, f64::NEG_INFINITY),
        // At its turning point already.
        (0.5, 0.0),
        (0.7, -0.0),
    ] {
        for method in methods {
            assert_eq!(
                method.turning_point(Ray::new(u, w).unwrap()).unwrap(),
                None,
                "u = {u}, w = {w}"
            );
        }
    }
}

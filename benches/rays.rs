//! One swept angle: the table against the exact method, the integrators beside them, on the same rays in the same
//! run.
//!
//! `cargo bench --bench rays`

mod interleaved;

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::{Adaptive, FixedStep, Scheme};
use darkness::orbit::invariants::{Orbit, OrbitPoint};
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{Orbits, Ray};
use darkness::table::{Spec, Table};
use interleaved::{Contender, compare};

const RAYS: usize = 4096;
const ROUNDS: usize = 101;

/// Rays of a camera at r = 30 that cross r = 6, their impact parameters spread evenly over (0, `widest`).
fn rays(narrowest: f64, widest: f64) -> Vec<(Ray, Orbit, OrbitPoint)> {
    let u0 = 1.0 / 30.0;
    let mut state = 1_u64;
    let mut rays = Vec::with_capacity(RAYS);
    while rays.len() < RAYS {
        // Knuth's MMIX generator: the order of the rays is random, so that no branch can be foreseen.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let b = narrowest + (widest - narrowest) * ((state >> 11) as f64 / (1_u64 << 53) as f64);
        let slope2 = 1.0 / (b * b) - u0 * u0 * (1.0 - u0);
        let Ok(ray) = Ray::new(u0, slope2.max(0.0).sqrt()) else {
            continue;
        };
        let orbit = Orbit::new(ray);
        if let Some(point) = orbit.point_at(1.0 / 6.0) {
            rays.push((ray, orbit, point));
        }
    }
    rays
}

fn main() {
    let tables: Vec<_> = Spec::NAMES
        .iter()
        .filter_map(|name| Table::generate(&Spec::named(name)?).ok())
        .collect();
    for (title, narrowest, widest) in [
        ("rays that cross r = 6, 0 < b < 6.5", 0.0, 6.5),
        ("of them, far from the hole: 3.5 < b < 6.5", 3.5, 6.5),
        ("of them, about the critical ray: 1.6 < b < 3.2", 1.6, 3.2),
        ("of them, close to radial: 0 < b < 1.4", 0.0, 1.4),
    ] {
        let rays = rays(narrowest, widest);
        let direct = |angles: &dyn Fn(&Orbit, OrbitPoint) -> f64| {
            rays.iter()
                .map(|(_, orbit, point)| angles(orbit, *point))
                .sum()
        };
        let mut contenders = vec![Contender {
            name: "exact",
            run: Box::new(|| direct(&|orbit, point| Exact.direct(orbit, orbit.start, point))),
        }];
        for (name, table) in Spec::NAMES.iter().zip(&tables) {
            let lookup = table.lookup();
            let rays = &rays;
            contenders.push(Contender {
                name,
                run: Box::new(move || {
                    rays.iter()
                        .map(|(_, orbit, point)| lookup.direct(orbit, orbit.start, *point))
                        .sum()
                }),
            });
        }
        compare(
            &format!("One swept angle, {title}"),
            RAYS,
            ROUNDS,
            &mut contenders,
        );
    }
    whole_rays(&rays(0.0, 6.5));
}

/// The whole question, fate and end included: what the integrators cannot help answering.
fn whole_rays(rays: &[(Ray, Orbit, OrbitPoint)]) {
    let rays = &rays[..512];
    let Ok(table) = Table::generate(&Spec::standard()) else {
        return;
    };
    let follow = |orbits: &dyn Orbits| -> f64 {
        rays.iter()
            .filter_map(|(ray, ..)| orbits.follow(*ray, &[3.0, 6.0]).ok())
            .map(|events| events.iter().map(|event| event.angle).sum::<f64>())
            .sum()
    };
    let (rk4, euler) = (
        FixedStep::new(Scheme::Rk4, 0.02),
        FixedStep::new(Scheme::Euler, 0.001),
    );
    let adaptive = Adaptive::default();
    let lookup = table.lookup();
    compare(
        "All events of a ray, radii 3 and 6",
        rays.len(),
        21,
        &mut [
            Contender {
                name: "RK4, h = 0.02",
                run: Box::new(|| follow(&rk4)),
            },
            Contender {
                name: "Euler, h = 0.001",
                run: Box::new(|| follow(&euler)),
            },
            Contender {
                name: "adaptive, 1e-9",
                run: Box::new(|| follow(&adaptive)),
            },
            Contender {
                name: "exact",
                run: Box::new(|| follow(&Exact)),
            },
            Contender {
                name: "standard table",
                run: Box::new(|| follow(&lookup)),
            },
        ],
    );
}

//! Guards against a method that loses an event, invents one, gets a ray's fate wrong or sweeps a wrong angle. The exact
//! method and the three tables are compared with the reference rays, with each other everywhere else, with the
//! integrated equation, and with published figures.

use core::f64::consts::{FRAC_PI_2, PI};
use darkness::isoradial::{CurveSpec, Isoradials};
use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::orbit::invariants::{CRITICAL_E2, Orbit, OrbitPoint};
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{Event, EventKind, MIN_U, Orbits, Ray};

use crate::flights::{RADII, flights};
use crate::known_values::{KnownValue, known_values};
use crate::tables::table;

/// Checks every event of every reference ray: each angle must be within `tolerance + 16 ε·condition`. The second term
/// is the effect on the angle of some units in the last place of the ray's own numbers.
fn check_against_reference(name: &str, method: &impl Orbits, tolerance: f64) {
    let (mut compared, mut worst, mut worst_at) = (0, 0.0, String::new());
    for flight in flights() {
        let ray = Ray::new(flight[0].u0, flight[0].dudphi).unwrap();
        let events = method.follow(ray, &RADII).unwrap();
        assert_eq!(
            events.len(),
            flight.len(),
            "{name}: {}: {events:?}",
            flight[0].name()
        );
        for (row, event) in flight.iter().zip(events) {
            assert_eq!(
                (event.kind, event.radius),
                (row.kind, row.radius),
                "{name}: {}",
                row.name()
            );
            let allowed = tolerance + 16.0 * f64::EPSILON * row.condition;
            let ratio = (event.angle - row.angle).abs() / allowed;
            assert!(
                ratio <= 1.0,
                "{name}: {}: {} instead of {}, {ratio} of the error allowed",
                row.name(),
                event.angle,
                row.angle
            );
            compared += 1;
            if ratio > worst {
                (worst, worst_at) = (ratio, row.name());
            }
        }
    }
    assert_eq!(compared, 2290, "rows of the reference");
    println!(
        "{name}: the worst of {compared} angles has {worst:.3} of the error allowed: {worst_at}"
    );
}

#[test]
fn exact_angles_equal_the_reference() {
    check_against_reference("exact", &Exact, 1e-12);
}

#[test]
fn angles_from_the_draft_table_equal_the_reference() {
    check_against_reference("draft", table("draft"), 1e-6);
}

#[test]
fn angles_from_the_standard_table_equal_the_reference() {
    check_against_reference("standard", table("standard"), 1e-9);
}

#[test]
fn angles_from_the_fine_table_equal_the_reference() {
    check_against_reference("fine", table("fine"), 1e-12);
}

/// The size and the accuracy that each table promises.
#[test]
fn tables_are_as_small_and_as_accurate_as_promised() {
    for (name, tolerance, most_bytes) in [
        ("draft", 1e-6, 32 << 10),
        ("standard", 1e-9, 512 << 10),
        ("fine", 1e-12, 8 << 20),
    ] {
        let table = table(name);
        let bytes = table.bytes().len();
        assert!(bytes <= most_bytes, "{name}: {bytes} bytes");
        let metadata = table.metadata();
        assert_eq!(metadata.spec.name, name);
        assert_eq!(metadata.spec.tolerance, tolerance, "{name}");
        assert!(
            metadata.measured_error > 0.0 && metadata.measured_error <= tolerance,
            "{name}: measured {:e}",
            metadata.measured_error
        );
        assert!(metadata.measured_angles > 1000, "{name}");
        println!(
            "{name}: {bytes} bytes, measured error {:.3e} on {} angles",
            metadata.measured_error, metadata.measured_angles
        );
    }
}

/// The fractional part of ½ plus `k` times the golden ratio: these numbers fill the interval evenly.
fn golden(k: u32) -> f64 {
    let x = 0.5 + f64::from(k) * 0.618_033_988_749_894_9;
    x - x.floor()
}

/// The same with the silver ratio, for a second coordinate.
fn silver(k: u32) -> f64 {
    let x = 0.5 + f64::from(k) * 0.414_213_562_373_095_03;
    x - x.floor()
}

/// Inverse radii from 1e-15 to 1 − 1e-15: spread evenly, with more of them near both ends and the photon sphere.
fn start(k: u32) -> f64 {
    let x = golden(k);
    let tiny = libm::pow(10.0, -15.0 * silver(k));
    match k % 5 {
        0 | 1 => x,
        2 => tiny,
        3 => 1.0 - tiny,
        _ => 2.0 / 3.0 + tiny * (x - 2.0 / 3.0),
    }
    .clamp(1e-15, 1.0 - 1e-15)
}

/// `|u − 2/3| √(u + 1/3)`, the critical ray's |du/dφ|.
fn critical_slope(u: f64) -> f64 {
    (u - 2.0 / 3.0).abs() * (u + 1.0 / 3.0).sqrt()
}

/// Rays near the borders of the table's charts, which lie at e² = 0.64 and 3 times 4/27 (see the page of
/// `table::charts`).
fn border_rays() -> Vec<(f64, f64)> {
    let mut rays = Vec::new();
    for factor in [0.64, 1.0, 3.0] {
        for k in 0..800 {
            let u = start(k);
            let offset = match k % 8 {
                0 => 0.0,
                n => libm::pow(10.0, -1.0 - 2.0 * f64::from(n)),
            };
            for sign in [1.0, -1.0] {
                let slope2 = factor * CRITICAL_E2 * (1.0 + sign * offset) - u * u * (1.0 - u);
                if slope2 >= 0.0 {
                    rays.push((u, slope2.sqrt()));
                    rays.push((u, -slope2.sqrt()));
                }
            }
        }
    }
    rays
}

/// Rays beside critical by 1e-1 to 1e-16 of their slope on both sides, and by 0 to 3 units in the last place.
fn near_critical_rays() -> Vec<(f64, f64)> {
    let mut rays = Vec::new();
    for k in 0..60 {
        let u = start(k);
        let critical = critical_slope(u);
        for digit in 1..=16 {
            let off = libm::pow(10.0, -f64::from(digit)) * (0.5 + silver(k * 16 + digit));
            for w in [critical * (1.0 - off), critical * (1.0 + off)] {
                rays.extend([(u, w), (u, -w)]);
            }
        }
        let (mut below, mut above) = (critical, critical);
        for _ in 0..4 {
            rays.extend([below, above, -below, -above].map(|w| (u, w)));
            (below, above) = (below.next_down(), above.next_up());
        }
    }
    rays
}

/// All combinations of extreme values of both numbers.
fn extreme_rays() -> Vec<(f64, f64)> {
    let mut starts = vec![1e-100, 1e-60, 1e-30, 0.5, 2.0 / 3.0, 0.876_6, 0.877];
    for digit in 1..=15 {
        let tiny = libm::pow(10.0, -f64::from(digit));
        starts.extend([tiny, 1.0 - tiny, 2.0 / 3.0 + tiny, 2.0 / 3.0 - tiny]);
    }
    let mut rays = Vec::new();
    for u in starts {
        let absolute = [
            0.0,
            5e-324,
            1e-310,
            1e-200,
            1e-100,
            1e-30,
            1e-16,
            1e-8,
            1e-3,
            0.1,
            0.3,
            0.38,
            0.7,
            1.0,
            1e2,
            1e4,
            1e8,
            1e12,
            1e16,
            1e20,
            1e21,
            1e50,
            1e100,
            1e153,
            1e154,
            1e155,
            1e200,
            1e300,
            f64::MAX,
            f64::INFINITY,
        ];
        let relative = [1e-20, 1e-10, 1e-3, 0.5, 1.0, 2.0, 1e3].map(|factor| factor * u);
        for w in absolute.into_iter().chain(relative) {
            rays.extend([(u, w), (u, -w)]);
        }
    }
    rays
}

/// Rays spread evenly over `(u, asinh-like w)`.
fn spread_rays() -> Vec<(f64, f64)> {
    (0..3000)
        .map(|k| {
            let w = 2.0 * silver(k) - 1.0;
            (start(k), w / (1.0001 - w * w))
        })
        .collect()
}

/// From just outside the horizon to far beyond any disk.
const MANY_RADII: [f64; 16] = [
    1.0 + 1e-12,
    1.01,
    1.14,
    1.3,
    1.5 - 1e-9,
    1.5,
    1.5 + 1e-9,
    1.6,
    2.0,
    3.0,
    6.0,
    12.0,
    30.0,
    1e3,
    1e6,
    1e12,
];

/// Compares a table's answer about one ray with the exact one. Returns the largest difference, or what is wrong.
fn difference(method: &impl Orbits, u: f64, w: f64) -> Result<f64, String> {
    let ray = Ray::new(u, w).unwrap();
    let events = method.follow(ray, &MANY_RADII).unwrap();
    let truth = Exact.follow(ray, &MANY_RADII).unwrap();
    for (name, list) in [("table", &events), ("exact", &truth)] {
        if !list
            .iter()
            .all(|event| event.angle.is_finite() && event.angle >= 0.0)
        {
            return Err(format!("{name}: not an angle in {list:?}"));
        }
        if !list.is_sorted_by(|a, b| a.angle <= b.angle) {
            return Err(format!("{name}: out of order: {list:?}"));
        }
    }
    let kinds = |list: &[Event]| -> Vec<(EventKind, f64)> {
        list.iter()
            .map(|event| (event.kind, event.radius))
            .collect()
    };
    if kinds(&events) != kinds(&truth) {
        return Err(format!("{events:?} are not {truth:?}"));
    }
    let mut worst: f64 = 0.0;
    for (event, exact) in events.iter().zip(&truth) {
        let difference = (event.angle - exact.angle).abs();
        // Both methods are given the same orbit, so nothing is added for what rounding the ray does to the angle.
        if difference > 1e-9 {
            return Err(format!("{difference:e} at {event:?}, exact {exact:?}"));
        }
        worst = worst.max(difference);
    }
    Ok(worst)
}

fn check_against_exact(population: &str, rays: &[(f64, f64)]) {
    assert!(rays.len() >= 1500, "{population}: {} rays", rays.len());
    let mut worst: f64 = 0.0;
    let mut failures = Vec::new();
    for &(u, w) in rays {
        match difference(table("standard"), u, w) {
            Ok(difference) => worst = worst.max(difference),
            Err(problem) => failures.push(format!("u0 = {u:?}, dudphi = {w:?}: {problem}")),
        }
    }
    assert!(
        failures.is_empty(),
        "{population}: {} of {} rays are wrong, among them\n{}",
        failures.len(),
        rays.len(),
        failures[..failures.len().min(9)].join("\n")
    );
    assert!(worst > 0.0, "{population}: the table was not asked");
    println!(
        "{population}: {} rays, worst difference {worst:.3e}",
        rays.len()
    );
}

#[test]
fn tables_are_accurate_at_the_borders_of_their_charts() {
    check_against_exact("borders", &border_rays());
}

#[test]
fn tables_are_accurate_near_the_critical_ray() {
    check_against_exact("near critical", &near_critical_rays());
}

#[test]
fn tables_are_accurate_for_the_most_extreme_rays() {
    check_against_exact("extremes", &extreme_rays());
}

#[test]
fn tables_are_accurate_for_all_other_rays() {
    check_against_exact("spread", &spread_rays());
}

/// Rays throughout one chart (see `table::charts`), with more of them where its errors are largest: near the chart's
/// neighbours, infinity and the horizon.
fn rays_of_chart(chart: &str) -> Vec<(f64, f64)> {
    let (mut rays, mut k) = (Vec::new(), 0);
    while rays.len() < 12_000 {
        k += 1;
        let (q, place) = (silver(k), golden(k));
        let (share, lowest, highest) = match chart {
            "critical" => (0.64 + 2.36 * q, 0.0, 1.0),
            "weak" => (0.64 * (1.0 - q * q), 0.0, 2.0 / 3.0),
            "trapped" => (0.64 * (1.0 - q * q), 0.876_6, 1.0),
            "radial" => (3.0 / (q + 1e-9), 0.0, 1.0),
            other => panic!("no chart {other}"),
        };
        let place = match k % 3 {
            0 => place,
            1 => place * place * place,
            _ => 1.0 - place * place * place,
        };
        let u = (lowest + (highest - lowest) * place).clamp(1e-12, 1.0 - 1e-15);
        let slope2 = share * CRITICAL_E2 - u * u * (1.0 - u);
        if slope2 >= 0.0 {
            rays.push((
                u,
                if k % 5 < 2 {
                    slope2.sqrt()
                } else {
                    -slope2.sqrt()
                },
            ));
        }
    }
    rays
}

/// Every table keeps its promise in every chart, between the nodes of its grid. The exact answer is for the same orbit,
/// so that beside the tolerance only rounding is allowed: 16 ε of the angle.
#[test]
fn tables_are_as_accurate_as_promised_throughout_every_chart() {
    let mut broken = Vec::new();
    for name in ["draft", "standard", "fine"] {
        let table = table(name);
        let tolerance = table.metadata().spec.tolerance;
        for chart in ["critical", "weak", "trapped", "radial"] {
            let (mut worst, mut worst_at) = (0.0, String::new());
            for (k, (u, w)) in rays_of_chart(chart).into_iter().enumerate() {
                let ray = Ray::new(u, w).unwrap();
                // Trapped rays stay below r = 1.15.
                let far = if chart == "trapped" { 1.14 } else { 40.0 };
                let radius = far - (far - 1.0) * golden(3 * k as u32).sqrt();
                let found = table.follow(ray, &[radius]).unwrap();
                let truth = Exact.follow(ray, &[radius]).unwrap();
                assert_eq!(found.len(), truth.len(), "{name}: {ray:?}");
                for (event, exact) in found.iter().zip(&truth) {
                    let allowed = tolerance + 16.0 * f64::EPSILON * exact.angle;
                    let ratio = (event.angle - exact.angle).abs() / allowed;
                    if ratio > worst {
                        (worst, worst_at) = (ratio, format!("{ray:?}: {event:?}, exact {exact:?}"));
                    }
                }
            }
            println!("{name}, {chart}: {worst:.3} of the error allowed");
            if worst > 1.0 {
                broken.push(format!(
                    "{name}, {chart}: {worst:.3} of the error allowed at {worst_at}"
                ));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// The integrated equation knows no elliptic integral and no first integral. Its default tolerance is 1e-9 an angle;
/// the exact method's 1e-12 and 64 ε·condition, condition below 1/1e-3 for rays at least that share from critical,
/// add under 2e-11.
#[test]
fn exact_angles_solve_the_orbit_equation() {
    const ALLOWED: f64 = 1.02e-9;
    let (mut compared, mut worst) = (0, 0.0_f64);
    for k in 0..400 {
        let u = 0.001 + 0.997 * golden(k);
        let w = 3.0 * (2.0 * silver(k) - 1.0) * silver(7 * k + 1);
        let e2 = w * w + u * u * (1.0 - u);
        if (e2 / CRITICAL_E2 - 1.0).abs() < 1e-3 {
            continue;
        }
        let ray = Ray::new(u, w).unwrap();
        let radii = [1.2, 1.5, 2.0, 3.0, 6.0, 12.0, 30.0, 200.0];
        let exact = Exact.follow(ray, &radii).unwrap();
        let stepped = Adaptive::default().follow(ray, &radii).unwrap();
        assert_eq!(
            exact.len(),
            stepped.len(),
            "{ray:?}: {exact:?}, {stepped:?}"
        );
        for (a, b) in exact.iter().zip(&stepped) {
            assert_eq!((a.kind, a.radius), (b.kind, b.radius), "{ray:?}");
            let difference = (a.angle - b.angle).abs();
            assert!(difference <= ALLOWED, "{ray:?}: {a:?}, {b:?}");
            worst = worst.max(difference);
            compared += 1;
        }
    }
    assert!(compared > 1200, "{compared} angles");
    println!("{compared} angles, worst difference {worst:.3e}");
}

/// The methods that are compared with published figures, each with its allowed error of an angle.
fn angle_to_end(orbit: &Orbit) -> [(f64, f64); 2] {
    let lookup = table("standard").lookup();
    [(Exact.to_end(orbit), 1e-12), (lookup.to_end(orbit), 1e-9)]
}

/// A ray from infinity with `Δ = e² − 4/27`.
fn from_infinity(delta: f64) -> Orbit {
    let e2 = CRITICAL_E2 + delta;
    let slope = e2.sqrt();
    Orbit {
        start: OrbitPoint { u: MIN_U, slope },
        e2,
        delta,
        ..Orbit::new(Ray::new(MIN_U, if delta < 0.0 { 0.1 } else { 1.0 }).unwrap())
    }
}

/// Deflection of a ray from infinity back to infinity: what it sweeps less π (Darwin 1959). Printed with 15 digits.
#[test]
fn deflections_equal_darwins() {
    let rows = known_values("deflection");
    assert_eq!(rows.len(), 12);
    for KnownValue {
        argument, value, ..
    } in rows
    {
        let ratio: f64 = argument.parse().unwrap();
        // e² = 1/b²; x²−1 as a product keeps the digits of x − 1.
        let delta = -CRITICAL_E2 * (ratio - 1.0) * (ratio + 1.0) / (ratio * ratio);
        // The argument itself is rounded: of x − 1 by ε/2, and α falls as −ln(x − 1).
        let rounding = 1.0 / (ratio - 1.0);
        for (angle, tolerance) in angle_to_end(&from_infinity(delta)) {
            let error = (angle - PI - value).abs();
            let allowed = tolerance + f64::EPSILON * rounding;
            assert!(
                error <= allowed,
                "b/bc = {ratio}: {} off by {error:e}",
                angle - PI
            );
        }
        // The same as a ray with two numbers, whose condition is dα/d ln b < 1 + x/(x − 1).
        let ray = Ray::new(MIN_U, CRITICAL_E2.sqrt() / ratio).unwrap();
        let end = Exact.follow(ray, &[]).unwrap()[0];
        let error = (end.angle - PI - value).abs();
        let allowed = 1e-12 + 16.0 * f64::EPSILON * (1.0 + ratio * rounding);
        assert!(error <= allowed, "b/bc = {ratio}: {end:?} off by {error:e}");
    }
}

/// `α → −ln(b/b_c − 1) + ln(216(7 − 4√3)) − π` (Bozza 2002, eq. 35 for the Schwarzschild hole; the next terms are of
/// the order ε ln ε, ε = `b/b_c − 1`).
#[test]
fn strong_deflections_equal_bozzas() {
    let [constant] = &known_values("strong_deflection_constant")[..] else {
        panic!("one row")
    };
    for digit in 6..=14 {
        let excess = libm::pow(10.0, -f64::from(digit));
        let delta = -CRITICAL_E2 * excess * (2.0 + excess) / ((1.0 + excess) * (1.0 + excess));
        for (angle, tolerance) in angle_to_end(&from_infinity(delta)) {
            let limit = constant.value - libm::log(excess);
            let allowed = tolerance + excess * (1.0 - libm::log(excess));
            let error = (angle - PI - limit).abs();
            assert!(error <= allowed, "b/bc − 1 = {excess:e}: off by {error:e}");
        }
    }
}

/// Whether `angle`, a monotone function of a printed number with an error of half a unit in its last place, takes the
/// value `target` within that error, give or take `tolerance`.
fn straddles(
    angle: impl Fn(f64) -> f64,
    value: f64,
    half_unit: f64,
    target: f64,
    tolerance: f64,
) -> bool {
    let (a, b) = (
        angle(value - half_unit) - target,
        angle(value + half_unit) - target,
    );
    a.min(b) <= tolerance && a.max(b) >= -tolerance
}

/// Closest approach of the rays that are deflected by whole turns (Virbhadra & Ellis 2000, table 1): `2 φ(periapsis →
/// ∞) − π = 2πn`.
#[test]
fn closest_approaches_equal_those_of_virbhadra_and_ellis() {
    let rows = known_values("closest_approach_alpha_2pi_n");
    assert_eq!(rows.len(), 2);
    for row in rows {
        let n: f64 = row.argument.parse().unwrap();
        let deflection = |method: &dyn Orbits, radius: f64| {
            let ray = Ray::new(1.0 / radius, 0.0).unwrap();
            2.0 * method.follow(ray, &[]).unwrap()[0].angle - PI
        };
        for (method, tolerance) in methods() {
            let angle = |radius| deflection(method, radius);
            // Twice the angle, twice its error; the radius's own rounding is far below its last printed place.
            assert!(
                straddles(angle, row.value, 5e-11, 2.0 * PI * n, 2.0 * tolerance),
                "n = {n}: {} rad",
                angle(row.value)
            );
            let published: f64 = row.published.parse().unwrap();
            assert!(
                straddles(angle, published, 5e-7, 2.0 * PI * n, 2.0 * tolerance),
                "n = {n}"
            );
        }
    }
}

fn methods() -> [(&'static dyn Orbits, f64); 2] {
    [(&Exact, 1e-12), (table("standard"), 1e-9)]
}

/// A ray from infinity with impact parameter b.
fn with_impact_parameter(b: f64) -> Ray {
    Ray::new(MIN_U, 1.0 / b).unwrap()
}

/// Of the angles at which a ray of impact parameter b crosses `radius` (or, at 0, ends), the one closest to `target`.
fn closest(method: &dyn Orbits, b: f64, radius: f64, target: f64) -> f64 {
    let watched = if radius > 1.0 { vec![radius] } else { vec![] };
    let events = method.follow(with_impact_parameter(b), &watched).unwrap();
    let end = events.len() - 1;
    let angles = if radius > 1.0 {
        &events[..end]
    } else {
        &events[end..]
    };
    angles
        .iter()
        .map(|event| event.angle)
        .min_by(|a, b| (a - target).abs().total_cmp(&(b - target).abs()))
        .unwrap_or(f64::NAN)
}

/// What b loses by rounding near critical: 16 ε·condition, with φ ~ −ln ε, ε the share that b is off critical.
fn rounding_near_critical(b: f64) -> f64 {
    16.0 * f64::EPSILON * b / (b - 1.0 / CRITICAL_E2.sqrt()).abs()
}

/// The borders of the lensing ring and of the photon ring (Gralla, Holz & Wald 2019, eqs 6 and 7; b over M, half a
/// Schwarzschild radius): rays that sweep ¾ and 1¼ turns from end to end.
#[test]
fn ring_borders_equal_those_of_gralla_holz_and_wald() {
    for row in known_values("band_edge_b_over_M") {
        let target = match &row.argument[..] {
            "inner lensed" | "outer lensed" => 1.5 * PI,
            "inner photon ring" | "outer photon ring" => 2.5 * PI,
            other => panic!("{other}"),
        };
        let published: f64 = row.published.parse().unwrap();
        for (method, tolerance) in methods() {
            let angle = |b_over_m: f64| closest(method, 0.5 * b_over_m, 0.0, target);
            let rounding = rounding_near_critical(0.5 * row.value);
            assert!(
                straddles(angle, row.value, 5e-10, target, tolerance + rounding),
                "{}: {} rad",
                row.argument,
                angle(row.value)
            );
            assert!(
                straddles(angle, published, 5e-6, target, tolerance),
                "{}",
                row.argument
            );
        }
    }
}

/// A circle of the disk seen along its axis, in the orders 0 to 3: the ray sweeps a quarter turn and k half turns.
/// And the isoradials at 80° (Luminet 1979, section 4) at the plate's bottom (α = 0), side and top, where the ray
/// sweeps 10°, 90° and 170°.
#[test]
fn circles_of_the_disk_are_seen_where_luminet_saw_them() {
    let mut rows = Vec::new();
    for row in known_values("face_on_b") {
        let (radius, order) = face_on(&row.argument);
        // Twelve digits, of which eleven follow the point below 10, ten above.
        let half_unit = if row.value < 10.0 { 5e-12 } else { 5e-11 };
        rows.push((row, radius, FRAC_PI_2 + PI * f64::from(order), half_unit));
    }
    for row in known_values("isoradial_80deg_b") {
        let mut words = row.argument.split(' ');
        let radius: f64 = words.next().unwrap()[2..].parse().unwrap();
        let first = match words.next().unwrap() {
            "alpha=0" => 10.0_f64,
            "alpha=90" => 90.0,
            "alpha=180" => 170.0,
            other => panic!("{other}"),
        };
        let order = if words.next() == Some("direct") {
            0.0
        } else {
            1.0
        };
        rows.push((row, radius, first.to_radians() + order * PI, 5e-12));
    }
    assert_eq!(rows.len(), 15);
    for (row, radius, target, half_unit) in rows {
        for (method, tolerance) in methods() {
            let angle = |b: f64| closest(method, b, radius, target);
            let rounding = rounding_near_critical(row.value);
            assert!(
                straddles(angle, row.value, half_unit, target, tolerance + rounding),
                "{} {}: {} rad, not {target}",
                row.quantity,
                row.argument,
                angle(row.value)
            );
        }
    }
}

/// `r=3 order=1`.
fn face_on(argument: &str) -> (f64, u32) {
    let (radius, order) = argument.split_once(' ').unwrap();
    (radius[2..].parse().unwrap(), order[6..].parse().unwrap())
}

/// A camera so far away that b = s r to twelve digits, with a pixel of 1e-5 in b.
fn far_spec() -> CurveSpec {
    let u0: f64 = 1e-12;
    CurveSpec {
        pixel: 1e-5 * u0,
        tolerance: 1e-3,
        ..CurveSpec::all_round(u0, u0 * (1.0 - u0).sqrt(), Some((3.0, 12.0)))
    }
}

/// The isoradial curves of a far camera on the disk's axis: the rings' edges at the known impact parameters.
///
/// The curves are right to a thousandth of a pixel of 1e-5 in b; b = sin ψ/(u0 √(1 − u0)) for the angle ψ from the
/// hole's direction, where sin ψ = tan ψ = s/z to ψ² = 1e-23.
#[test]
fn isoradials_of_a_far_camera_are_at_the_known_impact_parameters() {
    let spec = far_spec();
    let lookup = table("standard").lookup();
    let rows = known_values("face_on_b");
    assert_eq!(rows.len(), 8);
    for (curves, method) in [
        (Isoradials::new(&spec, &Exact), "exact"),
        (Isoradials::new(&spec, &lookup), "table"),
    ] {
        let error = curves.error();
        assert!(error.interpolation <= 1e-3, "{method}: {error:?}");
        assert!(curves.orders().len() >= 4, "{method}");
        let sees = |b: f64| curves.meets(1.0, b * spec.slope_scale, b * spec.slope_scale, 0.0);
        for row in &rows {
            let (radius, order) = face_on(&row.argument);
            let inwards = if radius == 3.0 { 1.0 } else { -1.0 };
            // The curve's 1e-8 (a thousandth of a pixel), and as much again for the table's 1e-9 of angle: |∂b/∂φ| is
            // below r = 12.
            let off = inwards * 2e-8;
            let (inside, outside) = (row.value + off, row.value - off);
            assert!(
                sees(inside) && !sees(outside),
                "{method}: r = {radius}, order {order}"
            );
        }
    }
}

/// In the limit each order is e^−π times as thick as the one before (Ohanian 1987).
///
/// An order is thickest at its first angle, kπ; for k = 3 the circle r = 12 is there a share ε = 1e-3 farther out
/// than critical (it is 2.1e-4 at 3½π, see `face_on_b`, and e^{π/2} times as much a quarter turn before), for each
/// further order e^−π of that. The terms left out of the limit are of the order of ε ln ε (as in Bozza's formula
/// above).
#[test]
fn rings_thin_out_by_a_factor_of_exp_pi() {
    let [ratio] = &known_values("ring_ratio")[..] else {
        panic!("one row")
    };
    let curves = Isoradials::new(&far_spec(), &table("standard").lookup());
    for (k, distance) in [(3, 1e-3), (4, 1e-3 * ratio.value)] {
        let thickness = |k: usize| curves.orders()[k].thickness();
        let found = thickness(k + 1) / thickness(k);
        let allowed = distance * (1.0 - libm::log(distance));
        assert!(
            (found / ratio.value - 1.0).abs() <= allowed,
            "orders {k} and {}: {found}",
            k + 1
        );
    }
}

/// The shadow of a static camera: `cot α = κ_c` (Synge 1966). Printed to ten digits.
#[test]
fn shadows_are_as_wide_as_synges() {
    let rows = known_values("shadow_half_angle_deg");
    assert_eq!(rows.len(), 4);
    for row in rows {
        let radius: f64 = row
            .argument
            .strip_prefix("camera r=")
            .and_then(|rest| rest.strip_suffix(" static"))
            .unwrap()
            .parse()
            .unwrap();
        let u0 = 1.0 / radius;
        let spec = CurveSpec {
            u0,
            slope_scale: u0 * (1.0 - u0).sqrt(),
            ..far_spec()
        };
        let half_angle = libm::atan2(1.0, spec.critical()).to_degrees();
        let half_unit = if row.value < 10.0 { 5e-10 } else { 5e-9 };
        assert!(
            (half_angle - row.value).abs() <= half_unit,
            "r = {radius}: {half_angle}, not {}",
            row.value
        );
    }
}

#[test]
fn the_critical_impact_parameter_equals_the_published_one() {
    let [row] = &known_values("critical_impact_parameter")[..] else {
        panic!("one row")
    };
    // Correct to the last place but for the rounding of a root and a quotient.
    assert!((1.0 / CRITICAL_E2.sqrt() - row.value).abs() <= 2.0 * f64::EPSILON * row.value);
}

//! Guards against errors for a ray whose turning point is at a disk's edge, or nearly: a crossing without its partner,
//! an angle that is not a number, or one that is off by more than the ray's own digits leave open. If a ray turns at a
//! depth d beyond a radius, the angle between its two crossings of it is `2 √(2d/|ü|)`, `ü = u(1.5 u − 1)`, so half of
//! all digits of d are lost. The tests compute d in whole numbers.

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::orbit::{Event, EventKind, Orbits, Ray};

use crate::natural;
use crate::quadrature::TrueRay;
use crate::tables::table;

fn methods() -> [(&'static str, &'static dyn Orbits, f64); 4] {
    [
        ("exact", &Exact, 1e-12),
        ("draft", table("draft"), 1e-6),
        ("standard", table("standard"), 1e-9),
        ("fine", table("fine"), 1e-12),
    ]
}

/// A ray that turns at `radius` or very near it.
#[derive(Debug, Clone, Copy)]
struct Graze {
    u: f64,
    w: f64,
    radius: f64,
}

impl Graze {
    /// Inverse radius of the edge, as every method takes it.
    fn edge(&self) -> f64 {
        1.0 / self.radius
    }

    /// `(du/dφ)²` at the edge; negative where the ray turns before it.
    fn squared(&self) -> f64 {
        natural::squared_slope(self.u, self.w, self.edge())
    }

    /// `|ü|` at the edge.
    fn bend(&self) -> f64 {
        (self.edge() * (1.5 * self.edge() - 1.0)).abs()
    }

    /// What becomes of half the angle between the crossings where `squared` is off by `error`.
    fn blur(&self, error: f64) -> f64 {
        let squared = self.squared();
        ((squared + error).max(0.0).sqrt() - (squared - error).max(0.0).sqrt()) / self.bend()
    }

    /// Roundings of `squared`: of some terms, none larger than the larger of u² and edge², by up to ε/2 each.
    fn rounding(&self) -> f64 {
        let largest = self.edge().max(self.u);
        4.0 * f64::EPSILON * largest * largest
    }
}

/// Rays towards turning points on both sides of the photon sphere, the turning point beyond the edge by a share of its
/// inverse radius: 0, one to three units in the last place, 1e-15 to 1e-6.
fn grazes(share_of: impl Fn(f64) -> Vec<f64>) -> Vec<Graze> {
    let mut grazes = Vec::new();
    for radius in [1.6_f64, 2.0, 3.0, 3.1, 12.0, 37.7, 1e4, 1.02, 1.2, 1.4] {
        let edge = 1.0 / radius;
        let sign = if radius > 1.5 { 1.0 } else { -1.0 };
        for turn in share_of(edge).into_iter().map(|share| edge * (1.0 + share)) {
            for distance in [1e-5, 0.03, 0.3, 0.8, 0.9999] {
                let u = if radius > 1.5 {
                    edge * (1.0 - distance)
                } else {
                    edge + (1.0 - edge) * distance
                };
                if (u < turn) != (radius > 1.5) {
                    continue;
                }
                // From u²(1 − u) of both without losing the difference.
                let factor = u + turn - u * u - u * turn - turn * turn;
                let w = sign * ((turn - u) * factor).sqrt();
                grazes.push(Graze { u, w, radius });
            }
        }
    }
    grazes
}

fn shares(edge: f64) -> Vec<f64> {
    let mut shares = vec![0.0];
    for steps in 1..=3 {
        let neighbour = f64::from_bits(edge.to_bits() + steps);
        shares.push(neighbour / edge - 1.0);
    }
    for digit in 6..=15 {
        shares.push(libm::pow(10.0, -f64::from(digit)));
    }
    shares.iter().flat_map(|&share| [share, -share]).collect()
}

/// The crossings of the edge itself, and that there are two or none.
fn pair(name: &str, graze: &Graze, events: &[Event]) -> Option<[Event; 2]> {
    assert!(
        events.iter().all(|event| event.angle.is_finite())
            && events.is_sorted_by(|a, b| a.angle <= b.angle),
        "{name}, {graze:?}: {events:?}"
    );
    let crossings: Vec<Event> = events
        .iter()
        .copied()
        .filter(|event| event.radius == graze.radius)
        .collect();
    let kinds: Vec<EventKind> = crossings.iter().map(|event| event.kind).collect();
    match crossings[..] {
        [] => None,
        [first, second] => {
            let expected = if graze.w > 0.0 {
                [EventKind::Inbound, EventKind::Outbound]
            } else {
                [EventKind::Outbound, EventKind::Inbound]
            };
            assert_eq!(kinds, expected, "{name}, {graze:?}");
            Some([first, second])
        }
        _ => panic!("{name}, {graze:?}: a crossing without its partner, {events:?}"),
    }
}

#[test]
fn crossings_of_a_grazed_edge_come_in_pairs_about_the_turning_point() {
    let mut decided = [0, 0];
    let mut worst: f64 = 0.0;
    for graze in grazes(shares) {
        let truth = TrueRay::new(graze.u, graze.w);
        let ray = Ray::new(graze.u, graze.w).unwrap();
        let (squared, rounding) = (graze.squared(), graze.rounding());
        let known = |event: Event| (event, truth.angle(&event));
        for (name, method, tolerance) in methods() {
            let events = method.follow(ray, &[graze.radius]).unwrap();
            let met = pair(name, &graze, &events);
            if squared.abs() > rounding {
                assert_eq!(
                    met.is_some(),
                    squared > 0.0,
                    "{name}, {graze:?}: {squared:e}"
                );
                decided[usize::from(squared > 0.0)] += 1;
            }
            let Some(met) = met else { continue };
            // What rounding the ray does to the way to its turning point, which is part of that to its end.
            let condition = truth.condition(&events[events.len() - 1]);
            let turn = method.turning_point(ray).unwrap().unwrap().angle;
            // Both are the turning point's angle, give or take half of what lies between them: to the rounding of the
            // terms that an angle is put together from, which are of the size of 1.
            let off_centre = (0.5 * (met[0].angle + met[1].angle) - turn).abs();
            assert!(
                off_centre <= 8.0 * f64::EPSILON * (1.0 + turn),
                "{name}, {graze:?}: {met:?} about {turn}"
            );
            // Where the ray in truth stops short of the edge, the crossings are at its turning point but for the
            // rounding.
            if squared > 0.0 {
                for (event, angle) in met.map(known) {
                    let allowed =
                        tolerance + graze.blur(rounding) + 16.0 * f64::EPSILON * condition;
                    let ratio = (event.angle - angle).abs() / allowed;
                    assert!(
                        ratio <= 1.0,
                        "{name}, {graze:?}: {event:?}, not {angle}: {ratio}"
                    );
                    worst = worst.max(ratio);
                }
            } else {
                let between = met[1].angle - met[0].angle;
                let allowed = 2.0 * (tolerance + graze.blur(rounding));
                assert!(between <= allowed, "{name}, {graze:?}: {between:e} apart");
            }
        }
    }
    println!("{worst:.3} of the error allowed");
    assert!(decided.iter().all(|&count| count > 1000), "{decided:?}");
}

/// A camera on the edge's own radius that looks along it: the start is no crossing, and its neighbour one unit in the
/// last place beyond has one crossing, at `√(2d/|ü|)`, to as many digits as d is known.
#[test]
fn rays_that_start_on_an_edge_along_its_tangent_cross_it_as_they_should() {
    for radius in [
        1.6_f64, 2.0, 3.0, 3.1, 12.0, 37.7, 1e4, 1e12, 1.02, 1.2, 1.4,
    ] {
        let edge = 1.0 / radius;
        for (name, method, tolerance) in methods() {
            let crossings = |u: f64, w: f64| -> Vec<Event> {
                let events = method.follow(Ray::new(u, w).unwrap(), &[radius]).unwrap();
                events
                    .into_iter()
                    .filter(|event| event.radius == radius)
                    .collect()
            };
            for w in [0.0, -0.0] {
                assert_eq!(crossings(edge, w), [], "{name}, r = {radius}");
                // A periapsis turns back outwards, an apoapsis inwards.
                let (before, beyond) = if radius > 1.5 {
                    (edge.next_down(), edge.next_up())
                } else {
                    (edge.next_up(), edge.next_down())
                };
                assert_eq!(crossings(before, w), [], "{name}, r = {radius}");
                let graze = Graze {
                    u: beyond,
                    w,
                    radius,
                };
                let truth = TrueRay::new(beyond, w);
                let met = crossings(beyond, w);
                let [event] = met[..] else {
                    panic!("{name}, r = {radius}: {met:?}")
                };
                let angle = truth.angle(&event);
                let law = graze.squared().sqrt() / graze.bend();
                assert!((angle / law - 1.0).abs() <= 1e-6, "{angle:e}, {law:e}");
                // Next to a turning point a table's angle is the slope times a number, of 1 or more, kept to its
                // tolerance.
                let allowed = tolerance * angle + 16.0 * f64::EPSILON;
                assert!(
                    (event.angle - angle).abs() <= allowed,
                    "{name}, r = {radius}: {event:?}, not {angle:e}"
                );
            }
        }
    }
}

/// The table is given the orbit that the exact method is given: next to a graze they agree to the table's tolerance,
/// whatever rounding has done to the depth.
#[test]
fn tables_agree_with_the_exact_method_however_close_the_graze() {
    for graze in grazes(shares) {
        let ray = Ray::new(graze.u, graze.w).unwrap();
        let truth = Exact.follow(ray, &[graze.radius]).unwrap();
        for (name, method, tolerance) in methods().into_iter().skip(1) {
            let events = method.follow(ray, &[graze.radius]).unwrap();
            assert_eq!(events.len(), truth.len(), "{name}, {graze:?}");
            for (event, exact) in events.iter().zip(&truth) {
                assert_eq!(event.kind, exact.kind, "{name}, {graze:?}");
                let allowed = tolerance + 16.0 * f64::EPSILON * exact.angle;
                assert!(
                    (event.angle - exact.angle).abs() <= allowed,
                    "{name}, {graze:?}: {event:?}, {exact:?}"
                );
            }
        }
    }
}

/// Adaptive integration tells a crossing from a miss where the turning point is farther from the edge than a share of
/// 1e-5 of its tolerance; that share is what it may have the depth wrong by.
#[test]
fn integration_tells_a_graze_from_a_miss_as_finely_as_it_says() {
    const TOLERANCE: f64 = 1e-9;
    let method = Adaptive::new(TOLERANCE);
    let mut compared = 0;
    for graze in grazes(|_| {
        (6..=13)
            .flat_map(|digit| [1.0, -1.0].map(|sign| sign * libm::pow(10.0, -f64::from(digit))))
            .collect()
    }) {
        let truth = TrueRay::new(graze.u, graze.w);
        let events = method
            .follow(Ray::new(graze.u, graze.w).unwrap(), &[graze.radius])
            .unwrap();
        if events[events.len() - 1].angle > 10.0 {
            continue;
        }
        let met = pair("adaptive", &graze, &events);
        assert_eq!(met.is_some(), graze.squared() > 0.0, "{graze:?}");
        for event in met.iter().flatten() {
            // (du/dφ)² = 2 |ü| d.
            let depth = 1e-5 * TOLERANCE * graze.edge();
            let allowed = TOLERANCE + graze.blur(2.0 * graze.bend() * depth);
            let angle = truth.angle(event);
            assert!(
                (event.angle - angle).abs() <= allowed,
                "{graze:?}: {event:?}, not {angle}"
            );
            compared += 1;
        }
    }
    assert!(compared > 300, "{compared} angles");
}

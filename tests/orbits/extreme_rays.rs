//! Guards against errors for the most difficult rays: next to critical down to the last representable bit, radial,
//! tangential. Fates are decided in whole numbers and angles by quadrature; neither shares code with the methods under
//! test.

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::{Adaptive, FixedStep, Scheme};
use darkness::orbit::invariants::Orbit;
use darkness::orbit::{Event, EventKind, Fate, Orbits, Ray};

use crate::natural;
use crate::quadrature::TrueRay;
use crate::tables::table;

/// The exact method and the tables, with what each promises of an angle beside what rounding the ray's own numbers
/// does to it.
fn methods() -> [(&'static str, &'static dyn Orbits, f64); 4] {
    [
        ("exact", &Exact, 1e-12),
        ("draft", table("draft"), 1e-6),
        ("standard", table("standard"), 1e-9),
        ("fine", table("fine"), 1e-12),
    ]
}

/// Inverse radii from 1e100 radii away to the last number above the horizon, crowded to the photon sphere on both
/// sides.
fn starts() -> Vec<f64> {
    let mut starts = vec![
        1e-100,
        1e-15,
        1e-9,
        1e-4,
        1.0 / 30.0,
        0.1,
        1.0 / 3.0,
        0.499,
        0.5,
        0.501,
        0.6,
        0.7,
        0.75,
        0.9,
        0.99,
        1.0 - 1e-9,
        1.0_f64.next_down(),
    ];
    for digit in [2, 4, 6, 8, 10, 12, 14] {
        let near = libm::pow(10.0, -f64::from(digit));
        starts.extend([2.0 / 3.0 - near, 2.0 / 3.0 + near]);
    }
    let (mut below, mut above) = (2.0_f64 / 3.0, (2.0_f64 / 3.0).next_up());
    for _ in 0..3 {
        starts.extend([below, above]);
        (below, above) = (below.next_down(), above.next_up());
    }
    starts
}

/// Well away from the photon sphere, on both sides.
const RADII: [f64; 5] = [1.2, 2.0, 3.0, 12.0, 1e6];

/// What happens to a ray near critical or with a turning point at its start, from the sign of Δ and its direction.
fn story(u: f64, w: f64, truth: &TrueRay) -> Vec<(EventKind, f64)> {
    let start = 1.0 / u;
    let inbound = |from: f64, to: f64| {
        let met = RADII.iter().rev().filter(move |&&r| to < r && r < from);
        met.map(|&r| (EventKind::Inbound, r))
    };
    let outbound = |from: f64, to: f64| {
        let met = RADII.iter().filter(move |&&r| from < r && r < to);
        met.map(|&r| (EventKind::Outbound, r))
    };
    let capture = (EventKind::End(Fate::Capture), 1.0);
    let escape = (EventKind::End(Fate::Escape), f64::INFINITY);
    let far = f64::INFINITY;
    let can_turn = truth.delta < 0.0;
    if can_turn && w > 0.0 && !truth.inside() {
        let back = outbound(1.5, far).chain([escape]);
        inbound(start, 1.5).chain(back).collect()
    } else if can_turn && w < 0.0 && truth.inside() {
        let back = inbound(1.5, 1.0).chain([capture]);
        outbound(start, 1.5).chain(back).collect()
    } else if w > 0.0 || (can_turn && truth.inside()) {
        inbound(start, 1.0).chain([capture]).collect()
    } else {
        outbound(start, far).chain([escape]).collect()
    }
}

fn happened(events: &[Event]) -> Vec<(EventKind, f64)> {
    events
        .iter()
        .map(|event| (event.kind, event.radius))
        .collect()
}

/// What a ray does, known without the program.
struct Known {
    ray: Ray,
    truth: TrueRay,
    story: Vec<(EventKind, f64)>,
    /// Of each event.
    angles: Vec<f64>,
}

impl Known {
    fn new(u: f64, w: f64) -> Self {
        let truth = TrueRay::new(u, w);
        let story = story(u, w, &truth);
        let angles = story.iter().map(|&(kind, radius)| {
            truth.angle(&Event {
                kind,
                radius,
                angle: f64::NAN,
            })
        });
        Self {
            ray: Ray::new(u, w).unwrap(),
            angles: angles.collect(),
            truth,
            story,
        }
    }

    /// Asserts that `method` tells the same story, every angle within `allowed(angle)`. Returns the angle at
    /// the end, and the largest error as a share of what is allowed.
    fn checked(&self, name: &str, method: &dyn Orbits, allowed: impl Fn(f64) -> f64) -> (f64, f64) {
        let name = format!("{name}, {:?}, Δ = {:e}", self.ray, self.truth.delta);
        let events = method.follow(self.ray, &RADII).unwrap();
        assert_eq!(happened(&events), self.story, "{name}");
        assert!(
            events.is_sorted_by(|a, b| a.angle <= b.angle),
            "{name}: {events:?}"
        );
        let mut worst: f64 = 0.0;
        for (event, &angle) in events.iter().zip(&self.angles) {
            let ratio = (event.angle - angle).abs() / allowed(angle);
            assert!(
                ratio <= 1.0,
                "{name}: {event:?}, not {angle}: {ratio} of the error allowed"
            );
            worst = worst.max(ratio);
        }
        (events[events.len() - 1].angle, worst)
    }
}

/// Guards against a fate told wrongly, or an angle that loses its digits, on the rays next to critical.
///
/// For 12 representable slopes on both sides Δ's plain form has no digit left, and the program computes it in
/// doubled precision: there an angle owes nothing to its condition, and is right to the method's tolerance and 8 ε of
/// itself (some roundings of a root and of a logarithm).
#[test]
fn rays_one_bit_from_critical_have_the_right_fate_and_angles() {
    let methods = methods();
    let mut worst = [0.0_f64; 4];
    for u in starts() {
        let captured = natural::critical_slope(u);
        for direction in [1.0, -1.0] {
            let (mut below, mut above) = (captured.next_down(), captured);
            // Each method's angle to the end for the neighbour nearer to critical, on both sides.
            let mut nearer = [[f64::INFINITY; 2]; 4];
            for step in 0..12 {
                for (side, slope) in [below, above].into_iter().enumerate() {
                    let known = Known::new(u, direction * slope);
                    assert_eq!(
                        known.truth.delta > 0.0,
                        side == 1,
                        "u0 = {u:?}, step {step}"
                    );
                    for (i, (name, method, tolerance)) in methods.into_iter().enumerate() {
                        let (end, share) = known
                            .checked(name, method, |angle| tolerance + 8.0 * f64::EPSILON * angle);
                        worst[i] = worst[i].max(share);
                        if (direction > 0.0) != known.truth.inside() {
                            // A step of one in the last place moves the angle by ln((n + 1)/n) or so, n ≤ 12: far
                            // more than any tolerance.
                            assert!(
                                end < nearer[i][side],
                                "{name}, {:?}: {end} rad, {} nearer to critical",
                                known.ray,
                                nearer[i][side]
                            );
                            nearer[i][side] = end;
                        }
                    }
                }
                (below, above) = (below.next_down(), above.next_up());
            }
        }
    }
    println!("shares of the error allowed: {worst:.3?}");
}

/// Guards against a hand-over between the two forms of Δ that drops digits: slopes 2⁴ to 2⁴⁴ units in the last place
/// from critical. Δ is in doubled precision to 1e-3 of the slope, and right to 1000 ε of itself beyond: no angle owes
/// more than some ε to either, whatever its condition.
#[test]
fn rays_at_powers_of_two_from_critical_have_the_right_fate_and_angles() {
    let methods = methods();
    let mut worst = [0.0_f64; 4];
    for (k, u) in starts().into_iter().enumerate() {
        let captured = natural::critical_slope(u).to_bits();
        for power in [4, 5, 6, 8, 11, 14, 18, 23, 28, 33, 38, 44].map(|power| power + k % 2) {
            for bits in [captured - (1 << power), captured + (1 << power)] {
                let slope = f64::from_bits(bits);
                for w in [slope, -slope] {
                    let known = Known::new(u, w);
                    for (i, (name, method, tolerance)) in methods.into_iter().enumerate() {
                        let (_, share) = known.checked(name, method, |angle| {
                            // Ten roundings of the slope, of a difference of a thousandth, once or twice.
                            tolerance + f64::EPSILON * (8.0 * angle + 2e4)
                        });
                        worst[i] = worst[i].max(share);
                    }
                }
            }
        }
    }
    println!("shares of the error allowed: {worst:.3?}");
}

/// Guards against a sign of Δ that only happens to be right where a test looks: Δ itself, from every start and on
/// both sides, to 2⁻¹⁰⁰ of the slope's square within 8 units in the last place of critical, and elsewhere to what
/// its factors carry: seven roundings of `|w| − s`, three more of the product.
#[test]
fn the_distance_from_critical_is_right_to_the_last_place() {
    for u in starts() {
        let captured = natural::critical_slope(u).to_bits();
        for power in 0..=60_u32 {
            for sign in [1, -1] {
                let steps = sign * (1_i64 << power.min(52)) * i64::from(power < 53);
                let Some(bits) = captured.checked_add_signed(steps) else {
                    continue;
                };
                let w = f64::from_bits(bits);
                let truth = natural::distance_from_critical(u, w);
                let found = Orbit::new(Ray::new(u, w).unwrap()).delta;
                let w2 = w * w;
                let allowed = 4.0 * f64::EPSILON * truth.abs()
                    + if steps.abs() <= 8 {
                        libm::ldexp(w2, -100)
                    } else {
                        4.0 * f64::EPSILON
                            * f64::from_bits(captured)
                            * (w + f64::from_bits(captured))
                    };
                assert!(
                    (found - truth).abs() <= allowed && (found > 0.0) == (truth > 0.0),
                    "u0 = {u:?}, dudphi = {w:?}: {found:e}, not {truth:e}"
                );
            }
        }
    }
}

/// Guards against a radial ray that overflows: `|du/dφ|` from 1e12 to the largest number there is and infinity. Its
/// angles are `|u − u0|/|du/dφ|`: `u̇² = e² − u²(1 − u)` varies by a share of 1/w² ≤ 1e-24 at most.
#[test]
fn nearly_radial_rays_sweep_the_angle_of_a_straight_line() {
    const SLOPES: [f64; 10] = [
        1e12,
        1e20,
        1e21,
        1e100,
        1e153,
        1e154,
        1e155,
        1e300,
        f64::MAX,
        f64::INFINITY,
    ];
    let adaptive = Adaptive::default();
    let rk4 = FixedStep::new(Scheme::Rk4, 0.05);
    let euler = FixedStep::new(Scheme::Euler, 0.05);
    let stepped: [(&str, &dyn Orbits); 3] =
        [("adaptive", &adaptive), ("RK4", &rk4), ("Euler", &euler)];
    let all = methods().map(|(name, method, _)| (name, method));
    for (name, method) in all.into_iter().chain(stepped) {
        // A table's angle is a difference of two numbers of up to 1, over e.
        let is_table = ["draft", "standard", "fine"].contains(&name);
        for u in starts() {
            for w in SLOPES.into_iter().flat_map(|slope| [slope, -slope]) {
                let name = format!("{name}, u0 = {u:?}, dudphi = {w:e}");
                let events = method.follow(Ray::new(u, w).unwrap(), &RADII).unwrap();
                let mut told: Vec<(EventKind, f64)> = if w > 0.0 {
                    let met = RADII.iter().rev().filter(|&&r| 1.0 / r > u);
                    met.map(|&r| (EventKind::Inbound, r)).collect()
                } else {
                    let met = RADII.iter().filter(|&&r| 1.0 / r < u);
                    met.map(|&r| (EventKind::Outbound, r)).collect()
                };
                told.push(if w > 0.0 {
                    (EventKind::End(Fate::Capture), 1.0)
                } else {
                    (EventKind::End(Fate::Escape), f64::INFINITY)
                });
                assert_eq!(happened(&events), told, "{name}");
                for event in &events {
                    let span = (1.0 / event.radius - u).abs();
                    let straight = span / w.abs();
                    let size = if is_table { 1.0 } else { span };
                    // Beyond 1e154 e² is infinite, and an angle below 1e-154 is 0.
                    let allowed = (8.0 * f64::EPSILON * size / w.abs()).max(1e-154);
                    assert!(
                        (event.angle - straight).abs() <= allowed,
                        "{name}: {event:?}, not {straight:e}"
                    );
                }
            }
        }
    }
}

/// Guards against a ray that starts at its turning point and is sent round it: du/dφ = +0, −0 and numbers too small to
/// change anything give the same events, the angles right, at the photon sphere's neighbours too.
#[test]
fn tangential_rays_start_at_their_turning_point() {
    for u in starts() {
        let mut known = Known::new(u, 0.0);
        assert!(known.truth.delta < 0.0);
        // What integration promises: angles below 10 radians, beside what rounding u does to them; they go as the
        // logarithm of the distance from the photon sphere, and where they are small as √(2d/|ü|), d the way in u.
        if known.angles.iter().all(|&angle| angle < 10.0) {
            let rounding = 64.0 * f64::EPSILON / (1.5 * u - 1.0).abs();
            for w in [0.0, -0.0, 1e-308, -1e-308] {
                known.ray = Ray::new(u, w).unwrap();
                known.checked("adaptive", &Adaptive::default(), |angle| {
                    1e-9 + rounding * (1.0 + 1.0 / angle)
                });
            }
        }
        for (name, method, tolerance) in methods() {
            for slope in [0.0, 5e-324, 1e-310, 1e-308] {
                for w in [slope, -slope] {
                    let name = format!("{name}, u0 = {u:?}, dudphi = {w:?}");
                    let ray = Ray::new(u, w).unwrap();
                    // The turning point is an angle w/(u |1.5 u − 1|) ahead or behind: 1e-200 or less.
                    known.ray = ray;
                    known.checked(&name, method, |angle| {
                        tolerance + 8.0 * f64::EPSILON * angle
                    });
                    let turn = method.turning_point(ray).unwrap();
                    let ahead = w != 0.0 && (w > 0.0) != known.truth.inside();
                    assert_eq!(turn.is_some(), ahead, "{name}");
                    if let Some(turn) = turn {
                        assert!(
                            turn.angle <= 1e-200 && (turn.u - u).abs() <= 4.0 * f64::EPSILON * u,
                            "{name}: {turn:?}"
                        );
                    }
                }
            }
        }
    }
}

//! Guards against methods that agree with each other and are all wrong. Swept angles from infinity are compared with
//! quadrature, with closed forms and with published series, each in the order in which it converges.

use core::f64::consts::{FRAC_PI_2, PI};

use darkness::orbit::exact::Exact;
use darkness::orbit::invariants::{CRITICAL_E2, Orbit, OrbitPoint};
use darkness::orbit::path::SweptAngles;
use darkness::orbit::{Event, EventKind, Fate, MIN_U, Orbits, Ray};
use darkness::table::Lookup;

use crate::known_values::known_values;
use crate::quadrature::TrueRay;
use crate::tables::table;

/// What is measured: the exact method or a table, with its tolerance.
enum Method {
    Exact,
    Table(Box<Lookup<'static>>),
}

fn methods() -> [(&'static str, Method, f64); 4] {
    let lookup = |name| Method::Table(Box::new(table(name).lookup()));
    [
        ("exact", Method::Exact, 1e-12),
        ("draft", lookup("draft"), 1e-6),
        ("standard", lookup("standard"), 1e-9),
        ("fine", lookup("fine"), 1e-12),
    ]
}

impl Method {
    fn follow(&self, ray: Ray, radii: &[f64]) -> Vec<Event> {
        let events = match self {
            Self::Exact => Exact.follow(ray, radii),
            Self::Table(lookup) => lookup.follow(ray, radii),
        };
        events.unwrap_or_else(|error| panic!("{ray:?}: {error}"))
    }

    /// What a ray from infinity is deflected by, where `Δ = e² − 4/27` is known better than e.
    fn deflection(&self, delta: f64) -> f64 {
        let orbit = from_infinity(delta);
        match self {
            Self::Exact => Exact.to_end(&orbit) - PI,
            Self::Table(lookup) => lookup.to_end(&orbit) - PI,
        }
    }

    /// The angle at which a ray from infinity passes u on its way back.
    fn outbound(&self, delta: f64, u: f64) -> Option<f64> {
        let orbit = from_infinity(delta);
        match self {
            Self::Exact => Exact.crossings(&orbit, u).outbound,
            Self::Table(lookup) => lookup.crossings(&orbit, u).outbound,
        }
    }
}

/// A ray from infinity that turns back.
fn from_infinity(delta: f64) -> Orbit {
    let e2 = CRITICAL_E2 + delta;
    Orbit {
        start: OrbitPoint {
            u: MIN_U,
            slope: e2.sqrt(),
        },
        e2,
        delta,
        ..Orbit::new(Ray::new(MIN_U, 0.1).unwrap())
    }
}

const END: Event = Event {
    kind: EventKind::End(Fate::Escape),
    radius: f64::INFINITY,
    angle: f64::NAN,
};

/// The quadrature that the methods are held against, itself against figures in print (Darwin 1959, *Proc. R. Soc.
/// Lond. A* 249, 180, to 15 digits).
#[test]
fn quadrature_gives_darwins_deflections() {
    for row in known_values("deflection") {
        let ratio: f64 = row.argument.parse().unwrap();
        let truth = TrueRay::new(MIN_U, CRITICAL_E2.sqrt() / ratio);
        // The slope is rounded, by ε in all, and so is the argument; half a unit of the last place in print.
        let allowed = 2.0 * f64::EPSILON * truth.condition(&END) + 5e-14;
        let error = (truth.angle(&END) - PI - row.value).abs();
        assert!(error <= allowed, "b/b_c = {ratio}: {error:e}");
    }
}

/// The deflection of a ray from infinity by quadrature of `2 ∫ du/√(1/b² − u² + u³) − π`, the integral that Darwin
/// (1959) turned into one in Legendre's form: from a share 1e-15 beyond the critical impact parameter to 1e12 radii.
#[test]
fn every_method_gives_the_deflections_of_quadrature() {
    let mut worst = [0.0_f64; 4];
    for k in 0..=540 {
        let excess = libm::pow(10.0, -15.0 + f64::from(k) / 20.0);
        let w = CRITICAL_E2.sqrt() / (1.0 + excess);
        let ray = Ray::new(MIN_U, w).unwrap();
        let truth = TrueRay::new(MIN_U, w);
        let (angle, condition) = (truth.angle(&END), truth.condition(&END));
        for (i, (name, method, tolerance)) in methods().into_iter().enumerate() {
            let [end] = method.follow(ray, &[])[..] else {
                panic!("{name}, {ray:?}: one event")
            };
            let allowed = tolerance + 16.0 * f64::EPSILON * condition;
            let ratio = (end.angle - angle).abs() / allowed;
            assert!(
                ratio <= 1.0,
                "{name}, {ray:?}: {end:?}, not {angle}: {ratio}"
            );
            worst[i] = worst[i].max(ratio);
        }
    }
    println!("shares of the error allowed: {worst:.3?}");
}

/// The series in `1/b`: `α + π = Σ √π Γ((3n + 1)/2)/(n! Γ(n/2 + 1)) b⁻ⁿ`, of which the first terms are `4 M/b + 15π/4
/// (M/b)² + 128/3 (M/b)³ + 3465π/64 (M/b)⁴ + 3584/5 (M/b)⁵` (Keeton & Petters 2005, *Phys. Rev. D* 72, 104006).
fn weak_term(n: i32) -> f64 {
    let n = f64::from(n);
    let logarithm =
        libm::lgamma(1.5 * n + 0.5) - libm::lgamma(n + 1.0) - libm::lgamma(0.5 * n + 1.0);
    PI.sqrt() * libm::exp(logarithm)
}

#[test]
fn weak_deflection_converges_as_the_series_of_keeton_and_petters() {
    const M: f64 = 0.5;
    let printed = [
        4.0,
        15.0 * PI / 4.0,
        128.0 / 3.0,
        3465.0 * PI / 64.0,
        3584.0 / 5.0,
    ];
    let mut power = 1.0;
    for (n, coefficient) in (1..).zip(printed) {
        power *= M;
        assert!(
            (weak_term(n) / (coefficient * power) - 1.0).abs() < 1e-13,
            "order {n}"
        );
    }
    for (name, method, tolerance) in methods() {
        let remainder = |b: f64| {
            let [end] = method.follow(Ray::new(MIN_U, 1.0 / b).unwrap(), &[])[..] else {
                panic!("{name}: b = {b}")
            };
            let x = M / b;
            end.angle - PI - x * (printed[0] + x * (printed[1] + x * printed[2]))
        };
        let mut compared = 0;
        for b in [12.5, 25.0, 50.0, 100.0, 200.0, 400.0] {
            let x = M / b;
            let fourth = printed[3] * libm::pow(x, 4.0);
            // What the next terms add up to: they fall by 3√3 M/b each, ½ at most.
            let rest = 2.0 * printed[4] * libm::pow(x, 5.0);
            // π, the angle and the sum are rounded.
            let allowed = rest + tolerance + 8.0 * f64::EPSILON;
            let error = (remainder(b) - fourth).abs();
            assert!(error <= allowed, "{name}, b = {b}: off by {error:e}");
            // Where the method's tolerance is no more than a hundredth of it, the remainder is seen to fall with the
            // fourth power, and with the share of the next term still to come.
            if fourth / 16.0 >= 100.0 * tolerance {
                let order = libm::log2(remainder(b) / remainder(2.0 * b));
                let upper = 4.0 + 1.5 * rest / fourth + 0.03;
                assert!(
                    (3.97..upper).contains(&order),
                    "{name}, b = {b}: order {order}"
                );
                compared += 1;
            }
        }
        // The draft table's tolerance leaves no remainder to see.
        assert!(
            compared >= 2 || name == "draft",
            "{name}: {compared} orders"
        );
    }
}

/// All of the series, which converges beyond the critical impact parameter: a third way to the same angle.
#[test]
fn the_whole_weak_series_adds_up_to_the_deflection() {
    for b in [2.9, 3.5, 5.0, 8.0, 20.0, 1e3, 1e6, 1e12] {
        let mut sum = 0.0;
        for n in (1..400).rev() {
            sum += weak_term(n) * libm::pow(b, -f64::from(n));
        }
        for (name, method, tolerance) in methods() {
            let [end] = method.follow(Ray::new(MIN_U, 1.0 / b).unwrap(), &[])[..] else {
                panic!("{name}: b = {b}")
            };
            // 1/b is rounded by ε/2; of a term, its logarithms, by as many ε as they are large (1e3 at most).
            let condition = TrueRay::new(MIN_U, 1.0 / b).condition(&END);
            let allowed = tolerance + 16.0 * f64::EPSILON * condition + 1e3 * f64::EPSILON * sum;
            let error = (end.angle - PI - sum).abs();
            assert!(error <= allowed, "{name}, b = {b}: {error:e}");
        }
    }
}

/// The series about the critical ray, in `b′ = 1 − b_c/b`, `L = ln(216(7 − 4√3)/b′)`: `α = −π + L + (−17 + 4√3 + 5L)/18
/// b′ + (−879 + 236√3 + 205L)/1296 b′² + …` (Iyer & Petters 2007, *Gen. Rel. Grav.* 39, 1563). Its first terms are the
/// limit of strong deflection, `−ln(b/b_c − 1) + ln(216(7 − 4√3)) − π` (Bozza 2002, eq. 35).
#[test]
fn strong_deflection_converges_in_the_orders_of_bozza_and_of_iyer_and_petters() {
    let root = 3.0_f64.sqrt();
    let terms = |share: f64| {
        let log = libm::log(216.0 * (7.0 - 4.0 * root) / share);
        [
            log - PI,
            (-17.0 + 4.0 * root + 5.0 * log) / 18.0 * share,
            (-879.0 + 236.0 * root + 205.0 * log) / 1296.0 * share * share,
        ]
    };
    for (name, method, tolerance) in methods() {
        let mut compared = [0; 3];
        for halvings in 5..40 {
            // e²/e_c² = (1 − b′)².
            let share = libm::ldexp(1.0, -halvings);
            let error_of = |share: f64, order: usize| {
                let truth = method.deflection(CRITICAL_E2 * share * (share - 2.0));
                truth - terms(share)[..=order].iter().sum::<f64>()
            };
            for (order, compared) in compared.iter_mut().enumerate() {
                let (error, halved) = (error_of(share, order), error_of(0.5 * share, order));
                // Of each the method's tolerance, and the rounding of numbers of up to 30, is to be less than a
                // hundredth.
                if halved.abs() < 100.0 * (tolerance + 32.0 * f64::EPSILON) {
                    continue;
                }
                // The next term is printed too, and what comes after it is a share b′ of it.
                if order < 2 {
                    let ratio = error / terms(share)[order + 1];
                    assert!(
                        (ratio - 1.0).abs() <= share + 0.02,
                        "{name}, b′ = {share:e}: {ratio} of the term {} is left",
                        order + 1
                    );
                }
                // It is b′ to the order + 1 times c(L − 2 … 2.5), which a halving raises by ln 2/(L − 2 … 2.5).
                let log = terms(share)[0] + PI;
                let expected = f64::from(u8::try_from(order + 1).unwrap())
                    - libm::log2(1.0 + core::f64::consts::LN_2 / (log - 2.25));
                let found = libm::log2(error / halved);
                assert!(
                    (found - expected).abs() <= 0.03 + share,
                    "{name}, b′ = {share:e}, {order} terms after the first: order {found}, not {expected}"
                );
                *compared += 1;
            }
            let excess = share / (1.0 - share);
            let bozza = -libm::log(excess) + terms(1.0)[0];
            let error = (method.deflection(CRITICAL_E2 * share * (share - 2.0)) - bozza).abs();
            assert!(
                error <= excess * (1.0 - libm::log(excess)) + tolerance + 32.0 * f64::EPSILON,
                "{name}, b/b_c − 1 = {excess:e}: {error:e}"
            );
        }
        let least = match name {
            "draft" => [5, 1, 0],
            "standard" => [10, 4, 1],
            _ => [20, 8, 4],
        };
        assert!(
            compared
                .iter()
                .zip(least)
                .all(|(&found, least)| found >= least),
            "{name}: {compared:?} orders"
        );
    }
}

/// Each circle of the disk is seen, seen along its axis, `e^−π` times as far from the critical curve in one order as
/// in the order before, and the ring between two circles is so much thinner (Ohanian 1987, *Am. J. Phys.* 55, 428): in
/// the limit, from which the series above takes a share `ε ln ε` at a distance ε.
#[test]
fn successive_rings_are_exp_pi_nearer_and_thinner() {
    for (name, method, tolerance) in methods() {
        // b/b_c − 1 of a circle in an order.
        let distance = |radius: f64, order: u32| {
            let target = FRAC_PI_2 + PI * f64::from(order);
            let (mut low, mut high) = (-60.0_f64, 0.0_f64);
            for _ in 0..200 {
                // −Δ/CRITICAL_E2 = 1 − (b_c/b)².
                let middle = 0.5 * (low + high);
                let share = libm::exp(middle);
                let angle = method.outbound(-CRITICAL_E2 * share, 1.0 / radius);
                if angle.is_some_and(|angle| angle > target) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            libm::expm1(-0.5 * libm::log1p(-libm::exp(low)))
        };
        let ratio = libm::exp(-PI);
        for order in 1..=8 {
            let circles = [3.0, 6.0, 12.0]
                .map(|radius| [distance(radius, order), distance(radius, order + 1)]);
            for [first, second] in circles {
                let allowed = first * (1.0 - libm::log(first)) + 2.0 * tolerance;
                let off = (second / first / ratio - 1.0).abs();
                assert!(
                    off <= allowed,
                    "{name}, order {order}: {off:e} off, {allowed:e} allowed"
                );
            }
            let [inner, _, outer] = circles;
            let found = (outer[1] - inner[1]) / (outer[0] - inner[0]);
            // The inner circle is about half as far from critical as the outer one, and errs in the same sense.
            let allowed = 2.0 * outer[0] * (1.0 - libm::log(outer[0])) + 4.0 * tolerance;
            let off = (found / ratio - 1.0).abs();
            assert!(
                off <= allowed,
                "{name}, order {order}: thickness {off:e} off, {allowed:e} allowed"
            );
        }
    }
}

//! Guards against a wrong radius at a given angle: against quadrature, as the inverse of the swept angle, and method
//! against method, for rays of all families, near the critical ray and about the turning point.

use darkness::orbit::exact::Exact;
use darkness::orbit::integrate::Adaptive;
use darkness::orbit::{EventKind, Orbits, Ray};
use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

use crate::natural;
use crate::quadrature::TrueRay;
use crate::tables::table;

/// Random numbers, the same in every run.
struct Dice(TestRng);

impl Dice {
    fn new() -> Self {
        Self(TestRng::deterministic_rng(RngAlgorithm::ChaCha))
    }

    /// A number from 0 to 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// A ray of any family: a third of them ordinary, a third near critical, a third far away or steep.
    fn ray(&mut self) -> (f64, f64) {
        let sign = if self.unit() < 0.5 { 1.0 } else { -1.0 };
        let kind = self.unit();
        let u = if kind < 0.67 {
            self.within(0.001, 0.999)
        } else {
            libm::pow(10.0, self.within(-12.0, -0.01))
        };
        let w = if kind < 0.33 {
            self.within(0.0, 1.5)
        } else if kind < 0.67 {
            let off = libm::pow(10.0, self.within(-14.0, -1.0));
            let share = if self.unit() < 0.5 {
                1.0 + off
            } else {
                1.0 - off
            };
            natural::critical_slope(u) * share
        } else {
            u * libm::pow(10.0, self.within(-2.0, 4.0))
        };
        (u, sign * w)
    }
}

/// A point of a ray.
#[derive(Debug, Clone, Copy)]
struct Place {
    ray: Ray,
    u: f64,
    slope: f64,
    /// The angle swept to it, by quadrature.
    angle: f64,
    /// What 16 units in the last place of the ray's own numbers do to the angle.
    blur: f64,
}

/// Random points of random rays: those that a ray crosses, and at which exact arithmetic says that it is not within
/// rounding of its turning point.
fn places(count: usize) -> Vec<Place> {
    let mut dice = Dice::new();
    let mut places = Vec::new();
    while places.len() < count {
        let (u, w) = dice.ray();
        let ray = Ray::new(u, w).unwrap();
        let far = libm::pow(10.0, dice.within(-3.0, 6.0));
        let radius = if dice.unit() < 0.5 {
            1.0 + far
        } else {
            1.0 + 1.0 / u * dice.within(0.0, 2.0)
        };
        for event in Exact.follow(ray, &[radius]).unwrap() {
            if matches!(event.kind, EventKind::End(_)) {
                continue;
            }
            let u = 1.0 / radius;
            let truth = TrueRay::new(ray.u(), w);
            let squared = natural::squared_slope(ray.u(), w, u);
            if squared <= 0.0 || w == 0.0 {
                continue;
            }
            let place = Place {
                ray,
                u,
                slope: squared.sqrt(),
                angle: truth.angle(&event),
                blur: 16.0 * f64::EPSILON * truth.condition(&event),
            };
            if place.angle > 0.0 && place.angle.is_finite() && place.blur.is_finite() {
                places.push(place);
            }
        }
    }
    places
}

/// The change of u in an angle of `error` and of the quadrature's error, and two units in its last place.
fn allowed(place: &Place, error: f64) -> f64 {
    let error = error + place.blur + 2e-14 * (1.0 + place.angle);
    place.slope * error + error * error + 2.0 * f64::EPSILON * place.u
}

fn check(name: &str, method: &impl Orbits, error: f64, places: &[Place]) {
    let (mut worst, mut worst_at) = (0.0, None);
    let (mut relative, mut ordinary) = (Vec::new(), 0);
    for &place in places {
        let Place { ray, u, angle, .. } = place;
        let found = method.u_at_angle(ray, angle).unwrap();
        let found = found.unwrap_or_else(|| panic!("{name}: {place:?} has ended"));
        let ratio = (found - u).abs() / allowed(&place, error);
        if ratio > worst {
            (worst, worst_at) = (ratio, Some((place, found)));
        }
        if place.blur < 1e-14 && u > 1e-3 {
            relative.push((found / u - 1.0).abs());
            ordinary += 1;
        }
    }
    relative.sort_by(f64::total_cmp);
    println!(
        "{name}: {worst:.3} of the error allowed at {worst_at:?}; {ordinary} ordinary ones: relative error {:.1e} in \
         the median, {:.1e} in 99 of 100, at most {:.1e}",
        relative[ordinary / 2],
        relative[ordinary * 99 / 100],
        relative[ordinary - 1]
    );
    assert!(
        worst <= 1.0,
        "{name}: {worst} of the error allowed: {worst_at:?}"
    );
}

#[test]
fn exact_equals_quadrature() {
    check("exact", &Exact, 0.0, &places(5_000));
}

#[test]
fn the_tables_equal_quadrature() {
    let places = places(3_000);
    check("draft", table("draft"), 1e-6, &places);
    check("standard", table("standard"), 1e-9, &places);
    check("fine", table("fine"), 1e-12, &places);
}

/// Up to the angle for which the integrator promises its error.
#[test]
fn integration_equals_quadrature() {
    let mut places = places(3_000);
    places.retain(|place| place.angle < 10.0);
    check("adaptive", &Adaptive::new(1e-10), 1e-10, &places);
}

//! The second panel: how wrong a ray's whole flight is, the closer the ray is to the critical one.
//!
//! The critical ray winds round the photon sphere for ever; a ray beside it winds for about ln(1/distance), where
//! `distance = |27e²/4 − 1|`, and then escapes or falls in. Errors made on the way grow as e^φ meanwhile, so that
//! this is where methods fail: by the angle, and in the end by the ray's fate.
//!
//! At each half decade of the distance, on both sides, rays that go towards the photon sphere start at several radii.
//! A double cannot say every slope: of its neighbours the one is taken that comes closest, and the distance that it
//! has is what is reported.
//!
//! # What rounding the ray does
//! A ray's slope is a double, good to ε/2. The grey line is `ε |∂angle/∂ln dudphi|`, the largest among the rays: what
//! the last digit of the ray's own slope is worth. No method that works on the rays' rounded states, step by step, can
//! stay below it. Those that take e² − 4/27 from the two given numbers, as exactly as these are given, can: they
//! answer for that pair of numbers, whether or not it was meant to the last digit.

use rayon::prelude::*;

use super::halves::in_two_parts;
use super::methods::{Contestant, Method, Tables};
use super::{Effort, Measurement, Panel, Quantiles};
use crate::orbit::exact::Exact;
use crate::orbit::integrate::Scheme;
use crate::orbit::invariants::{CRITICAL_E2, Family, Orbit, critical_slope, three_u_minus_two};
use crate::orbit::path::SweptAngles;
use crate::orbit::{EventKind, Fate, Ray};

/// Where rays start.
const START_RADII: [f64; 5] = [1000.0, 30.0, 6.0, 2.0, 1.2];

/// The closest distance asked for: some units in the last place of e².
const CLOSEST_DECADE: i32 = 15;

/// On which side of critical a ray is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// It comes back out, or gets out.
    Escape,
    /// It ends in the hole.
    Capture,
}

impl Side {
    /// Its name in the CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::Escape => "escape",
            Self::Capture => "capture",
        }
    }
}

/// What is measured about the critical ray.
#[derive(Debug)]
pub struct Critical {
    /// Every method at every distance.
    pub points: Vec<Point>,
    /// What rounding the rays' slopes does, in radians.
    pub rounding: Vec<(Place, f64)>,
}

/// One method at one distance.
#[derive(Debug)]
pub struct Point {
    /// Where.
    pub place: Place,
    /// How wrong.
    pub measurement: Measurement,
}

/// A distance from critical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// On which side.
    pub side: Side,
    /// `|27e²/4 − 1|`: the geometric mean of the rays'.
    pub distance: f64,
}

/// The rays of one distance.
struct Rays {
    place: Place,
    rays: Vec<(Ray, Orbit)>,
}

impl Critical {
    /// Measures; `progress` is told which share is done.
    pub fn measure(tables: &Tables, effort: Effort, progress: &dyn Fn(f64)) -> Self {
        let steps = match effort {
            Effort::Quick => 1,
            Effort::Full => 2,
        };
        let exponents = (0..=CLOSEST_DECADE * steps).map(|k| -f64::from(k) / f64::from(steps));
        let bundles: Vec<Rays> = exponents
            .map(|exponent| libm::pow(10.0, exponent))
            .flat_map(|distance| [Side::Escape, Side::Capture].map(|side| (side, distance)))
            .filter_map(|(side, distance)| Rays::new(side, distance))
            .collect();
        let mut contestants = vec![
            Contestant::fixed(Scheme::Euler, 1e-3),
            Contestant::fixed(Scheme::Rk4, 0.05),
            Contestant::fixed(Scheme::Rk4, 0.01),
            Contestant::adaptive(1e-9),
        ];
        contestants.extend(tables.files());
        contestants.push(Contestant::exact());
        let mut points = Vec::new();
        for (i, contestant) in contestants.iter().enumerate() {
            points.par_extend(bundles.par_iter().map(|rays| rays.ask(contestant)));
            progress((i + 1) as f64 / contestants.len() as f64);
        }
        let rounding = bundles.iter().map(|rays| (rays.place, rays.rounding()));
        Self {
            points,
            rounding: rounding.collect(),
        }
    }
}

impl Rays {
    /// `None` where no ray is as far from critical on this side.
    fn new(side: Side, distance: f64) -> Option<Self> {
        let rays: Vec<_> = START_RADII
            .iter()
            .filter_map(|radius| closest_ray(1.0 / radius, side, distance))
            .collect();
        let logarithms = rays
            .iter()
            .map(|(_, orbit)| libm::log(orbit.delta.abs() / CRITICAL_E2));
        let mean = logarithms.sum::<f64>() / rays.len() as f64;
        (!rays.is_empty()).then(|| Self {
            place: Place {
                side,
                distance: libm::exp(mean),
            },
            rays,
        })
    }

    /// The errors of one method.
    fn ask(&self, contestant: &Contestant<'_>) -> Point {
        let errors = self.rays.iter().filter_map(|(ray, orbit)| {
            let angle = if contestant.method == Method::Exact {
                in_two_parts(orbit, orbit.end(), orbit.family != Family::Monotone)
            } else {
                let events = contestant.orbits.follow(*ray, &[]).ok()?;
                let end = events.last()?;
                (end.kind == EventKind::End(orbit.fate())).then_some(end.angle)?
            };
            Some((angle - Exact.to_end(orbit)).abs())
        });
        let errors: Vec<f64> = errors.collect();
        let Place { side, distance } = self.place;
        let words = format!(
            "{} distance={distance:.0e} side={}",
            contestant.setting,
            side.name()
        );
        Point {
            place: self.place,
            measurement: Measurement {
                panel: Panel::Critical,
                method: contestant.method,
                setting: words.trim_start().to_owned(),
                time: None,
                failures: (self.rays.len() - errors.len()) as u64,
                count: self.rays.len() as u64,
                error: Quantiles::of(errors),
            },
        }
    }

    /// `ε |∂angle/∂ln dudphi|`, the largest of the rays', by differences of 2 % in Δ: `dΔ = 2 w² d ln w`.
    fn rounding(&self) -> f64 {
        const SHARE: f64 = 0.01;
        let sensitivity = self.rays.iter().map(|(ray, orbit)| {
            let (w2, delta) = (ray.dudphi() * ray.dudphi(), orbit.delta);
            let beside = |share: f64| {
                let changed = delta * (1.0 + share);
                let slope = (w2 + delta * share).sqrt().copysign(ray.dudphi());
                Exact.to_end(&Orbit::with_delta(ray.u(), slope, changed))
            };
            let change = (beside(SHARE) - beside(-SHARE)).abs();
            change * w2 / (SHARE * delta.abs())
        });
        f64::EPSILON * sensitivity.fold(0.0, f64::max)
    }
}

/// The ray from inverse radius `u` towards the photon sphere whose distance from critical comes closest to `distance`
/// among the doubles that it might have for its slope.
fn closest_ray(u: f64, side: Side, distance: f64) -> Option<(Ray, Orbit)> {
    let inward = three_u_minus_two(u) < 0.0;
    // More e² than critical crosses the photon sphere.
    let crosses = (side == Side::Capture) == inward;
    let delta = CRITICAL_E2 * if crosses { distance } else { -distance };
    let s = critical_slope(u);
    let slope = (s * s + delta).sqrt();
    // The roundings of s and of the root are a few units in the last place.
    let neighbours = (-32_i64..=32).filter_map(|step| {
        let slope = f64::from_bits(slope.to_bits().checked_add_signed(step)?);
        let ray = Ray::new(u, if inward { slope } else { -slope }).ok()?;
        let orbit = Orbit::new(ray);
        let off = libm::log(orbit.delta / delta).abs();
        (orbit.fate() == side.into() && off < 1.0).then_some((off, ray, orbit))
    });
    let closest = neighbours.min_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, ray, orbit)| (ray, orbit))
}

impl From<Side> for Fate {
    fn from(side: Side) -> Self {
        match side {
            Side::Escape => Self::Escape,
            Side::Capture => Self::Capture,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_as_close_as_asked_on_the_side_asked() {
        for side in [Side::Escape, Side::Capture] {
            for exponent in 1..=15 {
                let distance = libm::pow(10.0, -f64::from(exponent));
                let rays = Rays::new(side, distance).unwrap();
                assert_eq!(rays.rays.len(), START_RADII.len(), "{side:?} {distance:e}");
                for (ray, orbit) in rays.rays {
                    let found = orbit.delta.abs() / CRITICAL_E2;
                    // At 1e-15 the slopes of neighbouring doubles are 1e-16 to 4e-16 apart in e².
                    let allowed = 1e-9 + 4e-16 / distance;
                    assert!(
                        (found / distance - 1.0).abs() < allowed,
                        "{ray:?}: {found:e} for {distance:e}"
                    );
                    assert_eq!(orbit.fate(), side.into());
                }
            }
        }
    }

    #[test]
    fn rounding_is_worth_one_over_the_distance() {
        let at = |distance| Rays::new(Side::Capture, distance).unwrap().rounding();
        let ratio = at(1e-10) / at(1e-8);
        assert!((ratio - 100.0).abs() < 1.0, "{ratio}");
        // A captured ray's angle is −ln Δ beside what is smooth, and `dΔ = 2 w² d ln w` with w² near 4/27 far out.
        let expected = 2.0 * f64::EPSILON * 1e8;
        assert!((at(1e-8) / expected - 1.0).abs() < 0.1, "{:e}", at(1e-8));
    }
}
